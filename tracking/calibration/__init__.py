"""Intrinsics of a camera from the printed cube itself, or from a ChArUco board."""

from cubeling.faces import face

__getattr__, __dir__, __all__ = face(__name__)
