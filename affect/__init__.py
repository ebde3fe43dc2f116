"""Emotion: what a character feels, how it changes, and the word for it.

The ground floor of the program: characters show an emotion and robots express it, and both take it
from here.

>>> Feelings("lively").emotion.label
'neutral'
"""

from affect.dynamics import Feelings
from affect.emotion import NEUTRAL, Emotion
from affect.errors import AffectError
from affect.labels import LABEL_SETS
from affect.personality import Personality

__all__ = ["LABEL_SETS", "NEUTRAL", "AffectError", "Emotion", "Feelings", "Personality"]
