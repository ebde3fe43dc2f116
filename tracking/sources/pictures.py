"""From encoded pictures to pixels, the same on every machine."""

from collections.abc import Iterator
from dataclasses import dataclass

import av
import cv2
import numpy as np
from av.codec.context import Flags
from numpy.typing import NDArray

Picture = NDArray[np.uint8]


@dataclass(frozen=True)
class EncodedPicture:
    """A picture as a camera or a recording gives it."""

    data: bytes
    """A JPEG, or one H.264 access unit in Annex B."""

    encoding: str
    """"jpeg" or "h264"."""

    timestamp: float
    """On the clock of its source [s]."""


class UndecodableError(Exception):
    """Data that is no picture; says what is wrong with it."""


def decode_jpeg(data: bytes) -> Picture | None:
    """Decode a JPEG to BGR; None where the data is no whole JPEG.

    A cut-off picture is refused before libjpeg sees it, which would fill it with grey and print.
    """
    if not data.startswith(b"\xff\xd8") or b"\xff\xd9" not in data:
        return None
    image = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_COLOR)
    return None if image is None else np.asarray(image, np.uint8)


def from_video_frame(frame: av.VideoFrame) -> Picture:
    """Turn a decoded video frame into BGR, upright.

    4:2:0 of even size, what nearly every video is, goes through OpenCV's integer arithmetic
    (BT.601, studio range), the same on every processor; FFmpeg's differs with its SIMD path.
    """
    if frame.format.name == "yuv420p" and frame.width % 2 == 0 and frame.height % 2 == 0:
        image = cv2.cvtColor(frame.to_ndarray(), cv2.COLOR_YUV2BGR_I420)
    else:
        image = frame.to_ndarray(format="bgr24")
    # A phone held upright stores its pictures lying, with a note to turn them.
    quarter_turns = round(frame.rotation / 90) % 4
    return np.ascontiguousarray(np.rot90(image, quarter_turns), np.uint8)


class PictureDecoder:
    """Decodes the pictures of one recording in order.

    H.264 is taken as Foxglove asks for it: one picture to an access unit and no B frames.
    """

    def __init__(self) -> None:
        codec = av.CodecContext.create("h264", "r")
        assert isinstance(codec, av.VideoCodecContext)
        codec.thread_type = "SLICE"  # frame threads would hold pictures back
        codec.flags |= Flags.low_delay
        self._h264 = codec
        self._waiting: dict[int, EncodedPicture] = {}
        self._count = 0

    def decode(self, picture: EncodedPicture) -> Iterator[tuple[EncodedPicture, Picture]]:
        """Take one encoded picture; give out those that are ready, each with its pixels.

        Raises
        ------
        UndecodableError
            The data is no picture.
        """
        if picture.encoding == "h264":
            yield from self._decode_h264(picture)
            return
        image = decode_jpeg(picture.data) if picture.encoding == "jpeg" else None
        if image is None:
            raise UndecodableError(f"a picture that is no {picture.encoding.upper()}")
        yield picture, image

    def flush(self) -> Iterator[tuple[EncodedPicture, Picture]]:
        """Give out what the decoder still holds."""
        if self._waiting:
            yield from self._pair(self._h264.decode(None))

    def _decode_h264(self, picture: EncodedPicture) -> Iterator[tuple[EncodedPicture, Picture]]:
        packet = av.Packet(picture.data)
        packet.pts = self._count
        self._waiting[self._count] = picture
        self._count += 1
        try:
            yield from self._pair(self._h264.decode(packet))
        except av.FFmpegError as error:
            raise UndecodableError("a picture that is no H.264") from error

    def _pair(self, frames: list[av.VideoFrame]) -> Iterator[tuple[EncodedPicture, Picture]]:
        for frame in frames:
            assert frame.pts is not None  # those of the packets, set above
            yield self._waiting.pop(frame.pts), from_video_frame(frame)
