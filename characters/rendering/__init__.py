"""Draws characters into the camera's picture: `Stage` and what it is given."""

from cubeling.faces import face

__getattr__, __dir__, __all__ = face(__name__)
