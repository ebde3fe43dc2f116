"""Camera frames in; where the cube is, and what the hand does with it, out."""

from cubeling.faces import face

__getattr__, __dir__, __all__ = face(__name__)
