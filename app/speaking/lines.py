"""The lines of a scenario: what the character says when something happens, in several languages."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from cubeling.app.errors import AppError
from cubeling.app.pipeline.registry import RULES_SUFFIX
from cubeling.toml_file import MAX_LONG_FILE_BYTES, TomlTable, read, toml_kind

LINES_FILE = toml_kind(
    "lines", AppError, "cubeling.app.speaking.lines:languages_in", MAX_LONG_FILE_BYTES
)
"""A file of what a character says in play, by language and moment."""

WATCHING = "waiting"
"""The scenario of characters that no cube leads."""

DEFAULT_LANGUAGE = "en"
"""Language of what is said unless the user chooses one."""

SILENT = "none"
"""The language in which nothing is said."""

MAX_LINES = 1000
"""Most lines for one moment."""

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

    Those of a file of rules are what its rules say. Raises AppError if it has lines, but not in
    this language.
    """
    if scenario.endswith(RULES_SUFFIX):
        return _rule_lines(scenario, language)
    file = _bundled_file(scenario)
    if scenario == WATCHING and language not in languages_in(file):
        return None  # nobody chose it: the others are silent in a language of the player's lines
    return read_lines(file, language) if file.is_file() else None


def bundled_languages(scenario: str) -> tuple[str, ...]:
    """Return the languages of the lines of a bundled scenario; () if it has none."""
    if scenario.endswith(RULES_SUFFIX):
        from cubeling.app.scenarios.rules.file import read_rules

        rules = read_rules(scenario)
        return (rules.language,) if rules.lines else ()
    file = _bundled_file(scenario)
    return languages_in(file) if file.is_file() else ()


def read_lines_for(path: Path, scenario: str, language: str) -> ScenarioLines | None:
    """Read the lines of a player's .toml file for a scenario; None if nothing is said in it.

    What those say that no cube leads is in the tables `[others.LANGUAGE]`; without such tables it
    is what is bundled. In a language without one, they are silent.
    """
    if scenario != WATCHING:
        return read_lines(path, language)
    content = _content(path)
    if "others" not in content:
        return bundled_lines(scenario, language)
    return read_lines(path, language, "others") if language in content.table("others") else None


def read_lines(path: Path, language: str, speakers: str = "voice") -> ScenarioLines:
    """Read the lines of a .toml file, of one of its tables.

    Raises AppError if it cannot be read, has no lines in this language, or a line is no text or too
    long.
    """
    voice = _content(path).table(speakers)
    if language not in voice:
        found = ", ".join(voice) or "none"
        raise voice.wrong(language, f"there are no lines in '{language}'; has {found}")
    said = voice.table(language)
    return ScenarioLines(language, {moment: _lines_of(said, moment) for moment in said})


def languages_in(path: Path) -> tuple[str, ...]:
    """Return the languages of the lines in a .toml file; errors as those of `read_lines`."""
    return tuple(_content(path).table("voice"))


def _rule_lines(path: str, language: str) -> ScenarioLines | None:
    from cubeling.app.scenarios.rules.file import read_rules  # few scenarios are a file of rules

    rules = read_rules(path)
    if not rules.lines:
        return None
    if language != rules.language:
        raise AppError(f"{path}: there are no lines in '{language}'; has {rules.language}")
    for event, lines in rules.lines.items():
        if any(len(line) > LONGEST_LINE for line in lines):
            raise AppError(f"{path}: {event}.say: a line has at most {LONGEST_LINE} characters")
    return ScenarioLines(language, rules.lines)


def _bundled_file(scenario: str) -> Path:
    return Path(__file__).parents[1] / "scenarios" / "lines" / f"{scenario}.toml"


def _content(path: Path) -> TomlTable:
    """Return the tables of a file, each by language."""
    return TomlTable(read(path, LINES_FILE), str(path), error=AppError, most=MAX_LINES)


def _lines_of(table: TomlTable, moment: str) -> tuple[str, ...]:
    one = table.value(moment)
    lines = (one,) if isinstance(one, str) else table.texts(moment)
    for line in lines:
        if not line.strip() or len(line) > LONGEST_LINE:
            raise table.wrong(moment, f"a line has 1 to {LONGEST_LINE} characters, not {len(line)}")
    return lines
