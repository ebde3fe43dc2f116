"""The protocols by name: one package each, registered here for `connect`."""

from cubeling.faces import face

__getattr__, __dir__, __all__ = face(__name__)
