"""The hands of a skeleton: their joints, where they face at rest, and what may touch things.

Front paws are the hands of a body on four legs: their toes are the fingers, their soles the palms.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from cubeling.characters.skeleton.anatomy import Anatomy
from cubeling.characters.skeleton.joint_chains import children_of
from cubeling.characters.skeleton.pose import Array, Skeleton

FINGERS = ("Thumb", "Index", "Middle", "Ring", "Little")
"""Names of the fingers, as in `Anatomy`."""

ARM_PARTS = ("Shoulder", "UpperArm", "LowerArm", "Hand")
"""An arm; the shoulder may be missing."""

FRONT_LEG_PARTS = ("FrontShoulder", "FrontUpperLeg", "FrontLowerLeg", "FrontFoot")
"""The front leg of a body on four legs, in the same order."""

HAND_SHARE = 0.55
"""Length of a hand without fingers ÷ that of the forearm."""

PALM_SHARE = 0.75
"""Where the palm's middle is between the wrist and the knuckles."""

TIP_SHARE = 0.8
"""Length of a last phalanx that ends nowhere ÷ that of the one before."""

_SEGMENTS = ("Metacarpal", "Proximal", "Intermediate", "Distal")


@dataclass(frozen=True)
class HandJoints:
    """One hand of a skeleton in its rest pose; vectors are in the character frame."""

    side: str
    """ "left" or "right", as in `SIDES`."""

    joint: int
    """The wrist, or the ankle of a paw."""

    fingers: Mapping[str, tuple[int, ...]]
    """Joints of each finger from the knuckle on, by name; a paw has none."""

    axes: Array
    """Rows: where the fingers point, the side of the thumb, where the palm faces, (3, 3)."""

    palm: Array
    """The middle of the palm, (3,) [m]."""

    length: float
    """From the wrist to the tips of straight fingers [m]."""


def part_names(side: str, anatomy: Anatomy) -> tuple[str, ...]:
    """Return the names of shoulder, upper arm, lower arm and hand in an anatomy."""
    parts = FRONT_LEG_PARTS if anatomy.kind == "quadruped" else ARM_PARTS
    return tuple(side + part for part in parts)


def find_hand(skeleton: Skeleton, anatomy: Anatomy, side: str) -> HandJoints | None:
    """Return a hand or front paw of a skeleton; None if it or its arm is missing."""
    _, upper, lower, hand = (anatomy.joint(part) for part in part_names(side, anatomy))
    if upper is None or lower is None or hand is None:
        return None
    places = skeleton.rest.globals(skeleton)[:, :3, 3]
    forearm = places[hand] - places[lower]
    long = float(np.linalg.norm(forearm))
    if anatomy.kind == "quadruped":
        inward = -1.0 if side == "left" else 1.0
        axes = np.array([[0.0, 0.0, 1.0], [inward, 0.0, 0.0], [0.0, -1.0, 0.0]])
        height = max(float(places[hand, 1]), 0.0)
        sole = places[hand] + axes[2] * min(height, long)
        return HandJoints(side, hand, {}, axes, sole, float(np.linalg.norm(sole - places[hand])))
    fingers = _fingers(anatomy, side)
    knuckles = [joints[0] for name, joints in fingers.items() if name != "Thumb"]
    along = forearm / max(long, 1e-9)
    if knuckles:
        middle = places[knuckles].mean(0) - places[hand]
        tips = max(np.linalg.norm(p - places[hand]) for p in finger_points(fingers, skeleton))
        axes = _axes(along + _unit(middle), _across(fingers, places), side)
        return HandJoints(side, hand, fingers, axes, _palm(places[hand], middle, axes), float(tips))
    axes = _axes(along, np.array([0.0, 0.0, 1.0]), side)
    length = HAND_SHARE * long
    palm = _palm(places[hand], 0.5 * length * along, axes)
    return HandJoints(side, hand, fingers, axes, palm, length)


def finger_points(fingers: Mapping[str, tuple[int, ...]], skeleton: Skeleton) -> list[Array]:
    """Return the tips of all fingers in the rest pose, (3,) each [m]."""
    return [fingertip(joints, skeleton) for joints in fingers.values()]


def fingertip(joints: tuple[int, ...], skeleton: Skeleton) -> Array:
    """Return the tip of a finger in the rest pose, (3,) [m]."""
    places = skeleton.rest.globals(skeleton)[:, :3, 3]
    below = children_of(skeleton.parents).get(joints[-1], [])
    if below:
        tip: Array = places[below[0]]
        return tip
    before = joints[-2] if len(joints) > 1 else skeleton.parents[joints[-1]]
    tip = places[joints[-1]] + TIP_SHARE * (places[joints[-1]] - places[before])
    return tip


def _fingers(anatomy: Anatomy, side: str) -> dict[str, tuple[int, ...]]:
    fingers = {}
    for finger in FINGERS:
        names = [f"{side}{finger}{segment}" for segment in _SEGMENTS]
        joints = tuple(anatomy.joints[name] for name in names if name in anatomy.joints)
        if joints:
            fingers[finger] = joints
    return fingers


def _across(fingers: Mapping[str, tuple[int, ...]], places: Array) -> Array:
    """Return the direction over the knuckles to the side of the thumb."""
    row = [joints[0] for name, joints in fingers.items() if name != "Thumb"]
    if len(row) > 1:
        across: Array = places[row[0]] - places[row[-1]]
        return across
    return np.array([0.0, 0.0, 1.0])


def _axes(along: Array, across: Array, side: str) -> Array:
    """Return the axes of a hand by where its fingers point and, roughly, where its thumb is."""
    along = _unit(along)
    across = across - along * float(across @ along)
    if np.linalg.norm(across) < 1e-6:  # of a hand that points ahead: its thumb is up
        across = np.array([0.0, 1.0, 0.0]) - along * along[1]
    across = _unit(across)
    palm = np.cross(along, across) * (1.0 if side == "left" else -1.0)
    return np.stack([along, across, palm])


def _palm(wrist: Array, middle: Array, axes: Array) -> Array:
    """Return the middle of a palm by the way from the wrist to the knuckles."""
    depth = 0.2 * math.sqrt(float(middle @ middle))
    palm: Array = wrist + PALM_SHARE * middle + depth * axes[2]
    return palm


def _unit(vector: Array) -> Array:
    unit: Array = vector / max(float(np.linalg.norm(vector)), 1e-9)
    return unit
