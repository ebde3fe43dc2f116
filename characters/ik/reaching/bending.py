"""One hand on its way: passive collarbone, pointing, and hands that face as they are asked to."""

import math
from typing import NamedTuple

from cubeling.characters.ik.reaching.arms import (
    Arm,
    BentArm,
    Effector,
    bend,
    bend_to_wrist,
    effector_of,
    from_axes,
    scale_vector,
    to_vector,
)
from cubeling.characters.ik.reaching.swivel import (
    SWIVEL_DEG,
    OwnElbow,
    natural_elbow,
    swivel_of,
)
from cubeling.characters.ik.reaching.targets import HandTarget
from cubeling.characters.skeleton.scalar_quaternions import (
    IDENTITY,
    Quaternion,
    Vector,
    add,
    between,
    conjugate,
    cross,
    dot,
    from_rotation_vector,
    length,
    multiply,
    normalize,
    rotate,
    subtract,
    to_rotation_vector,
)
from cubeling.characters.smoothing import smoothstep

POINT_EXTENSION = 0.97
"""Extension of an arm that points to what is far ÷ its length."""

MAX_WRIST_RAD = math.radians(65.0)
"""How far a wrist bends."""

MAX_FOREARM_TWIST_RAD = math.radians(110.0)
"""How far forearm and upper arm turn the hand about the forearm's length."""

SHOULDER_STRAIN, SHOULDER_POWER = 0.20, 0.22
"""Part of the angle to a place that a collarbone makes for a straight arm, and at full power."""

MAX_SHOULDER_RAD = math.radians(25.0)
"""How far a collarbone turns."""

SHOULDER_DROP = 0.25
"""Part of its way down that it follows a hand that goes down."""


AT_PLACE = 1e-6
"""Distance from its place at which a wrist is there, in lengths of the forearm: it is rounded."""

_POINTING_ROUNDS = 2


class HandOnItsWay(NamedTuple):
    """A hand that reaches, before the torso moves."""

    arm: Arm

    target: HandTarget
    """Where it is to be."""

    effector: Effector
    """What of it is to be there."""

    place: Vector
    """Where that is [m]."""

    shoulder: Vector
    """Where the upper arm begins, after the collarbone has moved [m]."""

    swung: Quaternion
    """How the collarbone has moved."""

    own: OwnElbow | None = None
    """What its elbow keeps of the pose."""


def passive_shoulder(
    base: Vector, shoulder: Vector, place: Vector, full: float, power: float
) -> Quaternion:
    """Return how a collarbone follows a hand: the further for more strain, and for more power.

    Huang's (2013, section 8.6) springs pull the shoulder along by the force energy of the arm; here
    the energy is the strain of the arm and the power of the movement.

    Parameters
    ----------
    base
        Where the collarbone begins [m].
    full
        Length of the arm [m].
    """
    bone = subtract(shoulder, base)
    x, y, z = subtract(place, base)
    aim = (x, SHOULDER_DROP * y if y < 0.0 else y, z)
    axis = cross(bone, aim)
    size = length(axis)
    if size < 1e-12:
        return IDENTITY
    strain = (length(subtract(place, shoulder)) / full - 0.6) / 0.6
    strain = smoothstep(min(max(strain, 0.0), 1.0))
    share = SHOULDER_STRAIN * strain + SHOULDER_POWER * power * (0.25 + 0.75 * strain)
    angle = share * math.atan2(size, dot(bone, aim))
    scale = MAX_SHOULDER_RAD * math.tanh(angle / MAX_SHOULDER_RAD) / size
    return from_rotation_vector((axis[0] * scale, axis[1] * scale, axis[2] * scale))


def point_finger(hand: HandOnItsWay, shoulder: Vector, chest: Quaternion) -> BentArm:
    """Return an arm whose finger is on the line to a place, or touches it if it is near."""
    arm, effector = hand.arm, hand.effector
    aim = subtract(hand.place, shoulder)
    far = length(aim)
    scale = min(1.0, POINT_EXTENSION * (arm.upper + effector.fore) / max(far, 1e-9))
    tip = add(shoulder, (aim[0] * scale, aim[1] * scale, aim[2] * scale))
    elbow = natural_elbow(arm, shoulder, tip, chest, hand.own)
    bent = bend(arm, effector, shoulder, tip, chest, elbow)
    turn, back = bent.hand, conjugate(arm.rest_turns[1])
    if effector.finger is None:
        return bent
    for _ in range(_POINTING_ROUNDS):
        moved = multiply(turn, back)
        knuckle = add(bent.wrist, rotate(moved, effector.finger[0]))
        along = rotate(moved, effector.finger[1])
        turn = multiply(between(along, subtract(hand.place, knuckle)), turn)
    return bent._replace(hand=turn)


def orient_hand(
    hand: HandOnItsWay, wrist: Effector, shoulder: Vector, chest: Quaternion
) -> BentArm:
    """Return an arm whose hand faces where it is asked to, as far as wrist and forearm turn.

    What reaches is at its place all the same.
    """
    arm, offset = hand.arm, hand.effector.offset
    back = conjugate(arm.rest_turns[1])
    elbow = natural_elbow(arm, shoulder, hand.place, chest, hand.own)
    natural = bend(arm, hand.effector, shoulder, hand.place, chest, elbow)
    turn = _facing_rotation(hand, natural.hand)
    place = subtract(hand.place, rotate(multiply(turn, back), offset))
    bent = bend(arm, wrist, shoulder, place, chest, elbow)
    wanted = multiply(turn, conjugate(bent.hand))
    allowed = _limit_turn(arm, bent, wanted)
    short = length(subtract(bent.wrist, place))
    if allowed is wanted and short < AT_PLACE * arm.fore:
        return bent._replace(hand=turn)
    # The hand turns as far as it can; then it is brought to its place as it is.
    turn = multiply(allowed, bent.hand)
    from_rest = multiply(bent.lower, conjugate(arm.rest_turns[0]))
    moved = rotate(conjugate(from_rest), rotate(multiply(turn, back), offset))
    again = effector_of(arm, add(arm.wrist, moved))
    held = bend(arm, again, shoulder, hand.place, chest, elbow)
    follows = multiply(held.lower, conjugate(bent.lower))
    return held._replace(hand=multiply(follows, turn))


class Bearer(NamedTuple):
    """What bears an arm after a turn of the torso."""

    shoulder: Vector
    """Where the upper arm begins [m]."""

    chest: Quaternion
    """Rotation of the chest from its rest."""


def open_elbow(
    arm: Arm, wrist: Effector, bent: BentArm, before: Bearer, after: Bearer, openness: float
) -> BentArm:
    """Return an arm with its elbow swivelled by openness, from where it is at an openness of ½.

    The wrist and the hand stay as they are, though the torso turns as well.
    """
    neutral = swivel_of(arm, before.shoulder, bent.elbow, bent.wrist, before.chest)
    closed, open_ = (math.radians(limit) for limit in SWIVEL_DEG)
    share = 2.0 * openness - 1.0
    swivel = neutral + share * (neutral - closed if share < 0.0 else open_ - neutral)
    old = bend_to_wrist(arm, wrist, before.shoulder, bent, before.chest, neutral)
    new = bend_to_wrist(arm, wrist, after.shoulder, bent, after.chest, swivel)
    # Bones keep how they were turned about their length.
    upper = multiply(multiply(new.upper, conjugate(old.upper)), bent.upper)
    lower = multiply(multiply(new.lower, conjugate(old.lower)), bent.lower)
    return new._replace(upper=upper, lower=lower)


def twist_forearm(arm: Arm, bent: BentArm) -> BentArm:
    """Return an arm whose forearm takes half of the hand's turn about its length."""
    natural = natural_hand(arm, bent)
    turn = multiply(bent.hand, conjugate(natural))
    if arm.rigid:
        twist, _ = _twist_and_swing(turn, _forearm(arm, bent))
        return bent._replace(lower=multiply(twist, bent.lower), hand=multiply(twist, natural))
    if turn[3] * turn[3] > 1.0 - 1e-9:
        return bent
    axis = _forearm(arm, bent)
    twist, _ = _twist_and_swing(turn, axis)
    half = normalize((twist[0], twist[1], twist[2], twist[3] + 1.0))
    return bent._replace(lower=multiply(half, bent.lower))


def natural_hand(arm: Arm, bent: BentArm) -> Quaternion:
    """Return the rotation of a hand whose wrist is as at rest."""
    return multiply(multiply(bent.lower, conjugate(arm.rest_turns[0])), arm.rest_turns[1])


def _facing_rotation(hand: HandOnItsWay, turn: Quaternion) -> Quaternion:
    """Return the rotation of a hand that faces where it is asked to; `turn` as it comes."""
    arm, target = hand.arm, hand.target
    along, _, palm = (to_vector(axis) for axis in arm.hand.axes)
    rest = arm.rest_turns[1]
    moved = multiply(turn, conjugate(rest))
    if target.palm is not None and target.fingers is not None:
        pair = _perpendicular(to_vector(target.fingers), to_vector(target.palm))
        if pair is not None:
            at_rest = from_axes(along, palm)
            return multiply(multiply(from_axes(*pair), conjugate(at_rest)), rest)
    asked, axis = (target.fingers, along) if target.palm is None else (target.palm, palm)
    return turn if asked is None else multiply(between(rotate(moved, axis), to_vector(asked)), turn)


def _limit_turn(arm: Arm, bent: BentArm, turn: Quaternion) -> Quaternion:
    """Return a turn of a hand from its natural rotation within what wrist and forearm allow."""
    axis = _forearm(arm, bent)
    twist, swing = _twist_and_swing(turn, axis)
    twisted_by, swung_by = to_rotation_vector(twist), to_rotation_vector(swing)
    most = 0.0 if arm.rigid else MAX_WRIST_RAD
    over_twist = length(twisted_by) / MAX_FOREARM_TWIST_RAD
    over_swing = length(swung_by) / max(most, 1e-9)
    if over_twist <= 1.0 and over_swing <= 1.0:
        return turn
    swing = from_rotation_vector(scale_vector(swung_by, 1.0 / max(over_swing, 1.0)))
    return multiply(
        swing, from_rotation_vector(scale_vector(twisted_by, 1.0 / max(over_twist, 1.0)))
    )


def _twist_and_swing(turn: Quaternion, axis: Vector) -> tuple[Quaternion, Quaternion]:
    """Return a rotation as a twist about an axis, and the swing that follows it."""
    along = turn[0] * axis[0] + turn[1] * axis[1] + turn[2] * axis[2]
    size = math.hypot(along, turn[3])
    if size < 1e-9:
        return IDENTITY, turn
    sign = math.copysign(1.0, turn[3]) / size
    along, w = along * sign, turn[3] * sign
    twist = (axis[0] * along, axis[1] * along, axis[2] * along, w)
    return twist, multiply(turn, conjugate(twist))


def _forearm(arm: Arm, bent: BentArm) -> Vector:
    """Return the direction of a forearm."""
    moved = multiply(bent.lower, conjugate(arm.rest_turns[0]))
    return rotate(moved, scale_vector(subtract(arm.wrist, arm.elbow), 1.0 / arm.fore))


def _perpendicular(along: Vector, palm: Vector) -> tuple[Vector, Vector] | None:
    """Return two directions as perpendicular unit vectors; None if they are parallel, or zero."""
    size = length(along)
    if size < 1e-9:
        return None
    first = scale_vector(along, 1.0 / size)
    second = subtract(palm, scale_vector(first, dot(first, palm)))
    size = length(second)
    return None if size < 1e-6 else (first, scale_vector(second, 1.0 / size))
