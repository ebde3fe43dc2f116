"""The interfaces of frame sources, and the rule for their timestamps."""

import math
from collections.abc import Generator, Iterator
from typing import Protocol, Self, runtime_checkable

from cubeling.tracking.errors import TrackingError
from cubeling.tracking.geometry.frame import Frame
from cubeling.tracking.geometry.intrinsics import Intrinsics
from cubeling.tracking.sources.device import Health


@runtime_checkable
class FrameSource(Protocol):
    """A source of frames: a camera, a video, a recorded session, a phone, a renderer.

    Lifecycle: the caller that opens a source closes it, best with `with`. `close` may be called
    twice, and for a live source also from another thread, which ends the iteration. A source is
    iterated once.

    If the device of a live source is lost (unplugged, silent, frozen), the source opens it again
    until it is back and continues on the same clock; `LiveFrames` shows the gap. A plain iteration
    waits through a gap of up to 30 s, then raises.

    Raises
    ------
    TrackingError
        While opening: there is nothing to read. While iterating: the source fell silent or broke;
        all readable frames have been returned before.
    """

    intrinsics: Intrinsics | None
    """Intrinsics of the camera that took the frames; None if the source does not know them."""

    size: tuple[int, int]
    """Width and height of every frame [px]."""

    rate: float
    """Nominal rate [frames/s]; the timestamps give the actual one."""

    live: bool
    """Whether frames arrive by themselves and old ones are dropped (True), or each frame waits
    until it is requested (False)."""

    duration: float | None
    """Length [s]; None if it is unlimited or unknown."""

    def __iter__(self) -> Iterator[Frame]:
        """Return the frames in order."""
        ...

    def close(self) -> None:
        """Release the device, file or connection. May be called again."""
        ...

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exception: object) -> None:
        self.close()


@runtime_checkable
class LiveFrames(FrameSource, Protocol):
    """A live source that reports its health, for callers that must not block: a window, a robot.

    `wait` always returns within its timeout. `health` reports within a second that no new images
    arrive: "lost" (unplugged, silent, broken images or of another size), "frozen" (identical ones)
    or, once the device is open again, "recovering". The state lasts until a new image arrives.
    Timestamps keep increasing across a gap. `wait` and iteration may be mixed, in one thread.
    """

    def wait(self, timeout: float, patience: float | None = None) -> Frame | None:
        """Wait for a frame newer than the last one.

        Parameters
        ----------
        timeout
            Return None if no frame arrives within this time [s].
        patience
            How long the source may be lost or frozen [s]; None: without limit.

        Raises
        ------
        TrackingError
            It was lost for longer than `patience`.
        """
        ...

    @property
    def health(self) -> Health:
        """The current state of the source. May be called from any thread."""
        ...


@runtime_checkable
class BufferedFrames(LiveFrames, Protocol):
    """A live source that can keep frames for a caller that is slower for a while."""

    max_waiting: int
    """How many frames are kept until they are waited for; of more, the oldest are dropped. 1, as it
    is at first, for the newest only."""

    @property
    def waiting(self) -> int:
        """How many frames are kept now: with any, the last one is not the newest."""
        ...


class StoredFrames(FrameSource):
    """Frames that are decoded on request from a file; the first one is decoded while opening."""

    live = False

    def start(self, frames: Generator[Frame, None, None], if_empty: str) -> None:
        """Decode the first frame, to know the size; `if_empty` is the error if there is none."""
        self._frames = frames
        self._first = next(frames, None)
        if self._first is None:
            raise TrackingError(if_empty)
        height, width = self._first.image.shape[:2]
        self.size = (width, height)

    def __iter__(self) -> Iterator[Frame]:
        if self._first is not None:
            first, self._first = self._first, None
            yield first
        yield from self._frames

    def restart(self, index: int, timestamp: float | None = None) -> None:
        """Return the frames again, from one on; none if there are not as many.

        Its timestamp, where it is known [s], may spare looking for it.
        """
        raise NotImplementedError

    def close(self) -> None:
        """End the iteration. May be called again."""
        self._first = None
        self._frames.close()


class Timeline:
    """Turns a source's times into timestamps that a session file stores exactly.

    >>> line = Timeline()
    >>> [line.stamp(t) for t in (0.1234567891234, 0.5, 0.4)]
    [0.123456789, 0.5, 0.5]
    """

    def __init__(self) -> None:
        self._last = -float("inf")

    def stamp(self, seconds: float) -> float:
        """Round a time to whole nanoseconds; never return less than before."""
        self._last = max(self._last, seconds_of(nanoseconds_of(seconds)))
        return self._last


def nanoseconds_of(seconds: float) -> int:
    """Return a time in whole nanoseconds.

    `seconds * 1e9` alone loses precision once a computer has run for 26 days.

    >>> nanoseconds_of(9_000_000.123456789)
    9000000123456789
    """
    whole = math.floor(seconds)
    return whole * 1_000_000_000 + round((seconds - whole) * 1e9)


def seconds_of(nanoseconds: int) -> float:
    """Return a time in seconds, the inverse of `nanoseconds_of`."""
    return nanoseconds / 1_000_000_000


def readable_frames(count: int) -> str:
    """Return what could be read of a damaged file, in words.

    >>> readable_frames(0), readable_frames(1), readable_frames(2)
    ('no frame could be read', 'one frame could be read', 'its first 2 frames could be read')
    """
    if count == 0:
        return "no frame could be read"
    return f"its first {count} frames could be read" if count > 1 else "one frame could be read"
