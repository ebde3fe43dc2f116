"""Opening what playing blocks needs: documents and a voice."""

from collections.abc import Callable
from pathlib import Path

from cubeling.app.behaving.player import block_of
from cubeling.app.behaving.voice import (
    LineSource,
    PatientSource,
    SayText,
    SilentSource,
    say_with,
)
from cubeling.app.speaking.voices import open_voice
from cubeling.characters import CharacterError
from cubeling.characters.model import read_text
from cubeling.characters.speech import VoiceError

MAX_BYTES = 1 << 20
"""Size of a document that is read."""


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


def read_document(path: Path) -> str:
    """Return the BML or FML of a file that can be read.

    Raises
    ------
    CharacterError
        It is none; the message names the file.
    """
    text = read_text(path, MAX_BYTES)
    try:
        block_of(text)
    except CharacterError as error:
        raise CharacterError(f"{path}: {error}") from None
    return text
