"""What every source of frames offers, and the rule for its timestamps."""

import math
from collections.abc import Iterator
from types import TracebackType
from typing import Protocol, Self, runtime_checkable

from tracking.geometry.frame import Frame
from tracking.geometry.intrinsics import Intrinsics
from tracking.sources.health import Health


@runtime_checkable
class FrameSource(Protocol):
    """Something that frames come out of: a camera, a file, a recording, a phone, a drawing.

    Lifecycle: whoever opens a source closes it, best with `with`. `close` may be called twice, and
    of a live source from another thread than the one that iterates; the iteration then ends.
    A source is iterated once.

    A device that is lost while it is iterated (unplugged, silent, frozen) is no error at once: the
    source opens it anew until it is back, and goes on with the same clock; `LiveFrames` shows the
    gap. A plain iteration waits through a gap of up to 30 s, then it ends with the error.

    Raises
    ------
    TrackingError
        While opening: there is nothing to read. While iterating: the source fell silent or broke.
        Every frame that could be read has been given out before.
    """

    intrinsics: Intrinsics | None
    """Of the camera that took the frames; None where the source does not know them."""

    size: tuple[int, int]
    """Width and height of every frame [px]."""

    rate: float
    """Nominal rate [frames/s]; the timestamps say what really came."""

    live: bool
    """Whether frames arrive by themselves and late ones are dropped (True), or each waits until
    it is asked for (False)."""

    duration: float | None
    """Length [s]; None where it has no end or none is known."""

    def __iter__(self) -> Iterator[Frame]:
        """Give out the frames in order."""
        ...

    def close(self) -> None:
        """Let go of the device, file or connection. Safe to call again."""
        ...

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()


@runtime_checkable
class LiveFrames(FrameSource, Protocol):
    """A live source that says how it fares, for who must not be blocked: a window, a robot.

    Whatever happens to the device, `wait` returns within its timeout, and `health` says within a
    second that nothing new comes: "lost" (unplugged, silent, garbage), "frozen" (the very same
    picture again and again) or, once the device is open again, "recovering"; all three last
    until a new picture comes, however often the device is tried. Timestamps go on increasing
    across a gap. `wait` and iterating may be mixed; one thread does either.
    """

    def wait(self, timeout: float, patience: float | None = None) -> Frame | None:
        """Wait for a frame newer than the last.

        Parameters
        ----------
        timeout
            Return None when none came for so long [s].
        patience
            How long the source may be lost or frozen [s]; None: for ever.

        Raises
        ------
        TrackingError
            It was lost for longer than `patience`, or came back with pictures of another size.
        """
        ...

    @property
    def health(self) -> Health:
        """How the source fares at this moment; callable from any thread."""
        ...


class Timeline:
    """Turns a source's raw times into timestamps that a session file keeps exactly.

    >>> line = Timeline()
    >>> [line.stamp(t) for t in (0.1234567891234, 0.5, 0.4)]
    [0.123456789, 0.5, 0.5]
    """

    def __init__(self) -> None:
        self._last = -float("inf")

    def stamp(self, seconds: float) -> float:
        """Round to whole nanoseconds, and never go back."""
        self._last = max(self._last, seconds_of(nanoseconds_of(seconds)))
        return self._last


def nanoseconds_of(seconds: float) -> int:
    """Return the whole nanoseconds nearest to a time.

    `seconds * 1e9` alone would be off after 26 days, the age at which some computers are rebooted.

    >>> nanoseconds_of(9_000_000.123456789)
    9000000123456789
    """
    whole = math.floor(seconds)
    return whole * 1_000_000_000 + round((seconds - whole) * 1e9)


def seconds_of(nanoseconds: int) -> float:
    """Return a whole number of nanoseconds in seconds, the inverse of `nanoseconds_of`."""
    return nanoseconds / 1_000_000_000
