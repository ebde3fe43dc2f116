"""Brows that rise with the accents of a speech.

Brows go with accents often and not always: Cavé et al., "About the relationship between eyebrow
movements and F0 variations", 1996, count 71 %. Heights and times are ours.
"""

from collections.abc import Sequence

import numpy as np

from cubeling.characters.face.lids import numbers_by_name
from cubeling.characters.motion.curves import ease
from cubeling.characters.speech.speech import Accent

RISING_S, FALLING_S = 0.16, 0.32
"""How long before an accent the brows begin to rise, and how long after it they are down [s]."""

SHARE_OF_ACCENTS = 0.71
"""Share of the accents that brows go with."""

MIN_STRENGTH = 0.3
"""Strength from which on an accent moves the brows."""

MAX_RAISE = 0.75
"""Weight of the morphs that raise the brows at the strongest accent."""

LID_SHARE = 0.35
"""How far the lids widen with the brows."""

_PARTS = {"browinnerup": 1.0, "browouterup": 0.8, "eyewide": LID_SHARE}


class AccentBrows:
    """Raises the brows of one character; the same seed gives the same brows."""

    def __init__(self, morphs: Sequence[str], seed: int) -> None:
        names = numbers_by_name(morphs)
        self._morphs = [
            (names[stem + side], weight)
            for stem, weight in _PARTS.items()
            for side in ("", "left", "right", "l", "r")
            if stem + side in names
        ]
        self._rng = np.random.default_rng(seed)
        self._raises: list[tuple[float, float]] = []

    def plan(self, accents: Sequence[Accent]) -> None:
        """Choose the accents of an utterance that the brows go with, and how high."""
        draws = self._rng.uniform(size=(len(accents), 2)).tolist()
        self._raises = [
            (accent.time, MAX_RAISE * min(accent.strength, 1.0) * (0.6 + 0.4 * height))
            for accent, (chosen, height) in zip(accents, draws, strict=True)
            if accent.strength >= MIN_STRENGTH and chosen < SHARE_OF_ACCENTS
        ]

    def height(self, time: float) -> float:
        """Return how far the brows are raised at a time of the utterance [s], 0…1."""
        return max((height * _bump(time - apex) for apex, height in self._raises), default=0.0)

    def apply(self, weights: list[float], raised: float, closed: float) -> None:
        """Raise the brows in the weights of all morphs, in place; lids that close do not widen."""
        for number, weight in self._morphs:
            share = 1.0 - closed if weight == LID_SHARE else 1.0
            weights[number] = min(weights[number] + weight * share * raised, 1.0)


def _bump(time: float) -> float:
    """Return 1 at time 0, and 0 before it rises and after it has fallen."""
    away = -time / RISING_S if time < 0 else time / FALLING_S
    return ease(1.0 - away, "cubic") if away < 1.0 else 0.0
