"""Behaviour: gestures, reaching, dialogue, and the blocks of the Behavior Markup Language."""

from cubeling.faces import face

__getattr__, __dir__, __all__ = face(__name__)
