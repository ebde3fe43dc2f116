"""Conformance tests of robots against PROTOCOL.md: `cubeling robot conform PORT`, as a library."""

from cubeling.faces import face

__getattr__, __dir__, __all__ = face(__name__)
