"""Executes the lines that the board has read."""

import re
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from cubeling.robot.drivers.opencat.tokens import JOINTS
from cubeling.robot.simulators.opencat.body import REST_SKILL, SKILLS, OpenCatBody
from cubeling.robot.simulators.opencat.quirks import BoardQuirks

FORBIDDEN_TOKENS = frozenset("acsS!gGnwWKTXzpRxMLIfFoqtlvVzhuPrBCmU;:")
"""Tokens that a driver must not send: they calibrate, write memory, change lasting settings, stop
the board, or move it in untested ways."""

MAX_KEPT = 500
"""Number of forbidden lines that are kept."""


@dataclass
class Job:
    """What keeps the board busy."""

    ends: float
    """Its end [s]."""

    finish: Callable[[float], None]
    """Called at the end."""

    skill: bool = False
    """Whether it is a skill, which the next byte may interrupt."""


class Interpreter:
    """Executes lines; `names` are model and version, the answer to "?"."""

    def __init__(
        self,
        random: np.random.Generator,
        names: tuple[str, str],
        quirks: BoardQuirks,
        send_line: Callable[[str], None],
    ) -> None:
        self.body = OpenCatBody(crossed=names[0].startswith("Nybble"))
        """The body of the robot."""
        self.forbidden: deque[str] = deque(maxlen=MAX_KEPT)
        """The forbidden lines that were received."""
        self.rested = True
        """Whether the last token was a rest."""
        self.low_power = False
        """Whether the battery is too low to move."""
        self._random, self._names, self._quirks, self._send_line = random, names, quirks, send_line

    def execute(self, line: str, now: float, brown_out: Callable[[float], None]) -> Job | None:
        """Start executing a line; return what keeps the board busy."""
        token, rest = line[0], line[1:]
        if self.rested and token != "d":
            self._send_line("G")
        self.rested = token == "d"
        if token in FORBIDDEN_TOKENS:
            self.forbidden.append(line)
        match token:
            case "?" | "j":
                self._answer(token, rest, now)
            case "d":
                self._send_line("g")
                seconds = self.body.perform(REST_SKILL, now) if self.body.powered else 0.0
                return Job(now + seconds, self._power_off)
            case "k":
                return self._play(rest, now, brown_out)
            case "i":
                return self._busy(token, self._pose(rest, now), now)
            case "b":
                return self._busy(token, self._beep(line), now)
            case _:
                self._send_line("Undefined token!")
                self.echo(token)
        return None

    def echo(self, token: str) -> None:
        """Echo a token that is done; sometimes after text without a line end."""
        mangled = self._random.random() < self._quirks.mangled
        self._send_line(f"AA {token}" if mangled else token)

    def _answer(self, token: str, rest: str, now: float) -> None:
        if token == "j":
            self._send_line("=")
            self._send_line("".join(f"{joint}\t" for joint in range(JOINTS)))
            self._send_line("".join(f"{round(angle)},\t" for angle in self.body.angles(now)))
        elif self._quirks.answers_query and not rest:
            for name in self._names:
                self._send_line(name)
        self.echo(token)

    def _play(self, name: str, now: float, brown_out: Callable[[float], None]) -> Job | None:
        skill = SKILLS.get(name)
        self._send_line(name if skill else f"?{name}?")
        if skill is None or self.low_power:
            self.echo("k")
            return None
        seconds = self.body.perform(skill, now)
        if skill.seconds and self._random.random() < self._quirks.brown_outs:
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
            self.forbidden.append(line)  # stored as the volume
        return sum(1.0 / value for value in numbers[1::2] if value)

    def _power_off(self, now: float) -> None:
        self.body.power_off(now)
        self.echo("d")

    def _busy(self, token: str, seconds: float, now: float, skill: bool = False) -> Job:
        return Job(now + seconds, lambda _: self.echo(token), skill)
