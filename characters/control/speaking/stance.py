"""How pelvis, knees, trunk and head join in a speech, as values of `StanceJoints`."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from cubeling.characters.behaviour.realization.stances import Stance, StanceJoints
from cubeling.characters.control.speaking.beats import pulses
from cubeling.characters.skeleton.pose import Array
from cubeling.characters.smoothing import smoothstep
from cubeling.characters.speech.prosody.phrases import Phrase
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


def stance_movement(
    times: Array,
    phrases: Sequence[Phrase],
    accents: Sequence[Accent],
    shifts: Sequence[float],
    end: float,
    rng: np.random.Generator,
) -> Array:
    """Return the stance of one who speaks at `times` [s], (times, 15).

    Beats go with accents. Each phrase has a place of its own, near the usual one. Weight shifts at
    `shifts` [s]: from the middle to a side, and on to the other one. At the `end` [s] all goes back
    to the middle.
    """
    sizes = MIN_SIZE + (1.0 - MIN_SIZE) * np.array([each.strength for each in accents])
    sides = rng.uniform(-1.0, 1.0, (len(accents), 1))
    beats = sizes[:, None] * (_BEAT + sides * _BEAT_ASIDE)
    found = pulses(times, [each.time for each in accents], beats, BEAT_KEYS)
    middle = np.zeros(StanceJoints.VALUES)
    places = [(p.start - LEAD_S, rng.uniform(-1.0, 1.0, len(middle)) * _PHRASE) for p in phrases]
    found += _ways(times, [*places, (end, middle)], PHRASE_S)
    side = rng.choice((-1.0, 1.0))
    leaning = []
    for time in shifts:
        values = _SHIFT * side
        values[1] = _SHIFT[1]  # it comes down on either side
        leaning.append((time, values))
        side = -side
    return found + _ways(times, [*leaning, (end, middle)], SHIFT_S)


def _ways(times: Array, places: Sequence[tuple[float, Array]], length: float) -> Array:
    """Return values that go from one place to the next in at most so long [s], and stay there."""
    found = np.zeros((len(times), StanceJoints.VALUES))
    before = np.zeros(StanceJoints.VALUES)
    for (start, values), (following, _) in pairwise([*places, (np.inf, before)]):
        share = (times - start) / min(length, max(following - start, 1e-3))
        begun = share >= 0.0
        found[begun] = before + smoothstep(share[begun].clip(0.0, 1.0))[:, None] * (values - before)
        before = values
    return found
