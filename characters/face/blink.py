"""Blinks: when they happen, and how far the lids are closed.

Sources: Bentivoglio et al., "Analysis of blink rate patterns in normal subjects", 1997, for the
intervals; Evinger, Manning and Sibony, "Eyelid movements", 1991, for the lids; Evinger et al., "Not
looking while leaping", 1994, for blinks at large gaze shifts.
"""

import math

import numpy as np

from cubeling.characters.motion.curves import ease

RESTING_HZ, TALKING_HZ = 17.0 / 60.0, 26.0 / 60.0
"""Blinks of people at rest, and in conversation [1/s]."""

INTERVAL_LOG_DEVIATION = 0.6
"""Standard deviation of the logarithm of the time between two blinks: it is log-normal."""

MIN_INTERVAL_S = 0.5
"""Shortest time between the starts of two blinks [s]."""

SOONER_S, LATER_S = 1.6, 0.5
"""A blink that is due so soon after the end of a phrase comes with it [s]; one that is due while a
phrase goes on waits for its end for so long."""

GAZE_SHIFT_RAD = math.radians(25)
"""Gaze shift from which on a blink goes along [rad]."""

CLOSING_S, CLOSED_S, OPENING_S = 0.09, 0.03, 0.17


class BlinkTimer:
    """Blinks at random intervals; the same seed gives the same blinks.

    Blinks gather at the ends of phrases and at large gaze shifts; how many there are in a minute
    stays the same.
    """

    def __init__(self, seed: int) -> None:
        self._rng = np.random.default_rng(seed)
        self._due = self._wait()  # time left at rest until the next blink [s]
        self._since = math.inf  # since the start of the last one [s]
        self._late = 0.0  # for how long a blink has waited for the end of a phrase [s]

    def update(
        self,
        elapsed: float,
        gaze_shift: float = 0.0,
        tempo: float = 1.0,
        *,
        talking: bool = False,
        phrase_ends: bool = False,
    ) -> float:
        """Advance by a time [s] and return how far the lids are closed, 0…1.

        `gaze_shift` is that of this time [rad]. A low tempo also slows the lids themselves.
        """
        self._since += elapsed * min(tempo, 1.0)
        rate = TALKING_HZ / RESTING_HZ if talking else 1.0
        self._due -= elapsed * tempo * rate
        drawn = phrase_ends and self._due < SOONER_S * rate
        drawn = drawn or gaze_shift > GAZE_SHIFT_RAD
        due = self._due <= 0.0
        if due and talking and not drawn and self._late < LATER_S:
            self._late += elapsed
            due = False
        if (due or drawn) and self._since >= MIN_INTERVAL_S:
            # What comes early or late is made up for by the next wait.
            self._due += self._wait()
            self._since = self._late = 0.0
        return lid_closure(self._since)

    def _wait(self) -> float:
        """Return the time at rest from one blink to the next [s]."""
        mean = math.log(1.0 / RESTING_HZ) - INTERVAL_LOG_DEVIATION * INTERVAL_LOG_DEVIATION / 2.0
        return float(self._rng.lognormal(mean, INTERVAL_LOG_DEVIATION))


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
