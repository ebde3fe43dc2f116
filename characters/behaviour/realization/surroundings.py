"""Where the places are that behaviours name, and the character among them."""

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from cubeling.characters.behaviour.bml import CannotRealize
from cubeling.characters.skeleton.pose import Array

SAME_AS_VIEWER = ("camera", "user", "listener", "audience")
"""Names of the place that is called "viewer", unless they have one of their own."""

MAX_DISTANCE_M = 100.0
"""Farther places are refused [m]: they are typing errors."""

_NUMBERS = re.compile(r"[\s,;]+")


@dataclass
class NamedPlaces:
    """Places by name, which may move from frame to frame, and where the character is."""

    places: dict[str, Array] = field(default_factory=dict)
    """(x, y, z) in the table frame [m], by lower-case name."""

    eyes: Array = field(default_factory=lambda: np.array([0.0, 0.15, 0.0]))
    """Where the character's eyes are, (3,) in the table frame [m]."""

    yaw: float = 0.0
    """Where it faces [rad], to its left from +z."""

    def move(self, table_from_character: Array, eye_height: float) -> None:
        """Tell where the character is, (4, 4), and how high its eyes are in its own frame [m]."""
        self.eyes = table_from_character[:3] @ np.array([0.0, eye_height, 0.0, 1.0])
        self.yaw = math.atan2(table_from_character[0, 2], table_from_character[2, 2])

    def point(self, text: str) -> Array:
        """Return the place that a text names: a name, or three numbers [m].

        >>> NamedPlaces({"cube": np.zeros(3)}).point("0.1, 0.05 0.2").tolist()
        [0.1, 0.05, 0.2]

        Raises
        ------
        CannotRealize
            If it names none.
        """
        name = text.strip().lower()
        if name in SAME_AS_VIEWER and name not in self.places:
            name = "viewer"
        if name in self.places:
            return np.asarray(self.places[name], float)
        numbers = numbers_of(text)
        if len(numbers) == 3 and max(map(abs, numbers)) <= MAX_DISTANCE_M:
            return np.array(numbers)
        known = ", ".join(sorted(self.places)) or "none"
        raise CannotRealize(
            f'no target "{text}"; name a known one ({known}), or give x,y,z in metres'
        )

    def point_aside(self, point: Array, yaw: float, pitch: float) -> Array:
        """Return a point that lies to the left of another one and above it by angles [rad]."""
        way = point - self.eyes
        distance = float(np.linalg.norm(way))
        left = math.atan2(way[0], way[2]) + yaw
        up = math.asin(min(max(way[1] / max(distance, 1e-9), -1.0), 1.0)) + pitch
        aside = (math.sin(left) * math.cos(up), math.sin(up), math.cos(left) * math.cos(up))
        shifted: Array = self.eyes + distance * np.array(aside)
        return shifted


DIRECTIONS: Mapping[str, tuple[float, float]] = {
    "LEFT": (1.0, 0.0),
    "RIGHT": (-1.0, 0.0),
    "UP": (0.0, 1.0),
    "DOWN": (0.0, -1.0),
    "UPLEFT": (0.7, 0.7),
    "UPRIGHT": (-0.7, 0.7),
    "DOWNLEFT": (0.7, -0.7),
    "DOWNRIGHT": (-0.7, -0.7),
}
"""BML's directions of an offset: to the left, and up."""


def numbers_of(text: str) -> list[float]:
    """Return the finite numbers of a text; none if there is anything else."""
    try:
        numbers = [float(part) for part in _NUMBERS.split(text.strip()) if part]
    except ValueError:
        return []
    return numbers if all(map(math.isfinite, numbers)) else []
