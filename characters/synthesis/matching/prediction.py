"""Where a character wants to be: its path ahead, by critically damped springs."""

import math
from dataclasses import dataclass

import numpy as np

from characters.motion.motion import RootDelta
from characters.skeleton.pose import Array
from characters.smoothing import damped_spring
from characters.synthesis.matching.features import HORIZONS_S

SPEED_LAG_S = 0.35
"""Time constant with which the wished speed is taken up [s]."""

TURN_LAG_S = 0.35
"""Time constant with which the wished heading is taken up [s]."""

MAX_TURN_RATE = 3.0
"""A body turns no faster than this [rad/s]."""

BRAKING = 1.6
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
class RootMotion:
    """How a root moves now."""

    speed: float = 0.0
    """Forward [m/s]."""

    turn_rate: float = 0.0
    """To the left [rad/s]."""


def predict(
    place: RootDelta, moving: RootMotion, wish: Wish, body_height: float
) -> dict[str, Array]:
    """Return the features "path" and "facing" of the way that a wish leads.

    Heading and speed follow those of the wish as critically damped springs do; it brakes before it
    stops, and slows down where it must turn.
    """
    x, z, yaw = place.x, place.z, place.yaw
    speed, rate = moving.speed, moving.turn_rate
    acceleration, elapsed = 0.0, max(HORIZONS_S) / _STEPS
    path, facing = [], []
    at = [round(horizon / elapsed) for horizon in HORIZONS_S]
    sine, cosine = math.sin(yaw), math.cos(yaw)
    for step in range(1, _STEPS + 1):
        error, wished = _course(RootDelta(x, z, yaw), wish, body_height)
        before = yaw
        offset, rate = damped_spring(-error, rate, 0.0, elapsed, TURN_LAG_S)
        rate = min(max(rate, -MAX_TURN_RATE), MAX_TURN_RATE)
        turn = min(max(error + offset, -MAX_TURN_RATE * elapsed), MAX_TURN_RATE * elapsed)
        yaw += turn
        speed, acceleration = damped_spring(speed, acceleration, wished, elapsed, SPEED_LAG_S)
        x += math.sin((yaw + before) / 2) * speed * elapsed
        z += math.cos((yaw + before) / 2) * speed * elapsed
        if step in at:
            dx, dz, turned = x - place.x, z - place.z, yaw - place.yaw
            path += [cosine * dx - sine * dz, sine * dx + cosine * dz]
            facing += [math.sin(turned), math.cos(turned)]
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
        speed = min(speed, math.sqrt(2.0 * BRAKING * body_height * left))
    return error, speed * max(math.cos(error), 0.0) if speed > 0.0 else 0.0
