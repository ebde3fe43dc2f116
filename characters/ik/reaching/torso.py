"""The torso of a body that reaches: how far it turns and leans so that an arm gets to a place.

The torso goes first (Huang 2013, section 8.6). It takes part once the arm is stretched to
`EASY_EXTENSION`, as people lean before their arm is straight (Mark et al. 1997), and the arm is
straight at the torso's own limit: the elbow's bend falls linearly with the effort, so it never
snaps.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

from cubeling.characters.ik.reaching.arms import CONE_RAD, Arm, clamped_aim, cone_axis, scale_vector
from cubeling.characters.skeleton.scalar_quaternions import (
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

LEAN_SHARE = 0.55
"""Lean ÷ the angle to a place from the torso's length: further on a lean gains ever less."""

MAX_TURN_RAD = math.radians(60.0)
"""How far a torso turns about its length."""

EASY_EXTENSION = 0.86
"""Extension of an arm ÷ its length up to which the torso stays as it is."""

POWER_SHARE = 0.3
"""Part of its turn and lean that full power adds for a stretched arm without need."""

TURN_SHARE = 0.45
"""Turn of the torso ÷ the angle to a place, from where its hand is at home."""

HOME_RAD = math.radians(30.0)
"""Where a hand is at home, from ahead to its own side."""

OPEN_TURN = 0.25
"""Part of its turn that an open posture makes without need."""

FOUR_LEGS = 0.4
"""What a torso that carries legs does of all that ÷ what that of a person does."""

LEAST_GAIN = 0.06
"""Gain of reach ÷ length of the arm over which a torso moves though it gains nothing."""

_BEHIND_RAD = math.radians(40.0)
_FOLLOWING_RAD = math.radians(40.0)
_LEAST_EXTENSION = EASY_EXTENSION - 2.0 * LEAST_GAIN
_ROUNDS = 12


class PlacedTorso(NamedTuple):
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

    def carry(self, step: Quaternion, place: Vector) -> Vector:
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
        return from_rotation_vector(scale_vector(turned, 1.0 / max(len(self.places), 1)))

    def chest_after(self, turned: Vector) -> Quaternion:
        """Return the rotation of the chest from its rest after a turn."""
        return multiply(from_rotation_vector(turned), self.chest) if self.places else self.chest


class Reaching(NamedTuple):
    """One arm that is to get somewhere."""

    arm: Arm

    fore: float
    """From its elbow to what reaches [m]."""

    shoulder: Vector
    """Where the upper arm begins before the torso moves [m]."""

    target: Vector
    """Where to [m]."""


class TorsoTurn(NamedTuple):
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
        missing = shortfall(torso, reaching, (0.0, 0.0, 0.0))
        return TorsoTurn((0.0, 0.0, 0.0), 1.0 + missing if missing else 0.0)
    turn, lean = _directions(torso, reaching)
    effort, share = _effort(torso, reaching[0], turn, lean)
    for each in reaching[1:]:
        other = _effort(torso, each, turn, lean)
        effort, share = max(effort, other[0]), max(share, other[1])
    if power > 0.0:
        share += (1.0 - share) * POWER_SHARE * power * max(map(_strain, reaching))
    # An open posture turns by itself, the less the more it has to turn anyway.
    open_turn = (1.0 - share) ** 2 * OPEN_TURN * openness
    turned = add(_turn_partly(turn, lean, share), scale_vector(turn, open_turn))
    if effort >= 1.0:
        effort = max(effort, 1.0 + shortfall(torso, reaching, turned))
    return TorsoTurn(turned, effort)


def follow_torso(torso: PlacedTorso, target: Vector, sign: float) -> Vector:
    """Return how a torso turns to a place that a hand of the side `sign` only points to."""
    azimuth, _ = _azimuth(torso, target, sign)
    turn = _turn(azimuth, sign, torso.limits)
    away = (abs(azimuth - sign * HOME_RAD) - _FOLLOWING_RAD) / math.pi
    return rotate(torso.facing, (0.0, turn * min(max(2.0 * away, 0.0), 1.0), 0.0))


def shortfall(torso: PlacedTorso, reaching: Sequence[Reaching], turned: Vector) -> float:
    """Return what arms lack to their places after a turn of the torso, in lengths of the arm.

    That of the worst arm; 0 where all are there.
    """
    step, chest, worst = torso.step(turned), torso.chest_after(turned), 0.0
    for each in reaching:
        shoulder, full = torso.carry(step, each.shoulder), each.arm.upper + each.fore
        aim = subtract(each.target, shoulder)
        x, y, z = clamped_aim(aim, chest, each.arm.sign)
        size = max(length((x, y, z)), 1e-9)
        taken = min(size, full) / size
        worst = max(worst, length(subtract(aim, (x * taken, y * taken, z * taken))) / full)
    return worst


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
    lean = min(most, LEAN_SHARE * angle, 1.5 * (math.pi - angle)) / max(size, 1e-9)
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
    turn = min(max(turn, -MAX_TURN_RAD), MAX_TURN_RAD) * limits * limits
    # Behind the other side there is a cut between a turn to the left and one to the right.
    cut = (math.pi - abs(azimuth - sign * _BEHIND_RAD)) / _BEHIND_RAD
    cut = min(max(cut, 0.0), 1.0)
    return turn * cut * cut * (3.0 - 2.0 * cut)


def _turn_partly(turn: Vector, lean: Vector, share: float) -> Vector:
    """Return a share, 0…1, of turn and lean: the turn goes first, and ends softly.

    So the last of it is all lean, which always gains length.
    """
    return add(scale_vector(turn, share * (2.0 - share)), scale_vector(lean, share))


def _effort(torso: PlacedTorso, each: Reaching, turn: Vector, lean: Vector) -> tuple[float, float]:
    """Return the effort to get an arm to its place, and the share of turn and lean, 0…1."""
    full = each.arm.upper + each.fore
    far = length(subtract(each.target, each.shoulder))
    effort = share = 0.0
    if far > _LEAST_EXTENSION * full:
        effort, share = _stretch(torso, each, turn, lean, far)
    if share < 1.0 and _turned_away(torso, each, IDENTITY):
        share = _share_for_direction(torso, each, turn, lean, share)
        effort = max(effort, share)
    return effort, share


def _stretch(
    torso: PlacedTorso, each: Reaching, turn: Vector, lean: Vector, far: float
) -> tuple[float, float]:
    """Return the effort for a place `far` away [m], and the share of turn and lean.

    At an effort e the arm lacks slack · (1 − e)² of its length: its elbow straightens linearly with
    e, where it would snap without a torso. What the arm does not gain, the torso does.
    """
    full = each.arm.upper + each.fore
    there = torso.carry(torso.step(add(turn, lean)), each.shoulder)
    at_end = far - length(subtract(each.target, there))
    gain = max(at_end, LEAST_GAIN * full)
    slack = min((1.0 - EASY_EXTENSION) * full, gain)
    effort = 1.0 - (full + at_end - far) / (slack + gain)
    effort = min(max(effort, 0.0), 1.0)
    return effort, effort - slack / gain * effort * (1.0 - effort)


def _strain(each: Reaching) -> float:
    """Return how far an arm is stretched before the torso moves: 0 up to its half … 1."""
    far = length(subtract(each.target, each.shoulder)) / (each.arm.upper + each.fore)
    return min(max(2.0 * far - 1.0, 0.0), 1.0)


def _share_for_direction(
    torso: PlacedTorso, each: Reaching, turn: Vector, lean: Vector, low: float
) -> float:
    """Return the share, at least `low`, that brings a place before a shoulder."""
    high = 1.0
    if _turned_away(torso, each, torso.step(add(turn, lean))):
        return high
    for _ in range(_ROUNDS):
        middle = 0.5 * (low + high)
        away = _turned_away(torso, each, torso.step(_turn_partly(turn, lean, middle)))
        low, high = (middle, high) if away else (low, middle)
    return high


def _turned_away(torso: PlacedTorso, each: Reaching, step: Quaternion) -> bool:
    """Return whether a place is further behind than a hand gets, after steps of the torso."""
    shoulder, axis = each.shoulder, cone_axis(torso.chest, each.arm.sign)
    if step is not IDENTITY:
        shoulder = torso.carry(step, shoulder)
        for _ in torso.places:
            axis = rotate(step, axis)
    aim = subtract(each.target, shoulder)
    return dot(axis, aim) < math.cos(CONE_RAD) * length(aim)
