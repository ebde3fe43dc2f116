"""Alignment of recordings with their text: when each word and phone is said."""

from cubeling.characters.speech.alignment.by_voice import align
from cubeling.characters.speech.alignment.sphinx import align_with_sphinx

__all__ = ["align", "align_with_sphinx"]
