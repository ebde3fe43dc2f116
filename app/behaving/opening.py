"""Opening the voice that playing blocks needs."""

from collections.abc import Callable

from cubeling.app.behaving.voice import (
    LineSource,
    PatientSource,
    SayText,
    SilentSource,
    say_with,
)
from cubeling.app.speaking.voices import open_voice
from cubeling.characters.speech import VoiceError

MakeSource = Callable[[SayText, str, Callable[[], None]], LineSource]
"""Makes a source of lines: `PatientSource` or `ThreadedSource`."""


def open_lines(command: str | None, language: str, kind: MakeSource = PatientSource) -> LineSource:
    """Return what speaks; the caller closes it. Without a voice, nothing is said.

    Raises
    ------
    AppError, VoiceError
        The command of a voice that the user has chosen does not work.
    """
    try:
        voice = open_voice(command)
    except VoiceError as error:
        if command is not None:
            raise
        return SilentSource(str(error))
    return kind(say_with(voice), language, voice.close)
