"""Emotion: what a character feels, how it changes, and the word for it.

The ground floor of the program: characters show an emotion and robots express it, and both take it
from here.

>>> Feelings("lively").emotion.label
'neutral'
"""

from cubeling.affect.dynamics import Feelings
from cubeling.affect.emotion import NEUTRAL, Emotion
from cubeling.affect.errors import AffectError
from cubeling.affect.labels import LABEL_SETS
from cubeling.affect.personality import Personality

__all__ = ["LABEL_SETS", "NEUTRAL", "AffectError", "Emotion", "Feelings", "Personality"]
