"""Opening what the character of a session speaks with."""

from collections.abc import Callable
from functools import lru_cache, partial
from pathlib import Path

from app.session import SessionOptions, spoken_lines
from app.speaking.lines import ScenarioLines, bundled_lines, read_lines
from app.speaking.speaker import LiveSpeaker, RecordedSpeaker, Speaker
from characters.speech.voices import VoiceError, espeak

DEFAULT_LANGUAGE = "en"
"""Language of what is said unless the user chooses one."""

SILENT = "none"
"""The language in which nothing is said."""

LinesOf = Callable[[str], ScenarioLines | None]
"""Returns the lines of a scenario by its name; None if it has none."""


def open_speaker(options: SessionOptions, *, waits: bool) -> Speaker:
    """Return what speaks in a session; the caller closes it.

    A recording says what it has. Else a voice speaks if the user has chosen a language or lines, or
    sits in front of a window; without a voice, a character whose language nobody chose is silent.

    Parameters
    ----------
    options
        What the user asks for.
    waits
        Whether the session is not in real time.

    Raises
    ------
    AppError, CharacterError
        There are no such lines, or the user has chosen a language and no voice is installed.
    """
    asked = options.language is not None or options.lines is not None
    if options.source.endswith(".mcap") and not asked:
        return RecordedSpeaker(spoken_lines(Path(options.source)))
    if options.language == SILENT or not (asked or options.windowed):
        return RecordedSpeaker({})
    lines_of = _lines_of(options)
    if options.language is not None:
        lines_of(options.scenario)  # refuses a language that it lacks
    try:
        voice = espeak()
    except VoiceError:
        if asked:
            raise
        return RecordedSpeaker({})
    return LiveSpeaker(voice, lines_of, options.profile, waits=waits)


def _lines_of(options: SessionOptions) -> LinesOf:
    """Return what finds the lines of a scenario."""
    language = options.language or DEFAULT_LANGUAGE
    if options.lines is not None:
        own = read_lines(options.lines, language)
        return lambda scenario: own
    return lru_cache(partial(bundled_lines, language=language))
