"""Motions: clips, what modifies them, and what combines several of them."""

from cubeling.faces import face

__getattr__, __dir__, __all__ = face(__name__)
