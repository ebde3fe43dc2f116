"""How pelvis, knees, trunk and head join in a speech, as values of `StanceJoints`."""

from bisect import bisect_right
from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from cubeling.characters.behaviour.realization.stances import Stance, StanceJoints
from cubeling.characters.control.speaking.beats import Pulses
from cubeling.characters.skeleton.pose import Array
from cubeling.characters.smoothing import smoothstep
from cubeling.characters.speech.phrases import Phrase
from cubeling.characters.speech.speech import Accent

BEAT_KEYS = ((-0.7, 0.0), (-0.44, -0.4), (-0.22, 1.0), (0.42, 0.0))
"""A beat of the trunk: up, down and back, from the accent [s]. It leads the hands, whose apex is
some 0.1 s before the accent."""

MIN_SIZE = 0.25
"""Size of the beat of the weakest accent, as a share of the strongest."""

_BEAT = StanceJoints.values_of(
    Stance(down=0.016, back=-0.010, hips=(1.6, 0.0, 0.0), trunk=(2.6, 0.0, 0.0))
)
_BEAT_ASIDE = StanceJoints.values_of(
    Stance(aside=0.008, hips=(0.0, 2.4, 0.9), trunk=(0.0, 2.6, -0.9), head=(0.0, -2.0, 0.0))
)
# How far each phrase takes a body, at most, to either side.
_PHRASE = StanceJoints.values_of(
    Stance(
        down=0.004,
        back=0.014,
        aside=0.008,
        hips=(0.8, 3.0, 1.2),
        trunk=(2.0, 3.5, 1.6),
        head=(1.5, 3.0, 2.5),
    )
)
_SHIFT = StanceJoints.values_of(
    Stance(down=0.012, aside=0.085, hips=(0.0, 3.0, -3.0), trunk=(0.0, -1.5, 4.0))
)

PHRASE_S, SHIFT_S = 0.9, 1.5
"""How long a body takes to its place in a new phrase, and to shift its weight [s]."""

LEAD_S = 0.3
"""It sets off so long before the first word [s]."""


class SpeakingStance:
    """The stance of one who speaks, planned for a whole speech.

    Beats go with accents. Each phrase has a place of its own, near the usual one. Weight shifts at
    `shifts` [s]: from the middle to a side, and on to the other one.
    """

    def __init__(
        self,
        phrases: Sequence[Phrase],
        accents: Sequence[Accent],
        shifts: Sequence[float],
        end: float,
        rng: np.random.Generator,
    ) -> None:
        sizes = MIN_SIZE + (1.0 - MIN_SIZE) * np.array([a.strength for a in accents])
        sides = rng.uniform(-1.0, 1.0, (len(accents), 1))
        beats = sizes[:, None] * (_BEAT + sides * _BEAT_ASIDE)
        self._beats = Pulses([each.time for each in accents], beats, BEAT_KEYS)
        places = [
            (each.start - LEAD_S, PHRASE_S, rng.uniform(-1.0, 1.0, len(_PHRASE)) * _PHRASE)
            for each in phrases
        ]
        places.append((end, PHRASE_S, np.zeros(len(_PHRASE))))
        self._place = _Places(places)
        side, leaning = rng.choice((-1.0, 1.0)), []
        for time in shifts:
            leaning.append((time, SHIFT_S, _shifted(side)))
            side = -side
        self._weight = _Places([*leaning, (end, SHIFT_S, np.zeros(len(_PHRASE)))])

    def values(self, time: float) -> Array:
        """Return the stance at a time of the speech [s], (15,)."""
        return self._beats.at(time) + self._place.at(time) + self._weight.at(time)


def _shifted(side: float) -> Array:
    """Return the stance with the weight on a side; it comes down on either."""
    values = _SHIFT * side
    values[1] = _SHIFT[1]
    return values


class _Places:
    """Values that go from one place to the next, and stay there."""

    def __init__(self, places: Sequence[tuple[float, float, Array]]) -> None:
        self._starts = [start for start, _, _ in places]
        gaps = [b - a for a, b in pairwise(self._starts)] + [np.inf]
        self._lengths = [
            min(length, max(gap, 1e-3)) for (_, length, _), gap in zip(places, gaps, strict=True)
        ]
        self._values = [np.zeros(StanceJoints.VALUES), *(values for _, _, values in places)]

    def at(self, time: float) -> Array:
        """Return the values at a time [s]."""
        place = bisect_right(self._starts, time)
        if place == 0:
            return self._values[0]
        before, after = self._values[place - 1 : place + 1]
        share = (time - self._starts[place - 1]) / self._lengths[place - 1]
        return after if share >= 1.0 else before + (after - before) * smoothstep(share)
