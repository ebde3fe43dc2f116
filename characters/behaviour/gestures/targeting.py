"""Paths of hands from key to key (Huang 2013, section 8.4).

Each axis has one formula, f(t) = R sin(T π t + shift), about a centre that goes from key to key.
"""

import math
from dataclasses import dataclass, field

import numpy as np

from cubeling.characters.behaviour.symbolic_gesture import HandKey
from cubeling.characters.skeleton.pose import Array

SAMPLES_PER_TURN = 8
"""Points of a circle, and of a wave to and fro."""

SAMPLES = 6
"""Points of every other way from key to key."""

SAMPLES_WITH_POWER = 10
"""Points of a way that power makes uneven."""

RAMP = 0.15
"""Share of a circle or wave in which it gets its speed, and loses it."""


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


def samples(key: HandKey, power: float) -> int:
    """Return how many points the way to a key needs."""
    plain = SAMPLES if power <= 0.0 else SAMPLES_WITH_POWER
    if key.path in ("circle", "wave"):
        return max(plain, math.ceil(SAMPLES_PER_TURN * key.turns))
    return plain


def ramp(t: Array) -> Array:
    """Return times 0…1 that start and stop gently, as a hand that goes round or to and fro does.

    The speed rises and falls over `RAMP` of the time each.
    """
    speed = 1.0 / (1.0 - RAMP)
    rising = 0.5 * speed * t**2 / RAMP
    falling = 1.0 - 0.5 * speed * (1.0 - t) ** 2 / RAMP
    steady = speed * (t - RAMP / 2.0)
    times: Array = np.where(t < RAMP, rising, np.where(t > 1.0 - RAMP, falling, steady))
    return times
