"""The clock of a session, and the pace of recorded frames."""

import time
from collections.abc import Callable


class SessionClock:
    """Shows the monotonic time of the computer until `drive` sets it to the time of the frames.

    A recording that is processed faster or slower than it was recorded drives the clock by its
    frames. The robot then lives through the same seconds as the character.
    """

    def __init__(self) -> None:
        self._offset = -time.monotonic()
        self._driven: float | None = None

    def __call__(self) -> float:
        """Return the time [s]; it never goes back."""
        if self._driven is not None:
            return self._driven
        return time.monotonic() + self._offset

    def drive(self, elapsed: float) -> None:
        """Set the clock to `elapsed` seconds after the first call of `drive`."""
        if self._driven is None:
            self._start = self()
            self._driven = self._start
        self._driven = max(self._driven, self._start + elapsed)

    def release(self) -> None:
        """Run with the computer's time again, from the time shown now."""
        if self._driven is not None:
            self._offset = self._driven - time.monotonic()
            self._driven = None


class Pace:
    """Plays recorded frames at the speed at which they were recorded.

    Parameters
    ----------
    max_late
        A frame that is due for longer than this [s] is not drawn; infinite to draw every frame, in
        slow motion on a slow computer.
    clock, sleep
        The time [s], and what waits for a number of seconds.
    """

    MAX_LEFT_OUT_S = 0.5
    """Frames are not drawn for this time at most before one is, however slow the computer. If that
    does not help, the recording plays slower."""

    def __init__(
        self,
        max_late: float,
        clock: Callable[[], float] = time.monotonic,
        sleep: Callable[[float], None] = time.sleep,
    ) -> None:
        self.max_late = max_late
        """From when on a frame is not drawn [s]."""
        self._clock, self._sleep = clock, sleep
        self._offset: float | None = None
        self._leaving_out_since: float | None = None

    def restart(self) -> None:
        """Show the next frame at once, as after a pause."""
        self._offset = self._leaving_out_since = None

    @property
    def due_from_timestamp(self) -> float:
        """What added to a frame's timestamp says when it is due, by the clock [s]."""
        return self._offset or 0.0

    def wait(self, timestamp: float) -> bool:
        """Wait until a frame is due; return False if it is too late and is not to be drawn."""
        now = self._clock()
        if self._offset is None:
            self._offset = now - timestamp
        late = now - (self._offset + timestamp)
        if late < 0.0:
            self._sleep(-late)
        if late > self.max_late:
            if self._leaving_out_since is None:
                self._leaving_out_since = now
            if now - self._leaving_out_since < self.MAX_LEFT_OUT_S:
                return False
            self._offset += late
        self._leaving_out_since = None
        return True
