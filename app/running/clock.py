"""The one clock that the program hands down."""

import time


class SessionClock:
    """Follows the wall until it is driven; then it shows the time of the session.

    A recording that is drawn faster or slower than it was taken drives the clock by its frames, so
    the robot lives through the same seconds as the character.
    """

    def __init__(self) -> None:
        self._offset = -time.monotonic()
        self._driven: float | None = None

    def __call__(self) -> float:
        """Return the time [s]; it never goes back."""
        if self._driven is not None:
            return self._driven
        return time.monotonic() + self._offset

    def drive(self, seconds: float) -> None:
        """Take over: from now on the clock shows the session's time, `seconds` after its start."""
        if self._driven is None:
            self._start = self()
            self._driven = self._start
        self._driven = max(self._driven, self._start + seconds)

    def release(self) -> None:
        """Follow the wall again, from the time shown now."""
        if self._driven is not None:
            self._offset = self._driven - time.monotonic()
            self._driven = None
