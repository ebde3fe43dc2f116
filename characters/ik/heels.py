"""Heels that lift where an ankle bends no further: the ball of the foot stays planted."""

import math

from cubeling.characters.ik import two_bones
from cubeling.characters.skeleton.natural_limits import RANGES
from cubeling.characters.skeleton.scalar_quaternions import (
    IDENTITY,
    Quaternion,
    Vector,
    add,
    cross,
    dot,
    from_rotation_vector,
    length,
    rotate,
    subtract,
)

MOST_FLEXION_RAD = math.radians(RANGES["Foot"].bend[1])
"""How far an ankle bends up from rest."""

SOFT_RAD = math.radians(8.0)
"""The heel begins to lift so long before the ankle is there: none snaps off the ground."""

MOST_LIFT_RAD = math.radians(75.0)
"""How far a heel lifts."""

STEPS = 4
"""Steps to the lift: each leaves about a fifth of the error, as the raised ankle leans the shin."""


def angle_at(ankle: Vector, knee: Vector, ball: Vector) -> float:
    """Return the angle between shin and foot [rad]."""
    shin, foot = subtract(knee, ankle), subtract(ball, ankle)
    return math.atan2(length(cross(shin, foot)), dot(shin, foot))


def heel_lift(
    leg: tuple[Vector, Vector, Vector],
    planted: tuple[Vector, Vector],
    left: Vector,
    rest_angle: float,
    *,
    knees_ahead: bool = True,
) -> Quaternion:
    """Return how a planted foot turns about its ball so that its ankle stays within its range.

    Parameters
    ----------
    leg
        Hip, knee and ankle before the leg bends to the foot [m].
    planted
        Ankle and ball of the foot flat on the ground, in the same frame [m].
    left
        Unit vector across the foot.
    rest_angle
        Between shin and foot at rest [rad]; see `angle_at`.
    """
    hip, knee, ankle = leg
    flat, ball = planted
    turn, lift, raised = IDENTITY, 0.0, flat
    for _ in range(STEPS):
        upper, _ = two_bones.reach(hip, knee, ankle, raised, knees_ahead=knees_ahead)
        bent = add(hip, rotate(upper, subtract(knee, hip)))
        over = rest_angle - angle_at(raised, bent, ball) + lift - MOST_FLEXION_RAD
        if over <= -SOFT_RAD:
            return IDENTITY
        lift = over if over >= SOFT_RAD else (over + SOFT_RAD) ** 2 / (4.0 * SOFT_RAD)
        lift = min(lift, MOST_LIFT_RAD)
        x, y, z = left
        turn = from_rotation_vector((lift * x, lift * y, lift * z))
        raised = add(ball, rotate(turn, subtract(flat, ball)))
    return turn


def across(ankle: Vector, ball: Vector) -> Vector:
    """Return the unit vector to the left of a foot; of one that stands on end, that of the body."""
    x, z = ball[2] - ankle[2], ankle[0] - ball[0]
    size = math.hypot(x, z)
    return (x / size, 0.0, z / size) if size > 1e-9 else (1.0, 0.0, 0.0)
