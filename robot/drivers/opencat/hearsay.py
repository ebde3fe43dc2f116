"""What a board says without being an echo: its joints, its battery, its falls."""

import math
import re
from typing import Literal

from robot.contract.telemetry import complaint_of
from robot.drivers.opencat.models import MODELS
from robot.drivers.opencat.tokens import JOINTS

_ANGLES = re.compile(r"-?\d{1,3},\s*" * (JOINTS - 1) + r"-?\d{1,3},?")

_COMPLAINTS = ("Low power", "EXCEPTION", "Undefined token", "?")
"""How lines begin that say what is wrong: of its battery, a fall, a token and a skill."""

WEAK_FOR = 25.0
"""A board that has said so long ago that its battery is low, and not again, has power [s]; while it
is low it says so every 10 s, and not every board says when it is not low any more."""

News = Literal["known", "power", "weak", "fell", "unknown"]


class Hearsay:
    """What a board has said of itself."""

    def __init__(self) -> None:
        self._weak_until = -math.inf
        self.complaint: str | None = None
        """What it last complained of; its owner says when that is over, or its battery does."""
        self.angles: dict[str, float] = {}
        """Angles of the joints by name [rad], as the board commanded them; it measures none."""

    def forget(self) -> None:
        """Forget it all but a complaint, which may be why: the board has started anew."""
        self._weak_until = -math.inf
        self.angles = {}

    def is_weak(self, now: float) -> bool:
        """Whether the battery is low at time `now` [s]: the board echoes, and nothing moves."""
        return now < self._weak_until

    def take(self, line: str, model: str, now: float) -> News:
        """Take a line; return what it was about.

        known: nothing to be done. power: a command that moves is taken up. weak: the battery is
        low. fell: the robot does something by itself.
        """
        if line.startswith(_COMPLAINTS) and len(line) > 1:  # "?" alone is an echo
            self.complaint = complaint_of(line)
        if line == "G":  # balancing is switched on again by the first line after a rest
            return "power"
        if line.startswith("Low power"):
            self._weak_until = now + WEAK_FOR
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
