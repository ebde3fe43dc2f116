"""Frames from a recorded session: the very pixels that the tracker saw live."""

import itertools
from collections.abc import Generator, Iterator
from pathlib import Path

import numpy as np

from tracking.errors import TrackingError
from tracking.geometry.frame import Frame
from tracking.sources.base import FrameSource, Timeline
from tracking.sources.channels import IMAGE_TOPIC, BrokenFileError, CameraChannels
from tracking.sources.pictures import EncodedPicture, Picture, PictureDecoder, UndecodableError

PEEKED = 30
"""Pictures looked at while opening, to learn the rate and the calibration."""


class SessionSource(FrameSource):
    """The camera of an `.mcap` session.

    Reads forwards only, so a file that was cut off serves all its whole frames.

    Raises
    ------
    TrackingError
        While opening: the file is absent, is not MCAP, or holds no camera frame. While iterating:
        it is cut short or damaged, after every frame that could be read.
    """

    live = False

    def __init__(self, path: str | Path) -> None:
        self._where = f"the session '{path}'"
        try:
            self._file = Path(path).open("rb")  # noqa: SIM115  # `close` closes it
        except OSError as error:
            raise TrackingError(f"cannot open {self._where}: {error.strerror}") from error
        try:
            channels = CameraChannels(self._file)
            self.duration = channels.duration()
            self.rate, pictures = _nominal_rate(channels.pictures())
            self._frames = self._decoded(pictures)
            self._first = next(self._frames, None)
            if self._first is None:
                raise TrackingError(f"{self._where} holds no camera frame on {IMAGE_TOPIC}")
        except BaseException:
            self._file.close()
            raise
        height, width = self._first.image.shape[:2]
        self.size = (width, height)
        lens = channels.intrinsics
        self.intrinsics = lens.scaled(self.size) if lens and lens.size != self.size else lens

    def __iter__(self) -> Iterator[Frame]:
        if self._first is not None:
            first, self._first = self._first, None
            yield first
        yield from self._frames

    def close(self) -> None:
        """Close the file. Safe to call again; the iteration then ends."""
        self._first = None
        self._frames.close()
        self._file.close()

    def _decoded(self, pictures: Iterator[EncodedPicture]) -> Generator[Frame, None, None]:
        timeline, count = Timeline(), 0
        try:
            for picture, image in _decode(pictures):
                stamp = timeline.stamp(picture.timestamp)
                yield Frame(image, stamp, count, picture.data, picture.encoding)
                count += 1
        except BrokenFileError as broken:
            raise TrackingError(f"{self._where} {broken}: {_readable(count)}") from broken


def _decode(pictures: Iterator[EncodedPicture]) -> Iterator[tuple[EncodedPicture, Picture]]:
    """Pair each picture with its pixels; what the decoder still holds comes out before an error."""
    decoder = PictureDecoder()
    broken: Exception | None = None
    try:
        for picture in pictures:
            yield from decoder.decode(picture)
    except (BrokenFileError, UndecodableError) as error:
        broken = error
    yield from decoder.flush()
    if isinstance(broken, UndecodableError):
        raise BrokenFileError(f"has {broken}") from broken
    if broken is not None:
        raise broken


def _nominal_rate(
    pictures: Iterator[EncodedPicture],
) -> tuple[float, Iterator[EncodedPicture]]:
    """Look at the first pictures' times [frames/s]; give back the same pictures, and any error."""
    peeked: list[EncodedPicture] = []

    def replayed() -> Iterator[EncodedPicture]:
        yield from peeked
        if broken is not None:
            raise broken
        yield from pictures

    broken: BrokenFileError | None = None
    try:
        peeked.extend(itertools.islice(pictures, PEEKED))
    except BrokenFileError as error:
        broken = error
    steps = np.diff([picture.timestamp for picture in peeked])
    step = float(np.median(steps)) if len(steps) else 0.0
    return (round(1 / step, 3) if step > 0 else 30.0), replayed()


def _readable(count: int) -> str:
    if count == 0:
        return "no frame could be read"
    return f"its first {count} frames could be read" if count > 1 else "one frame could be read"
