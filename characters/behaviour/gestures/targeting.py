"""Paths of hands from key to key (Huang 2013, section 8.4).

Each axis has one formula, f(t) = R sin(T π t + shift), about a centre that goes from key to key.
"""

import math
from dataclasses import dataclass, field

import numpy as np

from cubeling.characters.behaviour.symbolic_gesture import HandKey
from cubeling.characters.skeleton.pose import Array

POINTS_PER_TURN = 8
"""Points of a circle: a spline through them is round to within a hundredth of its radius."""

MIN_LINE = 0.3
"""Length of a line from which it has a point in its middle, in parts of an arm's length; arms swing
through shorter ones."""


@dataclass(frozen=True, eq=False)
class PathFormula:
    """What a path adds to the way of its centre; a radius of zero leaves it as it is."""

    radius: Array
    """R of each axis, (3,) [m]."""

    frequency: float = 0.0
    """T: half periods from key to key."""

    shift: Array = field(default_factory=lambda: np.zeros(3))
    """Phase of each axis, (3,) [rad]."""

    @staticmethod
    def of(key: HandKey, radius: Array) -> "PathFormula":
        """Return the path to a key; `radius` is that of the key in the character frame [m].

        An arc bows towards its radius, a wave goes to and fro along it, and a circle goes round in
        the plane of the first two axes that have one. Turns are rounded, so that each ends at its
        key.
        """
        if key.path == "arc":
            return PathFormula(radius, 1.0)
        if key.path == "wave":
            return PathFormula(radius, max(round(2.0 * key.turns), 1.0))
        if key.path == "circle":
            shift = np.zeros(3)
            used = np.flatnonzero(radius)
            shift[used[1:2]] = math.pi / 2.0
            return PathFormula(radius, 2.0 * max(round(key.turns), 1.0), shift)
        return PathFormula(np.zeros(3))

    def at(self, t: Array) -> Array:
        """Return f at times t (m,), 0…1 from key to key, (m, 3) [m]."""
        phase = self.frequency * math.pi * t[:, None] + self.shift
        offsets: Array = self.radius * np.sin(phase)
        return offsets

    def offsets(self, t: Array) -> Array:
        """Return what it adds to a way that starts at the key: f(t) − f(0), (m, 3) [m]."""
        return self.at(t) - self.at(np.zeros(1))


def path_points(key: HandKey, length: float) -> Array:
    """Return the shares, 0…1 without both, of the way to a key at which it has points, (n,).

    A spline through them is the path; `length` is that from key to key, in parts of an arm's. A
    wave has one at each turn.
    """
    bows = any(key.radius)
    if key.path == "wave" and bows:
        half_periods = max(round(2.0 * key.turns), 1)
        return (np.arange(half_periods) + 0.5) / half_periods
    if key.path == "circle" and bows:
        return np.linspace(0.0, 1.0, POINTS_PER_TURN * max(round(key.turns), 1) + 1)[1:-1]
    straight = key.path != "keys" and not bows
    halved = (key.path == "arc" and bows) or (straight and length > MIN_LINE)
    return np.array([0.5] if halved else [])
