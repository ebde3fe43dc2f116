"""The program: cube, character and robot in one line."""

from cubeling.faces import face

__getattr__, __dir__, __all__ = face(__name__)
