"""How finely pictures are encoded: as finely as the line of a page carries them in time."""

import statistics
from dataclasses import dataclass


@dataclass(frozen=True)
class Fineness:
    """How finely pictures are encoded."""

    quality: int
    """Of OpenCV's encoders, 0…100."""

    scale: float
    """Size of the picture, as a share of what was drawn."""


FINENESSES = Fineness(82, 1.0), Fineness(70, 1.0), Fineness(60, 0.75), Fineness(45, 0.5)
"""From what is finer than a screen of a phone shows, to a sixth of its bytes."""

TOO_FEW, ENOUGH = 0.7, 0.9
"""Shares of its pictures: a page that shows fewer gets coarser ones, and finer ones with more."""

SLOW_S, QUICK_S = 0.15, 0.1
"""Times from sending a picture until it is shown [s]: a slower page gets coarser ones, and a
quicker one finer ones. A frame's time on a wireless network and in a phone's decoder is less."""

WINDOW_S = 1.0
"""Time in which pictures are counted [s]."""

PATIENCE_S, MAX_PATIENCE_S = 4.0, 64.0
"""Finer pictures are tried after so long [s]; each time that is in vain, after twice as long."""


class FinenessControl:
    """Chooses how finely the pictures of one page are encoded, by how many it shows, and how soon.

    A line that stands still, of which nothing comes, says nothing of how much it can carry.

    >>> control = FinenessControl()
    >>> for number in range(60):  # every third one arrives
    ...     control.offer(number / 30)
    ...     if number % 3 == 0:
    ...         control.shown(0.05)
    >>> control.level
    1
    """

    def __init__(self) -> None:
        self.level = 0
        """The place in `FINENESSES`."""
        self._began: float | None = None
        self._offered = 0
        self._times: list[float] = []
        self._good_s, self._patience_s = 0.0, PATIENCE_S
        self._tried = False

    def shown(self, after_s: float) -> None:
        """Count a picture that was shown so long after it was sent [s]."""
        self._times.append(after_s)

    def offer(self, now: float) -> None:
        """Count a picture that is to be shown, at a time [s]."""
        self._began = now if self._began is None else self._began
        elapsed = now - self._began
        if elapsed >= WINDOW_S:
            if self._times:
                share, time = len(self._times) / self._offered, statistics.median(self._times)
                self._judge(share, time, elapsed)
            self._began, self._offered, self._times = now, 0, []
        self._offered += 1

    def _judge(self, share: float, time: float, elapsed: float) -> None:
        good = share > ENOUGH and time < QUICK_S
        self._good_s = self._good_s + elapsed if good else 0.0
        if share < TOO_FEW or time > SLOW_S:
            if self._tried:
                self._patience_s = min(2 * self._patience_s, MAX_PATIENCE_S)
            self._tried = False
            self.level = min(self.level + 1, len(FINENESSES) - 1)
        elif self._good_s >= self._patience_s and self.level:
            self._good_s, self._tried = 0.0, True
            self.level -= 1
