"""Saying a text with a voice, as mouth and subtitles need it."""

from cubeling.characters.speech.closures import with_closures
from cubeling.characters.speech.speech import Speech
from cubeling.characters.speech.voices import Manner, Voice
from cubeling.characters.speech.words import with_every_word

USUAL = Manner()
"""How a text is usually spoken."""


def say(voice: Voice, text: str, language: str = "en", manner: Manner = USUAL) -> Speech:
    """Return the speech of a text: stops begin where lips close, and no word is left out.

    Raises
    ------
    VoiceError
        See `Voice.say`.
    """
    return with_every_word(with_closures(voice.say(text, language, manner)))
