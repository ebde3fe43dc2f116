"""Impulses: what an action or an event does to an emotion, in the plane and in the 24 emotions."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType

from cubeling.affect.occ import OCC_PLACES, check_words

PROSPECT_WORDS = (
    *("joy", "distress", "hope", "fear", "satisfaction", "fear-confirmed", "relief"),
    *("disappointment", "surprise", "disgust"),
)
"""Emotions about what happens to oneself, not about what somebody did (Ortony, Clore and Collins
1988): an impulse that is given in the plane raises the one in whose direction it goes."""


@dataclass(frozen=True)
class AffectImpulse:
    """A change of an emotion: the rate of an action [1/s], or the effect of an event."""

    valence: float = 0.0
    """Towards pleasant; negative towards unpleasant."""

    arousal: float = 0.0
    """Towards excited; negative towards calm."""

    emotions: Mapping[str, float] = field(default_factory=dict)
    """Influence on emotions of the 24, by their words: `a` of eq. 5.10, at least 0.

    Raises AffectError for another word."""

    def __post_init__(self) -> None:
        check_words(self.emotions)
        object.__setattr__(self, "emotions", MappingProxyType(dict(self.emotions)))

    @property
    def plane(self) -> tuple[float, float]:
        """Its (valence, arousal), those of its emotions among them.

        >>> AffectImpulse(valence=0.1, emotions={"joy": 0.5}).plane
        (0.30000000000000004, 0.1)
        """
        places = [(OCC_PLACES[word], value) for word, value in self.emotions.items()]
        return (
            self.valence + sum(valence * value for (valence, _), value in places),
            self.arousal + sum(arousal * value for (_, arousal), value in places),
        )

    @property
    def influences(self) -> dict[str, float]:
        """Its influence on emotions of the 24, that of its valence and arousal among them.

        >>> AffectImpulse(valence=-0.4, arousal=-0.2).influences
        {'distress': 1.0}
        """
        influences = dict(self.emotions)
        size = math.hypot(self.valence, self.arousal)
        if size > 0.0:
            turn = math.atan2(self.arousal, self.valence)
            word = max(PROSPECT_WORDS, key=lambda each: math.cos(turn - _DIRECTIONS[each]))
            influences[word] = influences.get(word, 0.0) + size / math.hypot(*OCC_PLACES[word])
        return influences


_DIRECTIONS = {word: math.atan2(*OCC_PLACES[word][::-1]) for word in PROSPECT_WORDS}
