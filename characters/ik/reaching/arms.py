"""One arm from the collarbone to the fingers: its bones at rest, and how it is bent to a place.

The upper arm and the forearm are turned by frames of two directions each (Huang 2013, section
7.3.1): along the bone, and the hinge of the elbow, which is known for a straight arm as well.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from cubeling.characters.ik.reaching.hands import HandJoints, part_names
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.anatomy import Anatomy
from cubeling.characters.skeleton.joint_chains import chains_to_root
from cubeling.characters.skeleton.pose import Array, Skeleton
from cubeling.characters.skeleton.scalar_quaternions import (
    Quaternion,
    Vector,
    add,
    between,
    conjugate,
    cross,
    dot,
    length,
    multiply,
    rotate,
    subtract,
)

NATURAL_SWIVEL_DEG: Vector = (16.0, 31.0, 8.0)
"""Swivel of an elbow that is not asked for [degrees]: at the shoulder, and for each arm length that
the wrist is higher, and further ahead. Fitted to seven recorded people; a term for the wrist to the
side is none (`python -m tests.bench.ik`)."""

PAW_SWIVEL_DEG: Vector = (25.0, 0.0, 0.0)
"""The same of a front leg."""

MAX_ELBOW_BEND_RAD = math.radians(150.0)
"""How far an elbow bends."""

CONE_RAD = math.radians(115.0)
"""How far a hand may be, seen from the shoulder, from the middle of what it reaches."""

CONE_AXIS: Vector = (0.45, -0.25, 0.85)
"""That middle for a left hand, in the axes of the chest: outward, down and ahead."""

SOFT_LACK, STRAIGHT_LACK = 0.024, 0.001
"""What an arm lacks to its full length, as a part of it, from which on its elbow straightens no
faster than there: it would snap in the last of the way, by 14° a centimetre and more. A hand at
full stretch is 5 mm of a person's arm short of its place. The second is of an arm that may snap."""

EASING_BEND = 0.8
"""Bend of an elbow, ÷ that at `SOFT_LACK`, from which on it straightens ever more slowly."""

_AHEAD: Vector = (-0.15, -0.35, 0.85)
_ELBOW_AHEAD: Vector = (0.0, -0.9, -0.4)


@dataclass(frozen=True)
class Arm:
    """The bones of one arm in the rest pose of its skeleton; vectors are in the character frame."""

    hand: HandJoints
    """Its hand, with its side."""

    sign: float
    """1 for a left arm, −1 for a right one: the sign of outward x."""

    joints: tuple[int, int, int, int]
    """Shoulder, upper arm, lower arm and hand; the shoulder is −1 if there is none."""

    carrier: int
    """The joint that carries the arm."""

    upper: float
    """From the shoulder to the elbow [m]."""

    fore: float
    """From the elbow to the wrist [m]."""

    upper_from_frame: Quaternion
    """Rotation at rest of the upper arm, from the frame of its bone and the elbow's hinge."""

    between_bones: Quaternion
    """Rotation at rest of the joint above the lower arm, from the upper arm."""

    between_fore: Quaternion
    """Rotation at rest of the joint above the hand, from the lower arm."""

    hinge: Vector
    """The hinge of the elbow at rest, roughly: bending turns about it."""

    elbow: Vector
    """The elbow at rest [m]."""

    wrist: Vector
    """The wrist at rest [m]."""

    rest_turns: tuple[Quaternion, Quaternion]
    """Rotations at rest of the lower arm and the hand."""

    natural_swivel: Vector
    """As `NATURAL_SWIVEL_DEG` [rad]."""

    rigid: bool
    """Whether the fingers do not hang at the hand's joint alone: the wrist stays as at rest."""


@dataclass(frozen=True)
class Effector:
    """What is brought to a place: a point that is rigid with a forearm whose wrist is at rest."""

    offset: Vector
    """From the wrist at rest, in the character frame [m]."""

    fore: float
    """From the elbow to the point [m]."""

    fore_from_frame: Quaternion
    """Rotation at rest of the lower arm, from the frame of elbow to point and the hinge."""

    finger: tuple[Vector, Vector] | None = None
    """Knuckle of the finger that points from the wrist at rest, and its tip from there [m]."""


class BentArm(NamedTuple):
    """An arm that reaches somewhere; rotations are `character_from_joint`."""

    upper: Quaternion
    """Of the upper arm."""

    lower: Quaternion
    """Of the lower arm."""

    hand: Quaternion
    """Rotation of the hand, `character_from_joint`."""

    wrist: Vector
    """Where the wrist is [m]."""

    elbow: Vector
    """Where the elbow is [m]."""


def find_arm(skeleton: Skeleton, anatomy: Anatomy, hand: HandJoints) -> Arm | None:
    """Return the arm of a hand; None if a bone of it has no length."""
    parts = [anatomy.joint(part) for part in part_names(hand.side, anatomy)]
    shoulder, upper, lower, wrist = (-1 if joint is None else joint for joint in parts)
    placed = skeleton.rest.globals(skeleton)
    places, turns = placed[:, :3, 3], turns_of(placed[:, :3, :3])
    bone, forearm = places[lower] - places[upper], places[wrist] - places[lower]
    long, short = float(np.linalg.norm(bone)), float(np.linalg.norm(forearm))
    if min(long, short) < 1e-6:
        return None
    flexed = np.array([0.0, 0.0, 1.0]) if abs(bone[2]) < 0.9 * long else np.array([0.0, 1.0, 0.0])
    hinge = to_vector(np.cross(bone, flexed))
    above, chains = skeleton.parents[lower], chains_to_root(skeleton.parents)
    first = upper if shoulder < 0 else shoulder
    return Arm(
        hand,
        1.0 if hand.side == "left" else -1.0,
        (shoulder, upper, lower, wrist),
        skeleton.parents[first],
        long,
        short,
        _from_frame(to_vector(bone), hinge, to_quaternion(turns[upper])),
        multiply(conjugate(to_quaternion(turns[upper])), to_quaternion(turns[above])),
        multiply(
            conjugate(to_quaternion(turns[lower])), to_quaternion(turns[skeleton.parents[wrist]])
        ),
        hinge,
        to_vector(places[lower]),
        to_vector(places[wrist]),
        (to_quaternion(turns[lower]), to_quaternion(turns[wrist])),
        scale_vector(
            PAW_SWIVEL_DEG if anatomy.kind == "quadruped" else NATURAL_SWIVEL_DEG, math.pi / 180.0
        ),
        any(wrist not in chains[joints[0]] for joints in hand.fingers.values()),
    )


def effector_of(
    arm: Arm, place: Vector, knuckle: Vector | None = None, pronation: float = 0.0
) -> Effector:
    """Return a point of a hand in the rest pose [m] as what is brought to a place.

    The forearm is turned about the line from the elbow to it by `pronation` [rad].
    """
    along = subtract(place, arm.elbow)
    half = 0.5 * arm.sign * pronation
    frame = multiply(
        (math.sin(half), 0.0, 0.0, math.cos(half)),
        _from_frame(along, arm.hinge, arm.rest_turns[0]),
    )
    finger = None if knuckle is None else (subtract(knuckle, arm.wrist), subtract(place, knuckle))
    return Effector(subtract(place, arm.wrist), length(along), frame, finger)


def clamped_aim(aim: Vector, chest: Quaternion, sign: float) -> Vector:
    """Return the direction of a hand from its shoulder, kept in what the shoulder reaches."""
    axis = cone_axis(chest, sign)
    size = max(length(aim), 1e-9)
    cosine = dot(aim, axis) / size
    if cosine >= _CONE_COSINE:
        return aim
    x, y, z = subtract(aim, scale_vector(axis, cosine * size))
    aside = math.sqrt(x * x + y * y + z * z)
    if aside < 1e-6 * size:  # straight behind: the hand is held low
        x, y, z = rotate(chest, (0.0, -0.85, -0.25))
        aside = math.sqrt(x * x + y * y + z * z)
    scale = size * _CONE_SINE / aside
    return add(scale_vector(axis, size * _CONE_COSINE), (x * scale, y * scale, z * scale))


def cone_axis(chest: Quaternion, sign: float) -> Vector:
    """Return the middle of what a hand reaches, of unit length, for the turn of the chest."""
    return rotate(chest, _CONE_AXES[sign])


class Elbow(NamedTuple):
    """How an elbow is to be."""

    swivel: float
    """About the line from the shoulder to the place [rad]."""

    soft: float = STRAIGHT_LACK
    """As `SOFT_LACK`."""


def bend(
    arm: Arm, effector: Effector, shoulder: Vector, target: Vector, chest: Quaternion, elbow: Elbow
) -> BentArm:
    """Return an arm that brings a point of its hand to a place, or as near as it gets.

    The law of cosines bends the elbow; it is swivelled about the line from the shoulder to the
    place (Tolani, Goswami & Badler 2000, section 4). The wrist stays as at rest.

    Parameters
    ----------
    chest
        Rotation of the chest from its rest.
    """
    aim, distance = aim_at(subtract(target, shoulder), arm, effector.fore, chest, elbow.soft)
    along, hinge, forearm = _bones(arm, effector.fore, aim, distance, chest, elbow.swivel)
    upper = multiply(from_axes(along, hinge), arm.upper_from_frame)
    turn = multiply(from_axes(forearm, hinge), effector.fore_from_frame)
    moved = multiply(turn, conjugate(arm.rest_turns[0]))
    place = add(shoulder, scale_vector(aim, distance))
    wrist = subtract(place, rotate(moved, effector.offset))
    hinge_at = add(shoulder, scale_vector(along, arm.upper))
    return BentArm(upper, turn, multiply(moved, arm.rest_turns[1]), wrist, hinge_at)


def bend_to_wrist(
    arm: Arm, wrist: Effector, shoulder: Vector, bent: BentArm, chest: Quaternion, swivel: float
) -> BentArm:
    """Return an arm whose wrist and hand stay where they are while its elbow is swivelled."""
    moved = bend(arm, wrist, shoulder, bent.wrist, chest, Elbow(swivel))
    return BentArm(moved.upper, moved.lower, bent.hand, moved.wrist, moved.elbow)


def from_axes(along: Vector, hinge: Vector) -> Quaternion:
    """Return the rotation whose first two columns are two perpendicular unit vectors.

    Shepperd, "Quaternion from rotation matrix", 1978.
    """
    ax, ay, az = along
    bx, by, bz = hinge
    cx, cy, cz = ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx
    trace = ax + by + cz
    if trace > 0.0:
        s = 2.0 * math.sqrt(trace + 1.0)
        return (bz - cy) / s, (cx - az) / s, (ay - bx) / s, 0.25 * s
    if ax >= by and ax >= cz:
        s = 2.0 * math.sqrt(1.0 + ax - by - cz)
        return 0.25 * s, (bx + ay) / s, (cx + az) / s, (bz - cy) / s
    if by >= cz:
        s = 2.0 * math.sqrt(1.0 + by - ax - cz)
        return (bx + ay) / s, 0.25 * s, (cy + bz) / s, (cx - az) / s
    s = 2.0 * math.sqrt(1.0 + cz - ax - by)
    return (cx + az) / s, (cy + bz) / s, 0.25 * s, (ay - bx) / s


def turns_of(matrices: Array) -> Array:
    """Return the rotations of matrices with scales, (joints, 3, 3), as quaternions (joints, 4)."""
    sizes = np.linalg.norm(matrices, axis=1, keepdims=True)
    return rotations.from_matrix(matrices / np.where(sizes > 0.0, sizes, 1.0))


def aim_at(
    aim: Vector, arm: Arm, fore: float, chest: Quaternion, soft: float
) -> tuple[Vector, float]:
    """Return the unit direction to a place and the distance that the arm takes of it [m]."""
    x, y, z = clamped_aim(aim, chest, arm.sign)
    distance = math.sqrt(x * x + y * y + z * z)
    if distance < 1e-6:
        (x, y, z), distance = cone_axis(chest, arm.sign), 1.0
    upper, bent, full = arm.upper, math.cos(MAX_ELBOW_BEND_RAD), arm.upper + fore
    nearest = math.sqrt(upper * upper + fore * fore + 2.0 * upper * fore * bent)
    taken = _soft_extension(max(distance, nearest) / full, soft) * full
    return (x / distance, y / distance, z / distance), taken


def _soft_extension(extension: float, soft: float) -> float:
    """Return how far an arm stretches for a place, both ÷ its length.

    The bend of an elbow is as the root of what the arm lacks; it goes on along its tangent, then
    along a hyperbola, so that what is far is pointed at with a straight arm.
    """
    if extension <= 1.0 - soft:
        return extension
    bend = 1.0 - 0.5 * (extension - 1.0 + soft) / soft
    if bend < EASING_BEND:
        bend = EASING_BEND * EASING_BEND / (2.0 * EASING_BEND - bend)
    return 1.0 - soft * bend * bend


def _bones(
    arm: Arm, fore: float, aim: Vector, distance: float, chest: Quaternion, swivel: float
) -> tuple[Vector, Vector, Vector]:
    """Return the directions of the upper arm, of the elbow's hinge and of the forearm."""
    upper = arm.upper
    cosine = (upper * upper + distance * distance - fore * fore) / (2.0 * upper * distance)
    cosine = min(max(cosine, -1.0), 1.0)
    sine = math.sqrt(1.0 - cosine * cosine)
    (ux, uy, uz), (vx, vy, vz) = swivel_axes(arm, aim, chest)
    c, s = math.cos(swivel), math.sin(swivel)
    ex, ey, ez = c * ux + s * vx, c * uy + s * vy, c * uz + s * vz
    nx, ny, nz = aim
    along = (nx * cosine + ex * sine, ny * cosine + ey * sine, nz * cosine + ez * sine)
    forearm = (
        (distance * nx - upper * along[0]) / fore,
        (distance * ny - upper * along[1]) / fore,
        (distance * nz - upper * along[2]) / fore,
    )
    size = length(forearm)
    forearm = (forearm[0] / size, forearm[1] / size, forearm[2] / size)
    return along, cross((ex, ey, ez), aim), forearm


def swivel_axes(arm: Arm, aim: Vector, chest: Quaternion) -> tuple[Vector, Vector]:
    """Return where an elbow hangs without swivel, and where it is swivelled to."""
    ahead, elbow = _POLES[arm.sign]
    hanging = rotate(between(ahead, rotate(conjugate(chest), aim)), elbow)
    down = rotate(chest, hanging)
    x, y, z = cross(aim, down)
    return down, (arm.sign * x, arm.sign * y, arm.sign * z)


def _from_frame(along: Vector, hinge: Vector, turn: Quaternion) -> Quaternion:
    """Return the rotation of a joint from the frame of a direction and a hinge at rest."""
    size = length(along)
    first = scale_vector(along, 1.0 / size)
    second = subtract(hinge, scale_vector(first, dot(hinge, first)))
    second = scale_vector(second, 1.0 / max(length(second), 1e-9))
    return multiply(conjugate(from_axes(first, second)), turn)


def scale_vector(vector: Vector, scale: float) -> Vector:
    """Return a vector times a number."""
    return vector[0] * scale, vector[1] * scale, vector[2] * scale


def to_vector(values: Sequence[float] | Array) -> Vector:
    """Return three numbers as a vector."""
    x, y, z = values
    return float(x), float(y), float(z)


def to_quaternion(values: Array) -> Quaternion:
    """Return one rotation as a tuple."""
    x, y, z, w = values.tolist()
    return x, y, z, w


def _unit(vector: Vector) -> Vector:
    return scale_vector(vector, 1.0 / length(vector))


def _perpendicular(vector: Vector, axis: Vector) -> Vector:
    return _unit(subtract(vector, scale_vector(axis, dot(vector, axis))))


def _mirror(vector: Vector, sign: float) -> Vector:
    return sign * vector[0], vector[1], vector[2]


_CONE_COSINE, _CONE_SINE = math.cos(CONE_RAD), math.sin(CONE_RAD)
_CONE_AXES: Mapping[float, Vector] = {sign: _unit(_mirror(CONE_AXIS, sign)) for sign in (1.0, -1.0)}
_POLES: Mapping[float, tuple[Vector, Vector]] = {
    sign: (
        _unit(_mirror(_AHEAD, sign)),
        _perpendicular(_ELBOW_AHEAD, _unit(_mirror(_AHEAD, sign))),
    )
    for sign in (1.0, -1.0)
}
"""A direction of the hand, and where the elbow then is, in the axes of the chest."""
