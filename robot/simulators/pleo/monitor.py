"""What the simulated console does with a command, how long that takes, and what it says."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from robot.drivers.pleo.joints import JOINTS
from robot.simulators.pleo.body import PleoBody

Say = tuple[list[str], float]
"""The lines of an answer, and how long it takes [s]."""

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
"""A long answer, with the prompt's characters in it."""

SHORT = (0.005, 0.060)
"""How long a simple command takes [s]."""

LOADING = (0.15, 0.60)
"""How long it takes to find and load a motion on the card [s]."""

UNLOADING = (0.3, 1.2)
"""How long it takes to end the application [s]."""


@dataclass
class Monitor:
    """The commands of the console.

    The texts of its errors are our own: no source tells Pleo's.
    """

    body: PleoBody
    """What the commands move."""

    random: np.random.Generator
    """How long things take."""

    application: bool = True
    """Whether Pleo's own behaviour runs."""

    def obey(self, line: str) -> Say:
        """Carry out one line."""
        words = line.split()
        if not words:
            return [], self._takes(*SHORT)
        name = " ".join(words[:2]).casefold()
        if name == "help":
            return HELP.splitlines(), self._takes(0.1, 0.4)
        commands: dict[str, Callable[[list[str]], Say]] = {
            "app unload": self._app_unload,
            "joint neutral": self._joint_neutral,
            "joint angle": self._joint_angle,
            "joint move": self._joint_move,
            "motion play": self._motion_play,
            "motion speed": self._motion_speed,
            "sound play": self._sound_play,
            "sound speed": self._percent,
            "sound volume": self._sound_volume,
            "stats power": self._stats_power,
        }
        command = commands.get(name)
        if command is None:
            return [f"Unknown command: {line.strip()!r}, try help"], self._takes(*SHORT)
        try:
            return command(words[2:])
        except (ValueError, IndexError, OverflowError):
            return ["Error: invalid parameter"], self._takes(*SHORT)

    def _takes(self, low: float, high: float) -> float:
        return float(self.random.uniform(low, high))

    def _app_unload(self, words: list[str]) -> Say:
        was, self.application = self.application, False
        if not was:
            return ["No application loaded"], self._takes(*SHORT)
        self.body.neutral()
        return ["Unloading application ...", "done"], self._takes(*UNLOADING)

    def _joint_neutral(self, words: list[str]) -> Say:
        self.body.neutral()
        return [], self._takes(*LOADING)

    def _joint_move(self, words: list[str]) -> Say:
        self.body.move(*self._goal(words))
        return [], self._takes(*SHORT)

    def _joint_angle(self, words: list[str]) -> Say:
        there = self.body.move(*self._goal(words))
        return ["reached"], there - self.body.now + self._takes(*SHORT)

    def _goal(self, words: list[str]) -> tuple[int, int]:
        number, degrees = int(words[0]), int(words[1])
        if number < 0 or not JOINTS[number].low <= degrees <= JOINTS[number].high:
            raise ValueError
        return number, degrees

    def _motion_play(self, words: list[str]) -> Say:
        if not words[0].casefold().endswith(".umf"):
            return [f"Error: file not found: {words[0]}"], self._takes(*LOADING)
        if self.application:
            return ["Error: the application holds the motion system"], self._takes(*SHORT)
        self.body.play_motion(words[0])
        return [f"playing {words[0]}"], self._takes(*LOADING)

    def _motion_speed(self, words: list[str]) -> Say:
        said = self._percent(words)
        self.body.motion_speed = int(words[0])
        return said

    def _sound_play(self, words: list[str]) -> Say:
        if not words[0].casefold().endswith(".usf"):
            return [f"Error: file not found: {words[0]}"], self._takes(*LOADING)
        self.body.play_sound(words[0])
        return [], self._takes(*LOADING)

    def _sound_volume(self, words: list[str]) -> Say:
        said = self._percent(words)
        self.body.volume = int(words[0])
        return said

    def _percent(self, words: list[str]) -> Say:
        if not 0 <= int(words[0]) <= 200:
            raise ValueError
        return [], self._takes(*SHORT)

    def _stats_power(self, words: list[str]) -> Say:
        percent = round(100 * self.body.battery)
        lines = [
            "Power statistics",
            "> 20 % it may walk",
            f"Battery sensor value = {percent} ({percent * 41 // 4:d} raw)",
            f"Battery temperature = {int(self.random.integers(20, 45))} (C)",
        ]
        return lines, self._takes(0.03, 0.15)
