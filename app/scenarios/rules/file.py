"""The file of a scenario of rules; reading it loads nothing that plays."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from cubeling.app.errors import AppError
from cubeling.app.pipeline.choices import MAX_CAST, distinct_names
from cubeling.app.scenarios.rules.vocabulary import ACTIONS, CONDITIONS, MOMENTARY_CONDITIONS, Term
from cubeling.toml_file import TomlTable, read, toml_kind

RULES_FILE = toml_kind("scenario", AppError, "cubeling.app.scenarios.rules.file:read_rules")
"""A scenario that is a file of rules."""

FACE_NAMES = ("top", "bottom", "front", "back", "left", "right")
"""Names of the faces of every cube: other words after "top" are roles."""

USUAL_ACTING_S = 3.0
"""How long a rule acts unless it says so [s]."""

LONGEST_S = 600.0
"""Longest time that a rule may name [s]."""

RULE_KEYS = ("who", "when", "while", "after", "for", "say", *ACTIONS)


@dataclass(frozen=True)
class Rule:
    """Under which conditions a character does what."""

    conditions: tuple[Term, ...]
    """All of them must hold."""

    lasting: bool
    """Whether it acts as long as they hold (`while`), or once when they begin to hold (`when`)."""

    after: float
    """How long they must hold before it acts [s]."""

    seconds: float
    """How long it acts [s], if it is not `lasting`."""

    actions: tuple[tuple[str, str], ...]
    """What the character does: keys of `ACTIONS`, with what the file says there."""

    say: tuple[str, ...] = ()
    """What it says, one line at a time, in turn."""

    who: int = 0
    """The number in the cast of who does it: 0 for `character`, 1 for the first of `others`."""


@dataclass(frozen=True)
class RuleSet:
    """The content of a file of rules."""

    name: str
    """The path, as the user has typed it."""

    summary: str
    """What happens, in one line."""

    character: str
    """A bundled character, or a file."""

    others: tuple[str, ...]
    """The rest of the cast, in the same way."""

    cube: str
    """A bundled cube, or a file."""

    personality: str
    """A bundled personality, or a file."""

    language: str
    """Code of the language of what is said."""

    hint: str
    """What the player reads while no rule says anything else."""

    rules: tuple[Rule, ...]
    """The rules, the most important one first."""

    @property
    def roles(self) -> tuple[str, ...]:
        """The roles of faces that the rules read: the cube must have them."""
        terms = (term for rule in self.rules for term in rule.conditions if term.name == "top")
        return tuple(
            dict.fromkeys(each.argument for each in terms if each.argument not in FACE_NAMES)
        )

    def of(self, who: int) -> tuple[int, ...]:
        """Return the places of the rules for one of the cast."""
        return tuple(index for index, rule in enumerate(self.rules) if rule.who == who)

    def asked(self, who: int) -> dict[str, str]:
        """Return the actions that the rules ask of one of the cast, with the place of the first."""
        found: dict[str, str] = {}
        for index in self.of(who):
            for key, text in self.rules[index].actions:
                if key == "do" and text not in ("idle", "move"):
                    found.setdefault(text, f"{self.name}: rule[{index}].do")
        return found

    @property
    def lines(self) -> dict[str, tuple[str, ...]]:
        """What is said, by the event that a rule makes when it begins to act."""
        return {event_of(index): rule.say for index, rule in enumerate(self.rules) if rule.say}


def event_of(index: int) -> str:
    """Return the event of a rule that begins to act: "rule 1" for the first."""
    return f"rule {index + 1}"


def read_rules(path: str | Path) -> RuleSet:
    """Read a file of rules.

    Raises
    ------
    AppError
        It cannot be read, or in one line: which key has which wrong value.
    """
    file = TomlTable(read(Path(path), RULES_FILE), str(path), error=AppError)
    file.only("summary", "character", "others", "cube", "personality", "language", "hint", "rule")
    folder = Path(path).parent
    character, others = file.line("character", "human"), _others(file)
    cast = distinct_names(Path(each).stem for each in (character, *others))
    rules = tuple(_rule(row, cast) for row in file.rows("rule", *RULE_KEYS))
    if not rules:
        raise file.wrong("rule", "there is none; begin one with a line [[rule]]")
    return RuleSet(
        name=str(path),
        summary=file.line("summary", "a scenario of rules").removesuffix("."),
        character=_beside(folder, character),
        others=tuple(_beside(folder, each) for each in others),
        cube=_beside(folder, file.line("cube", "companion")),
        personality=_beside(folder, file.line("personality", "lively")),
        language=file.line("language", "en"),
        hint=file.line("hint", "Move the cube"),
        rules=rules,
    )


def _others(file: TomlTable) -> tuple[str, ...]:
    names = file.texts("others")
    if len(names) >= MAX_CAST:
        raise file.wrong("others", f"there are {len(names)}, and at most {MAX_CAST - 1} fit")
    return names


def _beside(folder: Path, name: str) -> str:
    """Return a bundled name, or where a file is that stands beside the file of rules."""
    return str(folder / name) if Path(name).suffix else name


def _rule(row: TomlTable, cast: Sequence[str]) -> Rule:
    if ("when" in row) == ("while" in row):
        raise row.wrong("when", f"a rule has either when or while; conditions: {_known()}")
    key = "when" if "when" in row else "while"
    if key == "while" and "for" in row:
        raise row.wrong("for", "a rule with while acts as long as its conditions hold")
    try:
        terms = tuple(Term.parse(text, cast) for text in _texts(row, key))
    except AppError as error:
        raise row.wrong(key, str(error)) from None
    after = row.number("after", 0.0, LONGEST_S, 0.0)
    for term in terms:
        if after > 0.0 and term.name in MOMENTARY_CONDITIONS and not term.negated:
            raise row.wrong("after", f"'{term.name}' holds for a moment only; leave after out")
    actions = tuple(
        (name, row.choice(name, action.choices) if action.choices else row.line(name))
        for name, action in ACTIONS.items()
        if name in row
    )
    say = _texts(row, "say") if "say" in row else ()
    if not actions and not say:
        raise row.wrong("do", f"the rule does nothing; give it one of say, {', '.join(ACTIONS)}")
    return Rule(
        terms,
        key == "while",
        after,
        row.number("for", 0.0, LONGEST_S, USUAL_ACTING_S),
        actions,
        say,
        cast.index(row.choice("who", cast)) if "who" in row else 0,
    )


def _texts(row: TomlTable, key: str) -> tuple[str, ...]:
    """Return one text or a list of them."""
    texts = (row.line(key),) if isinstance(row.value(key), str) else row.texts(key)
    if not texts:
        raise row.unlike(key, "a text, or a list of texts")
    return texts


def _known() -> str:
    return ", ".join(CONDITIONS)
