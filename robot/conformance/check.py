"""What a check is: a sentence of PROTOCOL.md that binds the robot, and how to see that it holds."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Literal

from robot.conformance.probe import Probe

Level = Literal["must", "should"]
"""Whether a robot that fails does not conform, or could only be better."""

Run = Callable[[Probe], str | None]
"""Tries a robot; returns a remark or None, and raises `UnmetError` or `NotApplicableError`."""


@dataclass(frozen=True)
class Check:
    """One requirement, and how to see whether a robot meets it."""

    name: str
    """What it is called, in words."""

    section: int
    """Section of PROTOCOL.md that requires it."""

    level: Level
    """Whether failing it is failing the suite."""

    requires: str
    """What is required, in a sentence."""

    run: Run
    """Tries a robot that answers greetings; leaves any session it likes behind."""


class Chapter:
    """The checks of one section of PROTOCOL.md, in the order in which they are written.

    A function becomes a check by the decorators `must` and `should`: its name is the check's name
    and its docstring what is required.

    Parameters
    ----------
    title
        What the section is about.
    section
        Its number; 0 for checks of several.
    """

    def __init__(self, title: str, section: int) -> None:
        self.title = title
        self.section = section
        self._checks: list[Check] = []

    def must(self, run: Run) -> Run:
        """Enter a function as a check that a conforming robot passes."""
        return self._enter(run, "must")

    def should(self, run: Run) -> Run:
        """Enter a function as a check that a good robot passes."""
        return self._enter(run, "should")

    def must_of(self, section: int) -> Callable[[Run], Run]:
        """Enter a function as `must` does, for a sentence of another section."""
        return lambda run: self._enter(run, "must", section)

    def _enter(self, run: Run, level: Level, section: int | None = None) -> Run:
        name = getattr(run, "__name__", "").replace("_", " ")
        requires = " ".join((run.__doc__ or "").split())
        self._checks.append(Check(name, section or self.section, level, requires, run))
        return run

    def __iter__(self) -> Iterator[Check]:
        return iter(self._checks)
