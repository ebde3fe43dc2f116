"""A check: one requirement of PROTOCOL.md, and the function that tests a robot for it."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Literal

from cubeling.robot.conformance.probe import Probe

Level = Literal["must", "should"]
"""must: a robot that fails does not conform. should: it conforms, but could be better."""

CheckFunction = Callable[[Probe], str | None]
"""Tests a robot; returns a remark or None, and raises `CheckFailed` or `NotApplicableError`."""


@dataclass(frozen=True)
class Check:
    """One requirement, and its test."""

    name: str
    """Name of the check's function, with spaces, as the report prints it."""

    section: int
    """Section of PROTOCOL.md with the requirement."""

    level: Level
    """Whether a failure means that the robot does not conform."""

    requires: str
    """The requirement, in a sentence."""

    run: CheckFunction
    """Tests a robot that answers HELLO; may leave a session open."""


class CheckGroup:
    """The checks of one subject and section of PROTOCOL.md, in the order of their definition.

    The decorators `must` and `should` turn a function into a check: its name is the check's name,
    its docstring the requirement. The section is 0 if the checks belong to several.
    """

    def __init__(self, title: str, section: int) -> None:
        self.title = title
        self.section = section
        self._checks: list[Check] = []

    def must(self, run: CheckFunction) -> CheckFunction:
        """Add a function as a check that a conforming robot passes."""
        return self._add(run, "must")

    def should(self, run: CheckFunction) -> CheckFunction:
        """Add a function as a check that a good robot passes."""
        return self._add(run, "should")

    def must_of(self, section: int) -> Callable[[CheckFunction], CheckFunction]:
        """Add a function as `must` does, for a requirement of another section."""
        return lambda run: self._add(run, "must", section)

    def should_of(self, section: int) -> Callable[[CheckFunction], CheckFunction]:
        """Add a function as `should` does, for a requirement of another section."""
        return lambda run: self._add(run, "should", section)

    def _add(self, run: CheckFunction, level: Level, section: int | None = None) -> CheckFunction:
        name = getattr(run, "__name__", "").replace("_", " ")
        requires = " ".join((run.__doc__ or "").split())
        self._checks.append(Check(name, section or self.section, level, requires, run))
        return run

    def __iter__(self) -> Iterator[Check]:
        return iter(self._checks)
