"""Running a session: what it is made of, and its loop over the frames."""

from cubeling.faces import face

__getattr__, __dir__, __all__ = face(__name__)
