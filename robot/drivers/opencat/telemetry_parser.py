"""Reads what a board reports besides echoes: joint angles, battery, falls and errors."""

import math
import re
from typing import Literal

from cubeling.robot.contract.telemetry import complaint_of
from cubeling.robot.drivers.opencat.models import MODELS
from cubeling.robot.drivers.opencat.tokens import JOINTS

_ANGLES = re.compile(r"-?\d{1,3},\s*" * (JOINTS - 1) + r"-?\d{1,3},?")

_COMPLAINTS = ("Low power", "EXCEPTION", "Undefined token", "?")
"""Beginnings of error lines: about the battery, a fall, a token and a skill."""

LOW_BATTERY_S = 25.0
"""Time after a low battery report until the board has power again [s]; it reports every 10 s."""

Report = Literal["known", "power", "weak", "fell", "unknown"]
"""known: nothing to do. power: the board executes a moving command. weak: the battery is low.
fell: the robot moves by itself. unknown: text without a meaning here."""


class TelemetryParser:
    """What a board has reported."""

    def __init__(self) -> None:
        self._weak_until = -math.inf
        self.complaint: str | None = None
        """The last error message; the caller clears it, or a battery report does."""
        self.angles: dict[str, float] = {}
        """Commanded joint angles by name [rad]; the board measures none."""

    def restart(self) -> None:
        """Forget everything except an error message, which may be the reason of the restart."""
        self._weak_until = -math.inf
        self.angles = {}

    def is_weak(self, now: float) -> bool:
        """Return whether the battery is low at `now` [s]: the board echoes, and nothing moves."""
        return now < self._weak_until

    def parse(self, line: str, model: str, now: float) -> Report:
        """Process a line; return what it reports."""
        if line.startswith(_COMPLAINTS) and len(line) > 1:  # "?" alone is an echo
            self.complaint = complaint_of(line)
        if line == "G":  # the first line after a rest switches balancing on again
            return "power"
        if line.startswith("Low power"):
            self._weak_until = now + LOW_BATTERY_S
            return "weak"
        if line.startswith("EXCEPTION"):
            return "fell"
        if line.startswith("Got ") and line.endswith("power"):
            self._weak_until = now
            self.complaint = None
        elif _ANGLES.fullmatch(line):
            angles = [int(angle) for angle in re.findall(r"-?\d+", line)]
            self.angles = {
                joint.name: math.radians(angles[joint.number]) for joint in MODELS[model]
            }
        elif len(line) > 1:
            return "unknown"
        return "known"
