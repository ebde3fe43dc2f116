"""Opening what the characters of a session speak with."""

from collections.abc import Mapping, Sequence
from functools import lru_cache, partial

from cubeling.app.pipeline.registry import RULES_SUFFIX
from cubeling.app.pipeline.table.spoken_line import Lines
from cubeling.app.session import SessionOptions
from cubeling.app.speaking.lines import (
    DEFAULT_LANGUAGE,
    SILENT,
    bundled_languages,
    bundled_lines,
    languages_in,
    read_lines_for,
)
from cubeling.app.speaking.recorded import RecordedSpeaker, Speaker
from cubeling.characters import Character


def open_speaker(
    options: SessionOptions,
    cast: Sequence[Character],
    recorded: Mapping[float, Lines] | None = None,
    *,
    waits: bool,
    replies: bool = False,
    prompted: bool = False,
) -> Speaker:
    """Return what speaks in a session; the caller closes it.

    A recording says what it has. Else a voice speaks if the user has chosen a language or lines,
    sits in front of a window, or plays a file of rules that says something; without a voice, a
    character whose language nobody chose is silent.

    Parameters
    ----------
    options
        What the user asks for.
    cast
        Who speaks.
    recorded
        What they say in the session that is replayed, by the frame in which it begins [s]; None for
        another source.
    waits
        Whether the session is not in real time.
    replies
        Whether a scenario answers: replies are said in any case, if need be without a sound.
    prompted
        Whether somebody beside the player may ask for something to be said, which is a reply too.

    Raises
    ------
    AppError, CharacterError
        There are no such lines, or the user has chosen a language and no voice is installed.
    """
    asked = options.language is not None or options.lines is not None
    if recorded is not None and not asked and (recorded or not prompted):
        return RecordedSpeaker(recorded)
    unasked = recorded is None and (options.windowed or has_own_lines(options.scenario))
    chatty = options.language != SILENT and (asked or unasked)
    if not (replies or prompted or chatty):
        return RecordedSpeaker({})
    from cubeling.app.speaking.speaker import LinesOf, LiveSpeaker
    from cubeling.app.speaking.voices import open_voice
    from cubeling.characters.speech import VoiceError

    first = options.language or DEFAULT_LANGUAGE
    lines_of: LinesOf
    languages: tuple[str, ...]
    if not (replies or chatty):  # nothing but what is prompted
        lines_of, languages = _no_lines, ()
    elif options.lines is None:
        lines_of, languages = lru_cache(bundled_lines), bundled_languages(options.scenario)
        if options.language is None and languages and first not in languages:
            first = languages[0]  # a file of rules has one language
    else:
        path = options.lines
        lines_of, languages = lru_cache(partial(read_lines_for, path)), languages_in(path)
    if first != SILENT:
        lines_of(options.scenario, first)  # refuses a language that it lacks
    voice, problem = None, ""
    try:
        voice = None if first == SILENT else open_voice(options.voice)
    except VoiceError as error:
        if asked and not (replies or prompted):
            raise
        problem = str(error)
    if voice is None and not (replies or prompted):
        return RecordedSpeaker({}, problem)
    gestures = {id(each.gestures): each.gestures for each in cast if each.gestures is not None}
    choices = tuple(dict.fromkeys((first, *languages, SILENT)))
    speaker = LiveSpeaker(
        voice, lines_of, choices, options.profile, gestures=[*gestures.values()], waits=waits
    )
    speaker.problem = problem
    return speaker


def has_own_lines(scenario: str) -> bool:
    """Return whether a scenario is a file of rules that says something, in a film too."""
    return scenario.endswith(RULES_SUFFIX) and bool(bundled_languages(scenario))


def _no_lines(scenario: str, language: str) -> None:
    """Return the lines of a scenario that is silent."""
