"""Voices: programs that speak a text and say when each word and phone is heard."""

from cubeling.characters.speech.voices.espeak import espeak
from cubeling.characters.speech.voices.voice import Manner, UnspeakableError, Voice, VoiceError

__all__ = ["Manner", "UnspeakableError", "Voice", "VoiceError", "espeak"]
