"""Heels that lift where an ankle bends no further: the ball of the foot stays planted."""

import math
from typing import NamedTuple

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

LIFT_STEPS = 3
"""Steps to the lift: each leaves about a fifth of the error, as the raised ankle leans the shin."""


class BentLeg(NamedTuple):
    """How a leg bends to its planted foot."""

    upper: Quaternion
    """Rotation of the whole leg about the hip; see `two_bones.reach`."""

    lower: Quaternion
    """Rotation of the shin about the knee, before that."""

    foot: Quaternion
    """Turn of the foot about its ball; `IDENTITY` while the heel is down."""


def angle_at(ankle: Vector, knee: Vector, ball: Vector) -> float:
    """Return the angle between shin and foot [rad]."""
    shin, foot = subtract(knee, ankle), subtract(ball, ankle)
    return math.atan2(length(cross(shin, foot)), dot(shin, foot))


def bend_to_foot(
    leg: tuple[Vector, Vector, Vector], flat: Vector, ball: Vector, rest_angle: float
) -> BentLeg:
    """Return how a leg bends to a planted foot, whose heel lifts as far as its ankle needs it.

    Parameters
    ----------
    leg
        Hip, knee and ankle before the leg bends [m].
    flat
        Where the ankle is with the foot flat on the ground [m].
    ball
        Where the ball of the foot is and stays [m].
    rest_angle
        Between shin and foot at rest [rad]; see `angle_at`.
    """
    hip, knee, _ = leg
    upper, lower = two_bones.reach(*leg, flat)
    foot, lift, raised = IDENTITY, 0.0, flat
    for _ in range(LIFT_STEPS):
        bent = add(hip, rotate(upper, subtract(knee, hip)))
        over = rest_angle - angle_at(raised, bent, ball) + lift - MOST_FLEXION_RAD
        if over <= -SOFT_RAD:
            break
        lift = over if over >= SOFT_RAD else (over + SOFT_RAD) ** 2 / (4.0 * SOFT_RAD)
        lift = min(lift, MOST_LIFT_RAD)
        x, _, z = across(flat, ball)
        foot = from_rotation_vector((lift * x, 0.0, lift * z))
        raised = add(ball, rotate(foot, subtract(flat, ball)))
        upper, lower = two_bones.reach(*leg, raised)
    return BentLeg(upper, lower, foot)


def across(ankle: Vector, ball: Vector) -> Vector:
    """Return the unit vector to the left of a foot; of one that stands on end, that of the body."""
    x, z = ball[2] - ankle[2], ankle[0] - ball[0]
    size = math.hypot(x, z)
    return (x / size, 0.0, z / size) if size > 1e-9 else (1.0, 0.0, 0.0)
