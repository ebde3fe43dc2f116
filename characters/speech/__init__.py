"""Speech: voices, prosody, pitch accents, and the alignment of recordings with their text."""

from cubeling.faces import face

__getattr__, __dir__, __all__ = face(__name__)
