"""When a character blinks, and how far its lids are closed.

People who rest blink about 17 times a minute, at uneven intervals (Bentivoglio et al., "Analysis of
blink rate patterns in normal subjects", 1997); a lid falls in about 90 ms and rises in 170
(Evinger, Manning and Sibony, "Eyelid movements", 1991). A large turn of the gaze brings a blink
along (Evinger et al., "Not looking while leaping", 1994).
"""

import math

import numpy as np

MEAN_INTERVAL = 3.6
"""Between two blinks [s]."""

SHORTEST_INTERVAL = 0.7
"""Between two blinks [s]; a pair of them comes as close as this."""

_CLOSING, _SHUT, _OPENING = 0.09, 0.03, 0.17  # [s]


class Blinking:
    """Blinks at uneven intervals; the same seed blinks alike.

    Parameters
    ----------
    seed
        Characters with different seeds do not blink together.
    """

    def __init__(self, seed: int) -> None:
        self._rng = np.random.default_rng(seed)
        self._now = 0.0
        self._start = self._wait()

    def update(self, elapsed: float, turned: float = 0.0, pace: float = 1.0) -> float:
        """Advance by a time [s] and return how far the lids are closed, 0…1.

        Parameters
        ----------
        elapsed
            Since the last call.
        turned
            How far the gaze has jumped since then [rad].
        pace
            How much quicker blinks follow each other; lids themselves only slow down, for those
            who are drowsy.
        """
        waiting = self._now < self._start
        self._now += elapsed * (pace if waiting else min(pace, 1.0))
        open_again = self._start + _CLOSING + _SHUT + _OPENING
        if self._now > open_again:
            self._now -= open_again
            self._start = self._wait()
        if turned > math.radians(25) and self._now + SHORTEST_INTERVAL / 2 < self._start:
            self._start = self._now
        return closed(self._now - self._start)

    def _wait(self) -> float:
        """Return the time until the next blink: never at once, and without a longest one [s]."""
        return SHORTEST_INTERVAL + float(self._rng.exponential(MEAN_INTERVAL - SHORTEST_INTERVAL))


def closed(time: float) -> float:
    """Return how far the lids are closed a time [s] after they began to fall.

    >>> closed(-1.0), closed(0.1), closed(1.0)
    (0.0, 1.0, 0.0)
    """
    if time <= 0.0 or time >= _CLOSING + _SHUT + _OPENING:
        return 0.0
    if time < _CLOSING:
        return _smooth(time / _CLOSING)
    return _smooth(1.0 - max(time - _CLOSING - _SHUT, 0.0) / _OPENING)


def _smooth(u: float) -> float:
    return u * u * (3.0 - 2.0 * u)
