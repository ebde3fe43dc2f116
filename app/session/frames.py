"""Encoding camera frames for a session, with the picture that decoding gives back."""

import dataclasses
from collections.abc import Callable
from fractions import Fraction

import av
import cv2
import numpy as np

from cubeling.app.errors import AppError
from cubeling.app.session.codecs import CODECS, NO_VIDEO, check_codec
from cubeling.tracking import Frame

FrameEncoder = Callable[[Frame], Frame]
"""Gives a frame its encoded bytes, and the picture that a replay decodes from them."""

JPEG_QUALITY = 92
"""Of OpenCV's JPEG encoder, 0…100."""

H264_CRF = 19
"""Constant rate factor of x264: a larger one gives smaller files and worse pictures. With 19 the
mean error of a pose is 7 % larger than from the camera's own pixels, and a bundled session takes
less than 3 MB (`python -m tests.bench.codecs`)."""

KEYFRAME_INTERVAL_S = 5
"""Time between pictures that can be decoded alone [s]."""


def frame_encoder(codec: str, size: tuple[int, int], rate: float) -> FrameEncoder:
    """Return the function that encodes the frames of a recording.

    A replay sees the decoded picture, so the tracker must see that picture too. Every message
    after it is then the same, live and replayed.

    Parameters
    ----------
    codec
        One of `CODECS`.
    size
        Width and height of the frames [px].
    rate
        Frames a second.

    Raises
    ------
    AppError
        There is no such codec, or it cannot encode pictures of this size.
    """
    check_codec(codec)
    if codec == NO_VIDEO:
        return _black_encoder(size)
    encoder: FrameEncoder = CODECS[codec](size, rate)
    return encoder


def automatic_encoder(size: tuple[int, int], rate: float) -> FrameEncoder:
    """Return an encoder that keeps the source's own bytes, and makes the smallest of pixels."""
    even = size[0] % 2 == size[1] % 2 == 0
    encode = H264Encoder(size, rate) if even else encode_jpeg
    return lambda frame: encode(frame) if frame.encoded is None else frame


def jpeg_encoder(size: tuple[int, int], rate: float) -> FrameEncoder:
    """Return the encoder of JPEG pictures, which depends on neither."""
    return encode_jpeg


def encode_jpeg(frame: Frame) -> Frame:
    """Return the frame with JPEG bytes and their decoded picture; keep bytes that it has."""
    if frame.encoded is not None:
        return frame
    done, data = cv2.imencode(".jpg", frame.image, (cv2.IMWRITE_JPEG_QUALITY, JPEG_QUALITY))
    if not done:
        raise AppError("OpenCV could not encode the camera's picture as a JPEG")
    image = cv2.imdecode(data, cv2.IMREAD_COLOR)
    assert image is not None, "OpenCV reads what it wrote"
    return dataclasses.replace(
        frame, image=np.asarray(image, np.uint8), encoded=data.tobytes(), encoding="jpeg"
    )


def _black_encoder(size: tuple[int, int]) -> FrameEncoder:
    """Return an encoder that records black pictures, while the tracker sees the camera's."""
    black = cv2.imencode(".jpg", np.zeros((size[1], size[0], 3), np.uint8))[1].tobytes()
    return lambda frame: dataclasses.replace(frame, encoded=black, encoding="jpeg")


class H264Encoder:
    """Encodes H.264 without delay: one packet a frame, decoded again at once.

    Raises
    ------
    AppError
        The width or the height is odd: the colours have half the resolution.
    """

    def __init__(self, size: tuple[int, int], rate: float) -> None:
        if size[0] % 2 or size[1] % 2:
            raise AppError(
                f"H.264 needs an even width and height, not {size[0]}x{size[1]}: "
                "record with --codec jpeg"
            )
        encoder = av.CodecContext.create("libx264", "w")
        assert isinstance(encoder, av.VideoCodecContext)
        encoder.width, encoder.height = size
        encoder.pix_fmt = "yuv420p"
        encoder.framerate = Fraction(max(1, round(rate)))
        encoder.time_base = 1 / encoder.framerate
        # One thread gives the same bytes on every machine, whatever its number of cores.
        encoder.thread_count = 1
        encoder.options = {
            "preset": "veryfast",
            # Without it x264 adds detail to please eyes; that is large, and moves the cube's edges.
            "tune": "psnr",
            "crf": str(H264_CRF),
            "x264-params": "bframes=0:rc-lookahead=0:sync-lookahead=0:repeat-headers=1"
            f":keyint={KEYFRAME_INTERVAL_S * round(rate)}:force-cfr=1"
            ":colorprim=bt470bg:transfer=bt470bg:colormatrix=bt470bg",
        }
        self._encoder = encoder
        decoder = av.CodecContext.create("h264", "r")
        assert isinstance(decoder, av.VideoCodecContext)
        decoder.thread_count = 1
        self._decoder = decoder
        self._count = 0

    def __call__(self, frame: Frame) -> Frame:
        """Return the frame with its packet and the decoded picture; keep a packet that it has."""
        if frame.encoding == "h264" and frame.encoded is not None:
            return frame
        planes = cv2.cvtColor(frame.image, cv2.COLOR_BGR2YUV_I420)
        picture = av.VideoFrame.from_ndarray(np.asarray(planes, np.uint8), format="yuv420p")
        picture.pts = self._count
        self._count += 1
        data = b"".join(bytes(packet) for packet in self._encoder.encode(picture))
        decoded = self._decoder.decode(av.Packet(data))
        if len(decoded) != 1:
            raise AppError("the H.264 encoder delayed a frame: record with --codec jpeg")
        image = cv2.cvtColor(decoded[0].to_ndarray(), cv2.COLOR_YUV2BGR_I420)
        return dataclasses.replace(
            frame, image=np.asarray(image, np.uint8), encoded=data, encoding="h264"
        )
