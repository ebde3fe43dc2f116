"""The voices of a cast: each of its characters has one of its own, by its name."""

import zlib
from collections.abc import Sequence

from cubeling.characters.speech import Manner

OWN_VOICES = (
    Manner(rate=1.02, pitch=1.25, speaker=1),
    Manner(rate=0.94, pitch=0.75, speaker=2),
    Manner(rate=1.06, pitch=0.90, speaker=3),
    Manner(rate=1.00, pitch=1.55, speaker=4),
    Manner(rate=0.96, pitch=1.60, speaker=5),
    Manner(rate=0.90, pitch=0.60, speaker=6),
)
"""Voices of the further characters; a program with one speaker only has them by pitch and rate."""


def voices_of_cast(names: Sequence[str]) -> dict[str, Manner]:
    """Return how each of the further characters speaks, by its name: no two in the same way.

    The seed of a name chooses; where that voice is taken, it is the next one.

    >>> [each.speaker for each in voices_of_cast(["vleo", "human_2", "vleo_2"]).values()]
    [6, 1, 5]
    """
    free = list(range(len(OWN_VOICES)))
    voices = {}
    for name in names:
        wanted = zlib.crc32(name.encode()) % len(OWN_VOICES)
        chosen = min(free, key=lambda number: (number - wanted) % len(OWN_VOICES))
        free.remove(chosen)
        voices[name] = OWN_VOICES[chosen]
    return voices


def combined(one: Manner, other: Manner) -> Manner:
    """Return one manner of speaking in another.

    >>> combined(Manner(1.1, 0.9), Manner(pitch=2.0, speaker=3))
    Manner(rate=1.1, pitch=1.8, range=1.0, speaker=3)
    """
    return Manner(
        one.rate * other.rate,
        one.pitch * other.pitch,
        one.range * other.range,
        other.speaker or one.speaker,
    )
