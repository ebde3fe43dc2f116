"""Decoding images to pixels, with the same result on every machine."""

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import av
import cv2
import numpy as np
from av.codec.context import Flags
from av.video.stream import VideoStream

from cubeling.tracking.geometry.arrays import Image
from cubeling.tracking.sources.device import decode_jpeg

DISPLAY_MATRIX = "DISPLAYMATRIX"
"""FFmpeg's name of the data of a frame that say how it is turned and mirrored."""

MAX_PIXEL_SHAPE = 4.0
"""Pixels are at most so many times wider than high, or the reverse: more is a broken header."""

START_CODE = b"\x00\x00\x01"
"""Begins every NAL unit of an Annex B stream (ITU-T H.264, annex B)."""

IDR_SLICE = 5
"""`nal_unit_type` of a slice of an IDR picture (ITU-T H.264, table 7-1)."""


@dataclass(frozen=True)
class EncodedImage:
    """An image as stored in a recording."""

    data: bytes
    """A JPEG, or one H.264 access unit in Annex B."""

    encoding: str
    """"jpeg" or "h264"."""

    timestamp: float
    """On the clock of its source [s]."""

    seen: bool = True
    """Whether its pixels are wanted, not only those of the images that build on it."""

    @property
    def alone(self) -> bool:
        """Whether it is decoded without the images before it: a JPEG, or an IDR picture."""
        if self.encoding != "h264":
            return True
        start = self.data.find(START_CODE)
        while 0 <= start < len(self.data) - len(START_CODE):
            if self.data[start + len(START_CODE)] & 0x1F == IDR_SLICE:
                return True
            start = self.data.find(START_CODE, start + len(START_CODE))
        return False


class BrokenFileError(Exception):
    """A file cannot be read any further; the message completes the sentence "the file ..."."""


def bgr_of(frame: av.VideoFrame, pixel_shape: float = 1.0) -> Image:
    """Convert a decoded video frame to BGR, upright, not mirrored, and with square pixels.

    `pixel_shape` is the width of a pixel ÷ its height, as `pixel_shape_of` returns it.

    4:2:0 of even size, which nearly every video has, goes through OpenCV's integer arithmetic
    (BT.601, studio range), which is the same on every processor; FFmpeg's depends on SIMD.
    """
    if frame.format.name == "yuv420p" and frame.width % 2 == 0 and frame.height % 2 == 0:
        image = cv2.cvtColor(frame.to_ndarray(), cv2.COLOR_YUV2BGR_I420)
    else:
        image = frame.to_ndarray(format="bgr24")
    if pixel_shape != 1:
        # The shorter side of the pixels grows, so that nothing is lost.
        size = round(frame.width * max(pixel_shape, 1)), round(frame.height / min(pixel_shape, 1))
        image = cv2.resize(image, size, interpolation=cv2.INTER_LINEAR_EXACT)
    pixels = np.asarray(image, np.uint8)
    matrix: Any = frame.side_data.get(DISPLAY_MATRIX)  # PyAV types it for motion vectors alone
    return pixels if matrix is None else _apply_display_matrix(pixels, bytes(matrix))


def reason_of(error: av.FFmpegError) -> str:
    """Return FFmpeg's message without its numbers, paths and addresses."""
    return (error.strerror or type(error).__name__).lower()


def pixel_shape_of(stream: VideoStream) -> float:
    """Width of a pixel ÷ its height, as the file states it; 1 where it states none or nonsense."""
    ratio = stream.sample_aspect_ratio or Fraction(1)
    return float(ratio) if 1 / MAX_PIXEL_SHAPE <= ratio <= MAX_PIXEL_SHAPE else 1.0


def _apply_display_matrix(image: Image, matrix: bytes) -> Image:
    """Turn and mirror an image by quarters, as its display matrix says (`libavutil/display.h`).

    A phone held upright stores its images rotated, one that films its owner perhaps mirrored.
    """
    # Rows: what the stored x and y become, each along the displayed x and y, and a third column.
    (xx, xy, _), (yx, yy, _), _ = np.frombuffer(matrix, np.int32).reshape(3, 3).tolist()
    if abs(xy) + abs(yx) > abs(xx) + abs(yy):
        image, xx, yy = image.transpose(1, 0, 2), yx, xy
    steps = (-1 if yy < 0 else 1), (-1 if xx < 0 else 1)
    return np.ascontiguousarray(image[:: steps[0], :: steps[1]], np.uint8)


def decode(images: Iterator[EncodedImage]) -> Iterator[tuple[EncodedImage, Image]]:
    """Pair each image of a recording that is seen with its pixels.

    H.264 as required by Foxglove: one image per access unit and no B frames.

    Raises
    ------
    BrokenFileError
        Data is not an image, or `images` raised it; all images before are returned first.
    """
    codec = av.CodecContext.create("h264", "r")
    assert isinstance(codec, av.VideoCodecContext)
    codec.thread_type = "SLICE"  # frame threads would delay images
    codec.flags |= Flags.low_delay
    pending: dict[int, EncodedImage] = {}
    broken: BrokenFileError | None = None
    try:
        for number, encoded in enumerate(images):
            if encoded.encoding == "h264":
                pending[number] = encoded
                packet = av.Packet(encoded.data)
                packet.pts = number
                yield from _pair(codec.decode(packet), pending)
            elif encoded.seen:
                image = decode_jpeg(encoded.data)
                if image is None:
                    raise BrokenFileError("has an image that is not JPEG")
                yield encoded, image
    except BrokenFileError as error:
        broken = error
    except av.FFmpegError:
        broken = BrokenFileError("has an image that is not H.264")
    if pending:
        yield from _pair(codec.decode(None), pending)
    if broken is not None:
        raise broken


def _pair(
    frames: list[av.VideoFrame], pending: dict[int, EncodedImage]
) -> Iterator[tuple[EncodedImage, Image]]:
    for frame in frames:
        assert frame.pts is not None  # those of the packets
        encoded = pending.pop(frame.pts)
        if encoded.seen:
            yield encoded, bgr_of(frame)
