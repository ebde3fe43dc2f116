"""Voices: programs that speak a text and say when each word and phone is heard."""

from cubeling.characters.speech.voices.espeak import espeak
from cubeling.characters.speech.voices.voice import Manner, Voice, VoiceError

__all__ = ["Manner", "Voice", "VoiceError", "espeak"]
