"""What the board does with a line that it has read, and how long that takes."""

import re
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from robot.simulators.opencat.body import JOINTS, Body
from robot.simulators.opencat.habits import Habits
from robot.simulators.opencat.skills import REST, SKILLS

DISASTERS = frozenset("acsS!gGnwWKTXzpRxMLIfFoqtlvVzhuPrBCmU;:")
"""Tokens that calibrate, write memory, change what outlasts the line, stop the board, or move it in
ways that nobody here has thought through. Whoever sends one has lost the game."""

KEPT = 500
"""How many disasters are remembered."""


@dataclass
class Job:
    """What the board is busy with."""

    ends: float
    """When it is done [s]."""

    finish: Callable[[float], None]
    """Is called then."""

    skill: bool = False
    """Whether it is a skill, which the next byte may break off."""


class Interpreter:
    """Does what lines say.

    Parameters
    ----------
    random
        Draws what happens.
    names
        Model and version, with which "?" is answered.
    habits
        How ugly the board is.
    say
        Says a line.
    """

    def __init__(
        self,
        random: np.random.Generator,
        names: tuple[str, str],
        habits: Habits,
        say: Callable[[str], None],
    ) -> None:
        self.body = Body(crossed=names[0].startswith("Nybble"))
        """The robot."""
        self.disasters: deque[str] = deque(maxlen=KEPT)
        """Lines that calibrate, write memory or the like."""
        self.rested = True
        """Whether the last token was a rest."""
        self.low_power = False
        """Whether the battery is too low to move."""
        self._random, self._names, self._habits, self._say = random, names, habits, say

    def do(self, line: str, now: float, brown_out: Callable[[float], None]) -> Job | None:
        """Begin what a line says; return what keeps the board busy."""
        token, rest = line[0], line[1:]
        if self.rested and token != "d":
            self._say("G")
        self.rested = token == "d"
        if token in DISASTERS:
            self.disasters.append(line)
        match token:
            case "?" | "j":
                self._tell(token, rest, now)
            case "d":
                self._say("g")
                seconds = self.body.take(REST, now) if self.body.powered else 0.0
                return Job(now + seconds, self._let_go)
            case "k":
                return self._play(rest, now, brown_out)
            case "i":
                return self._busy(token, self._pose(rest, now), now)
            case "b":
                return self._busy(token, self._beep(line), now)
            case _:
                self._say("Undefined token!")
                self.echo(token)
        return None

    def echo(self, token: str) -> None:
        """Say that a token is done; seldom after text that has no end."""
        mangled = self._random.random() < self._habits.mangled
        self._say(f"AA {token}" if mangled else token)

    def _tell(self, token: str, rest: str, now: float) -> None:
        if token == "j":
            self._say("=")
            self._say("".join(f"{joint}\t" for joint in range(JOINTS)))
            self._say("".join(f"{round(angle)},\t" for angle in self.body.angles(now)))
        elif self._habits.answers_query and not rest:
            for name in self._names:
                self._say(name)
        self.echo(token)

    def _play(self, name: str, now: float, brown_out: Callable[[float], None]) -> Job | None:
        skill = SKILLS.get(name)
        self._say(name if skill else f"?{name}?")
        if skill is None or self.low_power:
            self.echo("k")
            return None
        seconds = self.body.take(skill, now)
        if skill.seconds and self._random.random() < self._habits.brown_outs:
            return Job(now + seconds / 2, brown_out)
        return self._busy("k", seconds, now, skill=skill.seconds > 0)

    def _pose(self, rest: str, now: float) -> float:
        numbers = [int(number) for number in re.findall(r"-?\d+", rest)]
        pairs = zip(numbers[::2], numbers[1::2], strict=False)
        wanted = {joint: float(angle) for joint, angle in pairs if 0 <= joint < JOINTS}
        return 0.0 if self.low_power else self.body.move(wanted, now)

    def _beep(self, line: str) -> float:
        numbers = [int(number) for number in re.findall(r"\d+", line)]
        if len(numbers) < 2:
            self.disasters.append(line)  # stored, as the volume
        return sum(1.0 / value for value in numbers[1::2] if value)

    def _let_go(self, now: float) -> None:
        self.body.let_go(now)
        self.echo("d")

    def _busy(self, token: str, seconds: float, now: float, skill: bool = False) -> Job:
        return Job(now + seconds, lambda _: self.echo(token), skill)
