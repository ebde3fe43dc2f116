"""Blinks: when they happen, and how far the lids are closed.

Sources: Bentivoglio et al., "Analysis of blink rate patterns in normal subjects", 1997, for the
intervals; Evinger, Manning and Sibony, "Eyelid movements", 1991, for the lids; Evinger et al., "Not
looking while leaping", 1994, for blinks at large gaze shifts.
"""

import math

import numpy as np

from cubeling.characters.motion.curves import ease

MEAN_INTERVAL_S = 3.6
"""Mean time between two blinks [s]."""

MIN_INTERVAL_S = 0.7
"""Shortest time between two blinks [s]."""

GAZE_SHIFT_RAD = math.radians(25)
"""Gaze shift from which on a blink goes along [rad]."""

CLOSING_S, CLOSED_S, OPENING_S = 0.09, 0.03, 0.17


class BlinkTimer:
    """Blinks at random intervals; the same seed gives the same blinks."""

    def __init__(self, seed: int) -> None:
        self._rng = np.random.default_rng(seed)
        self._now = 0.0
        self._start = self._wait()

    def update(self, elapsed: float, gaze_shift: float = 0.0, tempo: float = 1.0) -> float:
        """Advance by a time [s] and return how far the lids are closed, 0…1.

        `gaze_shift` is that of this time [rad]. A low tempo also slows the lids themselves.
        """
        waiting = self._now < self._start
        self._now += elapsed * (tempo if waiting else min(tempo, 1.0))
        end = self._start + CLOSING_S + CLOSED_S + OPENING_S
        if self._now > end:
            self._now -= end
            self._start = self._wait()
        if gaze_shift > GAZE_SHIFT_RAD and self._now + MIN_INTERVAL_S / 2 < self._start:
            self._start = self._now
        return lid_closure(self._now - self._start)

    def _wait(self) -> float:
        """Return the time until the next blink [s], from a shifted exponential distribution."""
        return MIN_INTERVAL_S + float(self._rng.exponential(MEAN_INTERVAL_S - MIN_INTERVAL_S))


def lid_closure(time: float) -> float:
    """Return how far the lids are closed, 0…1, a time [s] after the start of a blink.

    >>> lid_closure(-1.0), lid_closure(0.1), lid_closure(1.0)
    (0.0, 1.0, 0.0)
    """
    if time <= 0.0 or time >= CLOSING_S + CLOSED_S + OPENING_S:
        return 0.0
    if time < CLOSING_S:
        return ease(time / CLOSING_S, "cubic")
    return ease(1.0 - max(time - CLOSING_S - CLOSED_S, 0.0) / OPENING_S, "cubic")
