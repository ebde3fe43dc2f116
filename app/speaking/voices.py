"""The voice that the user chooses: eSpeak NG, or a program that speaks the same protocol."""

import shlex

from cubeling.app.errors import AppError
from cubeling.characters.speech import Voice, espeak


def open_voice(command: str | None) -> Voice:
    """Return a voice, which the caller closes; None for eSpeak NG.

    Raises
    ------
    AppError, VoiceError
        The command is empty or has an open quote, or eSpeak NG is not installed.
    """
    if command is None:
        return espeak()
    try:
        parts = shlex.split(command)
    except ValueError as error:
        raise AppError(f"--voice {command}: {error}") from error
    if not parts:
        raise AppError("--voice is empty: give a command, see docs/speaking.md")
    return Voice(parts)
