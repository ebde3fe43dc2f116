"""The torso of a body that reaches: how far it turns and leans so that an arm gets to a place.

The torso goes first (Huang 2013, section 8.6). It takes part once the arm is stretched to
`EASY_EXTENSION`, as people lean before their arm is straight (Mark et al. 1997), and the arm is
straight at the torso's own limit: the elbow's bend falls linearly with the effort, so it never
snaps.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

from characters.ik.reaching.arms import CONE_RAD, Arm, clamped_aim, cone_axis, scaled
from characters.skeleton.scalar_quaternions import (
    IDENTITY,
    Quaternion,
    Vector,
    add,
    conjugate,
    cross,
    dot,
    from_rotation_vector,
    length,
    multiply,
    rotate,
    subtract,
)

MAX_LEAN_RAD = math.radians(35.0)
"""How far a torso leans ahead; less to its side, and little back."""

MAX_TURN_RAD = math.radians(60.0)
"""How far a torso turns about its length."""

EASY_EXTENSION = 0.86
"""Extension of an arm ÷ its length up to which the torso stays as it is."""

POWER_EXTENSION = 0.12
"""By how much full power lowers that extension."""

TURN_SHARE = 0.45
"""Turn of the torso ÷ the angle to a place, from where its hand is at home."""

HOME_RAD = math.radians(30.0)
"""Where a hand is at home, from ahead to its own side."""

OPEN_TURN = 0.25
"""Part of its turn that an open posture makes without need."""

FOUR_LEGS = 0.4
"""What a torso that carries legs does of all that ÷ what that of a person does."""

_BEHIND_RAD = math.radians(40.0)
_FOLLOWING_RAD = math.radians(40.0)
_ROUNDS = 12
_SAME_SHARE = 1e-4


@dataclass(frozen=True)
class PlacedTorso:
    """A torso in one pose, in the character frame."""

    places: Sequence[Vector]
    """The joints that bend, from the lowest one on [m]."""

    facing: Quaternion
    """Rotation of the pelvis from its rest."""

    chest: Quaternion
    """Rotation of the chest from its rest."""

    top: Vector
    """The middle between the shoulders [m]."""

    limits: float
    """Share of the limits of a person's torso that this one has."""

    def carried(self, step: Quaternion, place: Vector) -> Vector:
        """Return where the torso takes a place of its top when each joint makes a turn."""
        places = self.places
        x, y, z = place
        for number in range(len(places) - 1, -1, -1):
            px, py, pz = places[number]
            x, y, z = rotate(step, (x - px, y - py, z - pz))
            x, y, z = x + px, y + py, z + pz
        return x, y, z

    def step(self, turned: Vector) -> Quaternion:
        """Return the part of each joint of a whole turn, a rotation vector [rad]."""
        return from_rotation_vector(scaled(turned, 1.0 / max(len(self.places), 1)))

    def chest_after(self, turned: Vector) -> Quaternion:
        """Return the rotation of the chest from its rest after a turn."""
        return multiply(from_rotation_vector(turned), self.chest) if self.places else self.chest


class Reaching(NamedTuple):
    """One arm that is to get somewhere."""

    arm: Arm
    """Its bones."""

    fore: float
    """From its elbow to what reaches [m]."""

    shoulder: Vector
    """Where the upper arm begins before the torso moves [m]."""

    target: Vector
    """Where to [m]."""


@dataclass(frozen=True)
class TorsoTurn:
    """What a torso does for a place."""

    turned: Vector
    """How it turns and leans, as a rotation vector [rad]."""

    effort: float
    """0 within the arm's reach … 1 where torso and arm are stretched; more beyond."""


def turn_torso(
    torso: PlacedTorso, reaching: Sequence[Reaching], openness: float, power: float
) -> TorsoTurn:
    """Return what a torso does so that all arms get where they are to be, if they can."""
    if not torso.places:
        return TorsoTurn((0.0, 0.0, 0.0), _beyond(torso, reaching, (0.0, 0.0, 0.0), power))
    turn, lean = _directions(torso, reaching)
    easy = EASY_EXTENSION - POWER_EXTENSION * power
    whole = add(turn, lean)
    effort = max(_effort(torso, each, whole, easy) for each in reaching)
    # An open posture turns by itself, the less the more it has to turn anyway.
    share = effort + (1.0 - effort) * OPEN_TURN * openness
    turned = add(scaled(turn, share), scaled(lean, effort))
    if effort >= 1.0:
        effort = max(effort, _beyond(torso, reaching, turned, power))
    return TorsoTurn(turned, effort)


def follow_torso(torso: PlacedTorso, target: Vector, sign: float) -> Vector:
    """Return how a torso turns to a place that a hand of the side `sign` only points to."""
    azimuth, _ = _azimuth(torso, target, sign)
    turn = _turn(azimuth, sign, torso.limits)
    away = (abs(azimuth - sign * HOME_RAD) - _FOLLOWING_RAD) / math.pi
    return rotate(torso.facing, (0.0, turn * min(max(2.0 * away, 0.0), 1.0), 0.0))


def _directions(torso: PlacedTorso, reaching: Sequence[Reaching]) -> tuple[Vector, Vector]:
    """Return the whole turn and the whole lean towards the middle of the places."""
    sign = reaching[0].arm.sign if len(reaching) == 1 else 0.0
    middle = reaching[0].target
    if len(reaching) > 1:
        x, y, z = add(middle, reaching[1].target)
        middle = (0.5 * x, 0.5 * y, 0.5 * z)
    azimuth, near = _azimuth(torso, middle, sign)
    turn = _turn(azimuth, sign, torso.limits) * near
    # The lean turns the torso about the normal of the plane of its length and the place.
    length_of, to_place = subtract(torso.top, torso.places[0]), subtract(middle, torso.places[0])
    axis = cross(length_of, to_place)
    size = length(axis)
    angle = math.atan2(size, dot(length_of, to_place))
    most = MAX_LEAN_RAD * torso.limits * (0.64 + 0.36 * math.cos(azimuth))
    lean = min(most, angle, 1.5 * (math.pi - angle)) / max(size, 1e-9)
    up = rotate(torso.facing, (0.0, turn, 0.0))
    return up, (axis[0] * lean, axis[1] * lean, axis[2] * lean)


def _azimuth(torso: PlacedTorso, target: Vector, sign: float) -> tuple[float, float]:
    """Return the angle to a place, to the left from ahead [rad], and how far out it is, 0…1.

    A hand turns to what is behind by its own side.
    """
    base = torso.places[0] if torso.places else torso.top
    x, _, z = rotate(conjugate(torso.facing), subtract(target, base))
    square, size = x * x + z * z, length(subtract(torso.top, base))
    azimuth = math.atan2(x, z)
    start = sign * _BEHIND_RAD - math.pi
    azimuth = start + (azimuth - start) % math.tau
    return azimuth, square / (square + 0.05 * size * size + 1e-12)


def _turn(azimuth: float, sign: float, limits: float) -> float:
    """Return how far a torso turns to a place at most [rad], to its left."""
    turn = TURN_SHARE * (azimuth - sign * HOME_RAD)
    turn = min(max(turn, -MAX_TURN_RAD), MAX_TURN_RAD) * limits
    # Behind the other side there is a cut between a turn to the left and one to the right.
    cut = (math.pi - abs(azimuth - sign * _BEHIND_RAD)) / _BEHIND_RAD
    cut = min(max(cut, 0.0), 1.0)
    return turn * cut * cut * (3.0 - 2.0 * cut)


def _effort(torso: PlacedTorso, each: Reaching, whole: Vector, easy: float) -> float:
    """Return the share of its whole turn with which an arm gets to its place, 0…1."""
    aim = subtract(each.target, each.shoulder)
    size = easy * (each.arm.upper + each.fore)
    share = 0.0
    if dot(aim, aim) > size * size:
        share = _share_for_distance(torso, each, whole, easy)
    if share < 1.0 and _turned_away(torso, each, IDENTITY):
        share = _share_for_direction(torso, each, whole, share)
    return share


def _share_for_distance(torso: PlacedTorso, each: Reaching, whole: Vector, easy: float) -> float:
    """Return the share of a whole turn for which an arm is as long as it is stretched then.

    The way of the shoulder is nearly a parabola: it is followed at its ends and its middle, and
    Newton's method finds the share.
    """
    place, target, size = each.shoulder, each.target, each.arm.upper + each.fore
    x0, y0, z0 = subtract(target, place)
    x1, y1, z1 = subtract(target, torso.carried(torso.step(scaled(whole, 0.5)), place))
    x2, y2, z2 = subtract(target, torso.carried(torso.step(whole), place))
    if x2 * x2 + y2 * y2 + z2 * z2 >= size * size:
        return 1.0
    ax, ay, az = 2.0 * (x0 + x2) - 4.0 * x1, 2.0 * (y0 + y2) - 4.0 * y1, 2.0 * (z0 + z2) - 4.0 * z1
    bx, by, bz = x2 - x0 - ax, y2 - y0 - ay, z2 - z0 - az
    low, high, share, slack = 0.0, 1.0, 0.5, size * (1.0 - easy)
    for _ in range(_ROUNDS):
        x, y, z = (
            (ax * share + bx) * share + x0,
            (ay * share + by) * share + y0,
            (az * share + bz) * share + z0,
        )
        left = 1.0 - share
        stretched = size - slack * left * left
        lack = x * x + y * y + z * z - stretched * stretched
        along = x * (2 * ax * share + bx) + y * (2 * ay * share + by) + z * (2 * az * share + bz)
        slope = 2.0 * (along - 2.0 * stretched * slack * left)
        low, high = (share, high) if lack > 0.0 else (low, share)
        before = share
        share = share - lack / slope if slope < 0.0 else low
        if not low < share < high:
            share = 0.5 * (low + high)
        if abs(share - before) < _SAME_SHARE:
            break
    return share


def _share_for_direction(torso: PlacedTorso, each: Reaching, whole: Vector, low: float) -> float:
    """Return the share of a whole turn, at least `low`, that brings a place before a shoulder."""
    high = 1.0
    if _turned_away(torso, each, torso.step(whole)):
        return high
    for _ in range(_ROUNDS):
        middle = 0.5 * (low + high)
        away = _turned_away(torso, each, torso.step(scaled(whole, middle)))
        low, high = (middle, high) if away else (low, middle)
    return high


def _turned_away(torso: PlacedTorso, each: Reaching, step: Quaternion) -> bool:
    """Return whether a place is further behind than a hand gets, after steps of the torso."""
    shoulder, axis = each.shoulder, cone_axis(torso.chest, each.arm.sign)
    if step is not IDENTITY:
        shoulder = torso.carried(step, shoulder)
        for _ in torso.places:
            axis = rotate(step, axis)
    aim = subtract(each.target, shoulder)
    return dot(axis, aim) < math.cos(CONE_RAD) * length(aim)


def _beyond(
    torso: PlacedTorso, reaching: Sequence[Reaching], turned: Vector, power: float
) -> float:
    """Return the effort for places that are not reached: 1, and by what arms are too short."""
    step, chest, worst = torso.step(turned), torso.chest_after(turned), 0.0
    for each in reaching:
        shoulder, full = torso.carried(step, each.shoulder), each.arm.upper + each.fore
        aim = subtract(each.target, shoulder)
        x, y, z = clamped_aim(aim, chest, each.arm.sign)
        size = max(length((x, y, z)), 1e-9)
        taken = min(size, full) / size
        worst = max(worst, length(subtract(aim, (x * taken, y * taken, z * taken))) / full)
    return 1.0 + worst if worst > 0.0 else 0.0
