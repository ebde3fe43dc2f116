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
from cubeling.characters.speech import VoiceError
from cubeling.files import FileKind

BEHAVIOUR_FILE = FileKind(
    "document",
    (".bml", ".fml", ".xml"),
    CharacterError,
    1 << 20,
    "cubeling.app.behaving.opening:read_document",
)
"""A file of BML or FML."""


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


def read_document(path: Path, *, strict: bool = False) -> bytes:
    """Return the BML or FML of a file that can be read; drafts and dialects unless `strict`.

    Raises
    ------
    CharacterError
        It is none; the message names the file.
    """
    document = BEHAVIOUR_FILE.read(path)
    try:
        block_of(document, strict=strict)
    except CharacterError as error:
        raise CharacterError(f"{path}: {error}") from None
    return document
