"""Frames from a recorded session: the same pixels that the tracker saw live."""

import itertools
from collections.abc import Generator, Iterator
from pathlib import Path

import numpy as np

from cubeling.files import FileKind
from cubeling.tracking.errors import TrackingError
from cubeling.tracking.geometry.frame import Frame
from cubeling.tracking.sources.base import StoredFrames, Timeline, readable_frames
from cubeling.tracking.sources.decoding import BrokenFileError, EncodedImage, decode
from cubeling.tracking.sources.device import Clock
from cubeling.tracking.sources.mcap_camera import IMAGE_TOPIC, CameraChannels

SESSION_FILE = FileKind(
    "session",
    (".mcap",),
    TrackingError,
    1 << 40,
    "cubeling.tracking.sources.session:SessionSource",
)
"""The camera of a session; it is read frame by frame, so its size does not matter."""

PEEKED_IMAGES = 30
"""Number of images read while opening, to find the rate and the calibration."""


class SessionSource(StoredFrames):
    """The camera of an `.mcap` session.

    Reads forwards only, so all complete frames of a truncated file are returned.

    Raises
    ------
    TrackingError
        While opening: the file does not exist, is not MCAP, or holds no camera frame. While
        iterating: it is truncated or damaged, after every readable frame.
    """

    def __init__(self, path: str | Path) -> None:
        self._where = f"the session '{path}'"
        self._file = SESSION_FILE.open(path)
        try:
            self._channels = CameraChannels(self._file)
            self.duration = self._channels.duration
            self.rate, images = _nominal_rate(self._channels.images())
            self.start(
                self._decode_frames(images, 0),
                f"{self._where} holds no camera frame on {IMAGE_TOPIC}",
            )
        except BaseException:
            self._file.close()
            raise
        found = self._channels.intrinsics
        self.intrinsics = found.scale(self.size) if found and found.size != self.size else found

    def close(self) -> None:
        """Close the file and end the iteration. May be called again."""
        super().close()
        self._file.close()

    def restart(self, index: int, timestamp: float | None = None) -> None:
        """Return the frames again, from one on; its place is found by the index of the file."""
        super().close()
        self._frames = self._decode_frames(self._channels.images_from(index, timestamp), index)

    def _decode_frames(
        self, images: Iterator[EncodedImage], index: int
    ) -> Generator[Frame, None, None]:
        timeline = Timeline()
        try:
            for encoded, image in decode(images):
                stamp = timeline.stamp(encoded.timestamp)
                yield Frame(image, stamp, index, encoded.data, encoded.encoding)
                index += 1
        except BrokenFileError as broken:
            raise TrackingError(f"{self._where} {broken}: {readable_frames(index)}") from broken


def open_uri(uri: str, size: tuple[int, int] | None, clock: Clock) -> SessionSource:
    """Open the path of a session; size and times are those of the recording."""
    return SessionSource(uri)


def _nominal_rate(images: Iterator[EncodedImage]) -> tuple[float, Iterator[EncodedImage]]:
    """Return the rate by the first images [frames/s], and the same images, with any error."""
    peeked: list[EncodedImage] = []
    broken: BrokenFileError | None = None
    try:
        peeked.extend(itertools.islice(images, PEEKED_IMAGES))
    except BrokenFileError as error:
        broken = error

    def all_images() -> Iterator[EncodedImage]:
        yield from peeked
        if broken is not None:
            raise broken
        yield from images

    steps = np.diff([encoded.timestamp for encoded in peeked])
    step = float(np.median(steps)) if len(steps) else 0.0
    return (round(1 / step, 3) if step > 0 else 30.0), all_images()
