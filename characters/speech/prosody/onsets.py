"""Stressed syllables of a live voice: where it becomes louder than it usually is.

A live detector cannot know what follows, so it reports an onset, and not the middle of a syllable.
"""

import numpy as np

from cubeling.characters.speech.speech import Samples

STEP_S = 0.01
"""Time from one measurement to the next [s]."""

FAST_S, SLOW_S = 0.03, 2.0
"""Time constants of the present level and of the usual one [s]."""

LOUDER_DB, FULL_DB = 3.0, 10.0
"""A stressed syllable is so much louder than usual, and one of full strength [dB]."""

QUIETEST_DB = -45.0
"""Nothing quieter is a voice [dB relative to a constant sample of 1]."""

MIN_INTERVAL_S = 0.8
"""Least time between two that are reported [s]: hands cannot beat faster."""


class OnsetDetector:
    """Finds stressed syllables in blocks of sound, in the order of time.

    Parameters
    ----------
    rate
        Sample rate of the blocks [Hz].
    """

    def __init__(self, rate: int) -> None:
        self._step = round(STEP_S * rate)
        self._rest = np.zeros(0, np.float32)
        self._fast = self._slow = QUIETEST_DB
        self._since = MIN_INTERVAL_S

    def update(self, block: Samples) -> float | None:
        """Take the next samples; return the strength of an onset in them, 0…1, or None."""
        sound = np.concatenate([self._rest, np.nan_to_num(block).astype(np.float32)])
        count = len(sound) // self._step
        self._rest = sound[count * self._step :]
        steps = sound[: count * self._step].reshape(count, self._step)
        levels = 10.0 * np.log10(np.mean(steps * steps, axis=1) + 1e-10)
        found = None
        for level in np.maximum(levels, QUIETEST_DB).tolist():
            strength = self._take(level)
            found = strength if found is None else found
        return found

    def _take(self, level: float) -> float | None:
        """Take the level of a step [dB]."""
        self._since += STEP_S
        self._fast += (level - self._fast) * STEP_S / (STEP_S + FAST_S)
        louder = self._fast - self._slow
        # The usual level is that of speech: it does not follow into pauses.
        if level > QUIETEST_DB + 10.0:
            self._slow += (level - self._slow) * STEP_S / (STEP_S + SLOW_S)
        if louder < LOUDER_DB or self._since < MIN_INTERVAL_S:
            return None
        self._since = 0.0
        return min((louder - LOUDER_DB) / (FULL_DB - LOUDER_DB), 1.0)
