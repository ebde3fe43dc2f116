"""The clock of a session."""

import time


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
