"""Where an elbow is on its circle about the line from the shoulder to the hand, and how straight.

It keeps what it has of its own in the pose that a reach starts from. The elbows of recorded people
who were left out of the fit are so a third nearer to where they have them (`tests.bench.ik`).
"""

import math
from typing import NamedTuple

from cubeling.characters.ik.reaching.arms import (
    SOFT_LACK,
    STRAIGHT_LACK,
    Arm,
    Elbow,
    aim_at,
    scale_vector,
    swivel_axes,
)
from cubeling.characters.skeleton.scalar_quaternions import (
    Quaternion,
    Vector,
    conjugate,
    dot,
    length,
    rotate,
    subtract,
)

SWIVEL_DEG = (-20.0, 70.0)
"""Swivel of the elbow from the vertical plane outward, closed and open [degrees]."""

SWIVEL_WAY, STRAIGHT_WAY = 0.8, 0.7
"""How far a hand moves, in arm lengths, until its elbow keeps 0.6 of its own swivel, and of how
straight it was."""

LEAST_ASIDE = 0.05
"""Distance of an elbow from the line of its arm, in arm lengths, at which half of its swivel counts
as its own: of a straight arm it is chance."""


class OwnElbow(NamedTuple):
    """What the elbow of an arm in a pose has of its own."""

    swivel: float
    """Besides the natural one [rad]."""

    lack: float
    """What the arm lacks to its full length, as a part of it."""

    hand: Vector
    """Where the hand is from the shoulder, in the axes of the chest [arm lengths]."""


def own_elbow(
    arm: Arm, shoulder: Vector, elbow: Vector, wrist: Vector, chest: Quaternion
) -> OwnElbow:
    """Return what an elbow has of its own; the places are those of a pose [m]."""
    hand = _seen_from_chest(arm, shoulder, wrist, chest)
    swivel = swivel_of(arm, shoulder, elbow, wrist, chest) - _natural_swivel(arm, hand)
    swivel = math.remainder(swivel, math.tau)
    swivel *= 1.0 - (swivel / math.pi) ** 4  # opposite, both ways round are as long
    extension, bone = length(hand), arm.upper / (arm.upper + arm.fore)
    along = 0.5 * (extension + (2.0 * bone - 1.0) / max(extension, 1e-9))  # law of cosines
    square = max(bone * bone - along * along, 0.0)
    swivel *= square / (square + LEAST_ASIDE * LEAST_ASIDE)
    return OwnElbow(swivel, max(1.0 - extension, STRAIGHT_LACK), hand)


def natural_elbow(
    arm: Arm, shoulder: Vector, place: Vector, chest: Quaternion, own: OwnElbow | None = None
) -> Elbow:
    """Return the elbow of a hand at a place, if none is asked for.

    It keeps what it has of its own, the less the farther its hand moves.
    """
    hand = _seen_from_chest(arm, shoulder, place, chest)
    swivel = _natural_swivel(arm, hand)
    if own is None:
        return Elbow(swivel, SOFT_LACK)
    x, y, z = subtract(hand, own.hand)
    square = 0.5 * (x * x + y * y + z * z)
    swivel += own.swivel * math.exp(-square / (SWIVEL_WAY * SWIVEL_WAY))
    straight = max(SOFT_LACK - own.lack, 0.0) * math.exp(-square / (STRAIGHT_WAY * STRAIGHT_WAY))
    return Elbow(swivel, SOFT_LACK - straight)


def swivel_of(arm: Arm, shoulder: Vector, elbow: Vector, wrist: Vector, chest: Quaternion) -> float:
    """Return the swivel of an elbow outward [rad]."""
    aim, _ = aim_at(subtract(wrist, shoulder), arm, arm.fore, chest, STRAIGHT_LACK)
    down, outward = swivel_axes(arm, aim, chest)
    side = subtract(elbow, shoulder)
    return math.atan2(dot(side, outward), dot(side, down))


def _natural_swivel(arm: Arm, hand: Vector) -> float:
    still, by_up, by_ahead = arm.natural_swivel
    _, up, ahead = hand
    return still + by_up * min(max(up, -1.0), 1.0) + by_ahead * min(max(ahead, -1.0), 1.0)


def _seen_from_chest(arm: Arm, shoulder: Vector, place: Vector, chest: Quaternion) -> Vector:
    size = 1.0 / (arm.upper + arm.fore)
    return rotate(conjugate(chest), scale_vector(subtract(place, shoulder), size))
