"""The commands of the simulated console: their effects, durations and answers."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from cubeling.robot.drivers.pleo.joints import JOINTS
from cubeling.robot.simulators.pleo.body import PleoBody

Answer = tuple[list[str], float]
"""The lines of an answer, and its duration [s]."""

HELP = """\
Commands:
  app unload                 end the running application
  joint neutral              all joints to zero
  joint angle <id> <deg> [<wait ms>] [<reach ms>]
  joint move <id> <deg>
  motion play <name>         a: is the card
  motion speed <percent>
  sound play <name>
  sound speed <percent>
  sound volume <percent>
  stats power
> is the prompt, and so it stands here at the start of a line as well
  help"""
"""A long answer that contains the characters of the prompt."""

SIMPLE_RANGE_S = (0.005, 0.060)
"""Shortest and longest duration of a simple command [s]."""

LOAD_RANGE_S = (0.15, 0.60)
"""Shortest and longest time to load a motion from the card [s]."""

UNLOAD_RANGE_S = (0.3, 1.2)
"""Shortest and longest time to end the application [s]."""


@dataclass
class Monitor:
    """The commands of the console. The error texts are our own: no source has Pleo's."""

    body: PleoBody
    """The body that the commands control."""

    random: np.random.Generator
    """Source of the durations."""

    application: bool = True
    """Whether Pleo's own behaviour is running."""

    def execute(self, line: str) -> Answer:
        """Execute a line; return the lines that it prints and how long that takes [s]."""
        words = line.split()
        if not words:
            return [], self._duration(*SIMPLE_RANGE_S)
        name = " ".join(words[:2]).casefold()
        if name == "help":
            return HELP.splitlines(), self._duration(0.1, 0.4)
        commands: dict[str, Callable[[list[str]], Answer]] = {
            "app unload": self._app_unload,
            "joint neutral": self._joint_neutral,
            "joint angle": self._joint_angle,
            "joint move": self._joint_move,
            "motion play": self._motion_play,
            "motion speed": self._motion_speed,
            "sound play": self._sound_play,
            "sound speed": self._percent,
            "sound volume": self._percent,
            "stats power": self._stats_power,
        }
        command = commands.get(name)
        if command is None:
            return [f"Unknown command: {line.strip()!r}, try help"], self._duration(*SIMPLE_RANGE_S)
        try:
            return command(words[2:])
        except (ValueError, IndexError, OverflowError):
            return ["Error: invalid parameter"], self._duration(*SIMPLE_RANGE_S)

    def _duration(self, low: float, high: float) -> float:
        return float(self.random.uniform(low, high))

    def _app_unload(self, words: list[str]) -> Answer:
        was, self.application = self.application, False
        if not was:
            return ["No application loaded"], self._duration(*SIMPLE_RANGE_S)
        self.body.neutral()
        return ["Unloading application ...", "done"], self._duration(*UNLOAD_RANGE_S)

    def _joint_neutral(self, words: list[str]) -> Answer:
        self.body.neutral()
        return [], self._duration(*LOAD_RANGE_S)

    def _joint_move(self, words: list[str]) -> Answer:
        self.body.move(*self._goal(words))
        return [], self._duration(*SIMPLE_RANGE_S)

    def _joint_angle(self, words: list[str]) -> Answer:
        there = self.body.move(*self._goal(words))
        return ["reached"], there - self.body.now + self._duration(*SIMPLE_RANGE_S)

    def _goal(self, words: list[str]) -> tuple[int, int]:
        number, degrees = int(words[0]), int(words[1])
        if number < 0 or not JOINTS[number].low <= degrees <= JOINTS[number].high:
            raise ValueError
        return number, degrees

    def _motion_play(self, words: list[str]) -> Answer:
        if not words[0].casefold().endswith(".umf"):
            return [f"Error: file not found: {words[0]}"], self._duration(*LOAD_RANGE_S)
        if self.application:
            return ["Error: the application holds the motion system"], self._duration(
                *SIMPLE_RANGE_S
            )
        self.body.play_motion(words[0])
        return [f"playing {words[0]}"], self._duration(*LOAD_RANGE_S)

    def _motion_speed(self, words: list[str]) -> Answer:
        said = self._percent(words)
        self.body.motion_speed = int(words[0])
        return said

    def _sound_play(self, words: list[str]) -> Answer:
        if not words[0].casefold().endswith(".usf"):
            return [f"Error: file not found: {words[0]}"], self._duration(*LOAD_RANGE_S)
        self.body.play_sound(words[0])
        return [], self._duration(*LOAD_RANGE_S)

    def _percent(self, words: list[str]) -> Answer:
        if not 0 <= int(words[0]) <= 200:
            raise ValueError
        return [], self._duration(*SIMPLE_RANGE_S)

    def _stats_power(self, words: list[str]) -> Answer:
        percent = round(100 * self.body.battery)
        lines = [
            "Power statistics",
            "> 20 % it may walk",
            f"Battery sensor value = {percent} ({percent * 41 // 4:d} raw)",
            f"Battery temperature = {int(self.random.integers(20, 45))} (C)",
        ]
        return lines, self._duration(0.03, 0.15)
