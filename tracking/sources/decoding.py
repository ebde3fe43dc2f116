"""Decoding images to pixels, with the same result on every machine."""

from collections.abc import Iterator
from dataclasses import dataclass

import av
import cv2
import numpy as np
from av.codec.context import Flags

from tracking.geometry.arrays import Image
from tracking.sources.device import decode_jpeg


@dataclass(frozen=True)
class EncodedImage:
    """An image as stored in a recording."""

    data: bytes
    """A JPEG, or one H.264 access unit in Annex B."""

    encoding: str
    """"jpeg" or "h264"."""

    timestamp: float
    """On the clock of its source [s]."""


class ImageDecodeError(Exception):
    """The data is not an image; the message says what is wrong."""


def bgr_of(frame: av.VideoFrame) -> Image:
    """Convert a decoded video frame to BGR, upright.

    4:2:0 of even size, which nearly every video has, goes through OpenCV's integer arithmetic
    (BT.601, studio range), which is the same on every processor; FFmpeg's depends on SIMD.
    """
    if frame.format.name == "yuv420p" and frame.width % 2 == 0 and frame.height % 2 == 0:
        image = cv2.cvtColor(frame.to_ndarray(), cv2.COLOR_YUV2BGR_I420)
    else:
        image = frame.to_ndarray(format="bgr24")
    # A phone held upright stores its images rotated, with a note about the rotation.
    quarter_turns = round(frame.rotation / 90) % 4
    return np.ascontiguousarray(np.rot90(image, quarter_turns), np.uint8)


class ImageDecoder:
    """Decodes the images of one recording in order.

    H.264 as required by Foxglove: one image per access unit and no B frames.
    """

    def __init__(self) -> None:
        codec = av.CodecContext.create("h264", "r")
        assert isinstance(codec, av.VideoCodecContext)
        codec.thread_type = "SLICE"  # frame threads would delay images
        codec.flags |= Flags.low_delay
        self._h264 = codec
        self._pending: dict[int, EncodedImage] = {}
        self._count = 0

    def decode(self, encoded: EncodedImage) -> Iterator[tuple[EncodedImage, Image]]:
        """Add one encoded image; return those that are ready, each with its pixels.

        Raises
        ------
        ImageDecodeError
            The data is not an image.
        """
        if encoded.encoding == "h264":
            yield from self._decode_h264(encoded)
            return
        image = decode_jpeg(encoded.data) if encoded.encoding == "jpeg" else None
        if image is None:
            raise ImageDecodeError(f"an image that is not {encoded.encoding.upper()}")
        yield encoded, image

    def flush(self) -> Iterator[tuple[EncodedImage, Image]]:
        """Return the images that the decoder still holds."""
        if self._pending:
            yield from self._pair(self._h264.decode(None))

    def _decode_h264(self, encoded: EncodedImage) -> Iterator[tuple[EncodedImage, Image]]:
        packet = av.Packet(encoded.data)
        packet.pts = self._count
        self._pending[self._count] = encoded
        self._count += 1
        try:
            yield from self._pair(self._h264.decode(packet))
        except av.FFmpegError as error:
            raise ImageDecodeError("an image that is not H.264") from error

    def _pair(self, frames: list[av.VideoFrame]) -> Iterator[tuple[EncodedImage, Image]]:
        for frame in frames:
            assert frame.pts is not None  # those of the packets, set above
            yield self._pending.pop(frame.pts), bgr_of(frame)
