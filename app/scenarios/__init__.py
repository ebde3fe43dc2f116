"""The bundled scenarios, one file each, and what a scenario of one's own is made of."""

from cubeling.faces import face

__getattr__, __dir__, __all__ = face(__name__)
