"""The lines of a scenario: what the character says when something happens, in several languages."""

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from importlib import resources
from pathlib import Path
from typing import Any

from cubeling.app.errors import AppError
from cubeling.characters.model import read_text

MAX_BYTES = 1_000_000
"""Larger files are not written by hand."""

LONGEST_LINE = 300
"""Characters of a line that is said in play: about twenty seconds."""


@dataclass(frozen=True)
class ScenarioLines:
    """What is said in one language."""

    language: str
    """Code of the language, such as "en"."""

    lines: Mapping[str, tuple[str, ...]]
    """For each action, gait or event, what may be said, in turn; tags name gestures."""


def bundled_lines(scenario: str, language: str) -> ScenarioLines | None:
    """Return the lines of a bundled scenario; None if it has none.

    Raises AppError if it has lines, but not in this language.
    """
    voice = _bundled(scenario)
    return _lines(voice, language, f"the lines of {scenario}") if voice else None


def bundled_languages(scenario: str) -> tuple[str, ...]:
    """Return the languages of the lines of a bundled scenario; () if it has none."""
    return tuple(_bundled(scenario))


def read_lines(path: Path, language: str) -> ScenarioLines:
    """Read the lines of a .toml file.

    Raises AppError or CharacterError if it cannot be read, has no lines in this language, or a line
    is no text or too long.
    """
    return _lines(_read(path), language, str(path))


def languages_in(path: Path) -> tuple[str, ...]:
    """Return the languages of the lines in a .toml file; errors as those of `read_lines`."""
    return tuple(_read(path))


def _bundled(scenario: str) -> dict[str, Any]:
    file = resources.files("cubeling.app") / "scenarios" / "lines" / f"{scenario}.toml"
    return _voice(file.read_text("utf-8"), scenario) if file.is_file() else {}


def _read(path: Path) -> dict[str, Any]:
    return _voice(read_text(path, MAX_BYTES), str(path))


def _voice(text: str, where: str) -> dict[str, Any]:
    """Return the table `[voice]` of a file, by language; `where` names it in messages."""
    try:
        voice = tomllib.loads(text).get("voice", {})
    except tomllib.TOMLDecodeError as error:
        raise AppError(f"{where}: {error}") from error
    return voice if isinstance(voice, dict) else {}


def _lines(voice: dict[str, Any], language: str, where: str) -> ScenarioLines:
    if not isinstance(voice.get(language), dict):
        found = ", ".join(voice) or "none"
        raise AppError(
            f"{where}: no lines in '{language}', a table [voice.{language}]; has {found}"
        )
    lines = {moment: _said(said, f"{where}: {moment}") for moment, said in voice[language].items()}
    return ScenarioLines(language, lines)


def _said(said: object, where: str) -> tuple[str, ...]:
    lines = [said] if isinstance(said, str) else said
    if not isinstance(lines, list) or not all(isinstance(line, str) for line in lines):
        raise AppError(f"{where} is a line or a list of lines, each a text")
    for line in lines:
        if not line.strip() or len(line) > LONGEST_LINE:
            raise AppError(f"{where}: a line has 1 to {LONGEST_LINE} characters, not {len(line)}")
    return tuple(lines)
