"""A script: state machines that answer what is said, as frozen values."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Generic, TypeVar

from cubeling.characters.dialogue.patterns import WordPattern
from cubeling.characters.dialogue.spelling import Spelling

Item = TypeVar("Item")

ANY_LANGUAGE = ""
"""The language of what is written without one."""


@dataclass(frozen=True)
class Localized(Generic[Item]):
    """Something in several languages."""

    by_language: Mapping[str, tuple[Item, ...]]
    """The items by the code of their language, or `ANY_LANGUAGE`."""

    def of(self, language: str) -> tuple[Item, ...]:
        """Return the items of a language, and those of any."""
        own, common = self.by_language.get(language, ()), self.by_language.get(ANY_LANGUAGE, ())
        return (*own, *common)

    def __iter__(self) -> Iterator[tuple[str, Item]]:
        return ((code, item) for code, items in self.by_language.items() for item in items)


@dataclass(frozen=True)
class ScriptItem:
    """A condition or an action of a transition."""

    kind: str
    """Its type, as the script names it."""

    argument: Any
    """What its kind has read of it, which is frozen."""

    line: int
    """Line of the script."""


@dataclass(frozen=True)
class UnitTransition:
    """A step of a unit from one state to another."""

    target: str
    """Name of the state that it leads to."""

    conditions: tuple[ScriptItem, ...]
    """All of them must hold."""

    actions: tuple[ScriptItem, ...]
    """What is done in it, in this order."""

    hears: bool
    """Whether a condition is about what was said, which the transition then answers."""

    waits: bool
    """Whether something must happen before it can be made once more."""

    line: int
    """Line of the script."""

    @cached_property
    def is_open(self) -> bool:
        """Whether it answers whatever is said."""
        return any(
            isinstance(pattern, WordPattern) and pattern.is_open
            for condition in self.conditions
            if isinstance(condition.argument, Localized)
            for _, pattern in condition.argument
        )


@dataclass(frozen=True)
class UnitState:
    """A state of a unit."""

    name: str
    """Its name in the unit."""

    transitions: tuple[UnitTransition, ...]
    """What can happen in it."""

    accepting: bool
    """Whether the unit is done when it is reached."""

    line: int
    """Line of the script."""

    @cached_property
    def only_hears(self) -> bool:
        """Whether nothing happens in it as long as nothing is said."""
        return all(each.hears for each in self.transitions)


@dataclass(frozen=True)
class Unit:
    """A part of a dialogue: a nondeterministic state machine (Egges 2006, section 5.1)."""

    name: str
    """Its name in the script."""

    states: Mapping[str, UnitState]
    """Its states by name; the first one is the start."""

    priority: int
    """Of units that can make a transition, one of the greatest priority does."""

    cyclic: bool
    """Whether it is at its start again when it is done."""

    strong: bool
    """Whether it comes before all others once it was chosen, as long as it can go on."""

    fallback: bool
    """Whether its answers fit much that is said, so that a language model may know a better one."""

    line: int
    """Line of the script."""

    @cached_property
    def start(self) -> str:
        """Name of the state in which it begins."""
        return next(iter(self.states))

    def after(self, target: str) -> str:
        """Return the state in which a unit is that has reached one."""
        return self.start if self.cyclic and self.states[target].accepting else target


@dataclass(frozen=True)
class DialogueScript:
    """A dialogue as a file tells it: its units, and whom it is for."""

    name: str
    """The file, for messages."""

    summary: str
    """What it is, in one line."""

    character: str
    """The character that it is for: a bundled name or a file."""

    personality: str
    """Its personality, in the same way."""

    languages: tuple[str, ...]
    """Codes of its languages; it begins in the first."""

    units: tuple[Unit, ...]
    """The state machines, all of which run in parallel."""

    spelling: Spelling
    """The words that it knows."""

    slots: Mapping[str, ScriptItem]
    """The words that can be heard for a slot, by its name; typed, it may be any word."""

    def place(self, line: int) -> str:
        """Return how messages name a line of it."""
        return f"{self.name}:{line}"

    @property
    def transitions(self) -> Iterator[UnitTransition]:
        """All transitions of all units."""
        return (
            transition
            for unit in self.units
            for state in unit.states.values()
            for transition in state.transitions
        )

    def actions(self, kind: str) -> Iterator[ScriptItem]:
        """Yield all actions of a kind."""
        return (
            action for each in self.transitions for action in each.actions if action.kind == kind
        )
