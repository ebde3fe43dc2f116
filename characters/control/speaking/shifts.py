"""When a speaker shifts weight.

Shifts come with a change of topic far more often than within one: Cassell et al., "Non-verbal cues
for discourse structure", 2001; the figures are those of the BEAT generator.
"""

import math
from collections.abc import Sequence

import numpy as np

from cubeling.characters.speech.prosody.phrases import Phrase

AT_TOPIC = 0.84
"""Probability of a shift at a change of topic."""

WITHIN_TOPIC_HZ = 0.04
"""Shifts within a topic [1/s]; they wait for the next phrase."""

LEAD_S = 0.25
"""A shift begins so long before the first word of its phrase [s]."""


def shift_times(phrases: Sequence[Phrase], rng: np.random.Generator) -> tuple[float, ...]:
    """Return when weight is shifted, in order, from the start of a speech [s]."""
    times, last = [], phrases[0].start if phrases else 0.0
    for phrase in phrases[1:]:
        within = 1.0 - math.exp(-WITHIN_TOPIC_HZ * (phrase.start - last))
        if rng.uniform() < (AT_TOPIC if phrase.opens_topic else within):
            times.append(phrase.start - LEAD_S)
        last = phrase.start
    return tuple(times)
