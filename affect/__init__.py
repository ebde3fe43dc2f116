"""Emotion: what a character feels, how it changes, and the word for it.

The ground floor of the program: characters show an emotion and robots express it, and both take it
from here.

>>> from cubeling.affect import Feelings
>>> Feelings("lively").emotion.label
'neutral'
"""

from cubeling.faces import face

__getattr__, __dir__, __all__ = face(__name__)
