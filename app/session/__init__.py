"""A session on disk: one .mcap file with the camera's frames and every message after them."""

from cubeling.faces import face

__getattr__, __dir__, __all__ = face(__name__)
