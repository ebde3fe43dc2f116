"""Where a character wants to be: its path ahead, by critically damped springs."""

import math
from dataclasses import dataclass

import numpy as np

from cubeling.characters.motion.motion import RootDelta
from cubeling.characters.skeleton.pose import Array
from cubeling.characters.smoothing import damped_spring
from cubeling.characters.synthesis.matching.features import HORIZONS_S

SPEED_LAG_S = 0.35
"""Time constant with which the wished speed is taken up [s]."""

TURN_LAG_S = 0.35
"""Time constant with which the wished heading is taken up [s]."""

MAX_TURN_RATE = 3.0
"""A body turns no faster than this [rad/s]."""

BRAKING_RATE = 1.6
"""Deceleration before a stop [body heights/s²]."""

_STEPS = 15  # of one horizon: 1/15 s each


@dataclass(frozen=True)
class Wish:
    """Where a character is to go, in metres of the character."""

    speed: float = 0.0
    """How fast [m/s]; 0 to stand."""

    target: tuple[float, float] | None = None
    """Where to go, or, standing, which point to face, (x, z) [m]; None to keep the heading."""

    stop_distance: float = 0.0
    """It stops this far from the target [m]; infinite to pass it."""


@dataclass(frozen=True)
class Impulse:
    """How fast a character that follows its wish would move, by critically damped springs."""

    speed: float = 0.0
    """Forward [m/s]."""

    acceleration: float = 0.0
    """[m/s²]."""

    turn_rate: float = 0.0
    """To the left [rad/s]."""

    def advance(
        self, place: RootDelta, wish: Wish, body_height: float, elapsed: float
    ) -> tuple["Impulse", RootDelta]:
        """Return the motion, and where it leads from a place [m], a time later [s].

        It brakes before it stops, and slows down where it must turn.
        """
        error, wished = _course(place, wish, body_height)
        offset, rate = damped_spring(-error, self.turn_rate, 0.0, elapsed, TURN_LAG_S)
        turn, rate = (
            min(max(value, -limit), limit)
            for value, limit in ((error + offset, MAX_TURN_RATE * elapsed), (rate, MAX_TURN_RATE))
        )
        speed, acceleration = damped_spring(
            self.speed, self.acceleration, wished, elapsed, SPEED_LAG_S
        )
        halfway, walked = place.yaw + turn / 2, speed * elapsed
        return Impulse(speed, acceleration, rate), RootDelta(
            place.x + math.sin(halfway) * walked,
            place.z + math.cos(halfway) * walked,
            place.yaw + turn,
        )


def predict(place: RootDelta, moving: Impulse, wish: Wish, body_height: float) -> dict[str, Array]:
    """Return the features "path" and "facing" of the way that a wish leads."""
    elapsed = max(HORIZONS_S) / _STEPS
    compared = [round(horizon / elapsed) for horizon in HORIZONS_S]
    there, path, facing = place, [], []
    for step in range(1, _STEPS + 1):
        moving, there = moving.advance(there, wish, body_height, elapsed)
        if step in compared:
            ahead = place.to(there)
            path += [ahead.x, ahead.z]
            facing += [math.sin(ahead.yaw), math.cos(ahead.yaw)]
    return {"path": np.array(path), "facing": np.array(facing)}


def _course(place: RootDelta, wish: Wish, body_height: float) -> tuple[float, float]:
    """Return the error of the heading [rad] and the wished speed [m/s]."""
    if wish.target is None:
        return 0.0, wish.speed
    error, speed = place.bearing(*wish.target), wish.speed
    if speed > 0.0 and math.isfinite(wish.stop_distance):
        left = math.hypot(wish.target[0] - place.x, wish.target[1] - place.z) - wish.stop_distance
        if left <= 0.0:
            return 0.0, 0.0
        speed = min(speed, math.sqrt(2.0 * BRAKING_RATE * body_height * left))
    return error, speed * max(math.cos(error), 0.0) if speed > 0.0 else 0.0
