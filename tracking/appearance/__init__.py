"""What the tracked cube tells of the picture: the light, the hand, the camera's blur and noise."""

from cubeling.faces import face

__getattr__, __dir__, __all__ = face(__name__)
