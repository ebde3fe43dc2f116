"""Postures by name: sitting, crouching and leaning with the feet where they are.

Trunk, neck and head turn, the pelvis comes down, and hips and knees bend so that every foot keeps
its place. The angles are ours.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from cubeling.characters.behaviour.intents import PostureIntent
from cubeling.characters.behaviour.realization.planned_values import presence
from cubeling.characters.body.axes import Degrees, body_axes
from cubeling.characters.ik.legs import LegFrames, LegIK, find_legs, find_paws
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.anatomy import Anatomy
from cubeling.characters.skeleton.pose import Array, Pose, Skeleton
from cubeling.characters.skeleton.scalar_quaternions import (
    IDENTITY,
    Quaternion,
    Vector,
    add,
    conjugate,
    from_rotation_vector,
    multiply,
    rotate,
    subtract,
)

GROUPS = (
    ("hips",),
    ("spine", "chest", "upperChest"),
    ("neck", "head"),
    ("leftUpperArm", "rightUpperArm"),
)
"""The parts that turn: pelvis, trunk and head, which share their turn, and arms."""


@dataclass(frozen=True)
class Stance:
    """How a body stands, or sits."""

    down: float = 0.0
    """How far the pelvis comes down, in lengths of the legs."""

    back: float = 0.0
    """How far the pelvis goes back, in lengths of the legs."""

    aside: float = 0.0
    """How far the pelvis goes to the left, in lengths of the legs."""

    hips: Degrees = (0.0, 0.0, 0.0)
    """Turn of the pelvis about the body's axes: x bends forward, y turns to the left, z leans to
    the right."""

    trunk: Degrees = (0.0, 0.0, 0.0)
    """Turn of the trunk above it, shared out among its joints."""

    head: Degrees = (0.0, 0.0, 0.0)
    """Turn of neck and head, shared out."""

    arms: float = 0.0
    """Turn of the upper arms forward [degrees]."""


STANCES = {
    "SITTING": Stance(
        0.86, 0.55, hips=(-14.0, 0.0, 0.0), trunk=(24.0, 0.0, 0.0), head=(-8.0, 0.0, 0.0), arms=42.0
    ),
    "CROUCHING": Stance(
        0.46,
        0.14,
        hips=(22.0, 0.0, 0.0),
        trunk=(16.0, 0.0, 0.0),
        head=(-30.0, 0.0, 0.0),
        arms=45.0,
    ),
    "LEANING_FORWARD": Stance(
        0.02, 0.08, hips=(10.0, 0.0, 0.0), trunk=(14.0, 0.0, 0.0), head=(-16.0, 0.0, 0.0)
    ),
    "LEANING_BACKWARD": Stance(
        0.01, -0.05, hips=(-4.0, 0.0, 0.0), trunk=(-11.0, 0.0, 0.0), head=(11.0, 0.0, 0.0)
    ),
    "LEANING_LEFT": Stance(
        0.02, 0.0, 0.07, hips=(0.0, 0.0, -4.0), trunk=(0.0, 0.0, -9.0), head=(0.0, 0.0, 7.0)
    ),
    "LEANING_RIGHT": Stance(
        0.02, 0.0, -0.07, hips=(0.0, 0.0, 4.0), trunk=(0.0, 0.0, 9.0), head=(0.0, 0.0, -7.0)
    ),
    "BOWING": Stance(
        0.02, 0.12, hips=(22.0, 0.0, 0.0), trunk=(26.0, 0.0, 0.0), head=(14.0, 0.0, 0.0)
    ),
    "SLUMPED": Stance(
        0.03, 0.02, hips=(-3.0, 0.0, 0.0), trunk=(15.0, 0.0, 0.0), head=(14.0, 0.0, 0.0)
    ),
    "ERECT": Stance(0.0, 0.0, trunk=(-7.0, 0.0, 0.0), head=(3.0, 0.0, 0.0)),
}
"""The stances by name; any other name, as STANDING, is how the body stands by itself."""

ON_HIPS, ON_TRUNK = 6, 9
"""Number of the values that legs follow: all hang on the pelvis, or forelegs on the trunk."""

MAX_EXTENSION = 0.985
"""Share of its length up to which a leg is stretched to its foot; then the pelvis comes down."""

_QUADRUPED = {
    "SITTING": Stance(0.52, -0.12, hips=(-24.0, 0.0, 0.0), head=(14.0, 0.0, 0.0)),
    "CROUCHING": Stance(0.34, head=(-8.0, 0.0, 0.0)),
    "BOWING": Stance(0.12, 0.1, hips=(17.0, 0.0, 0.0), head=(-6.0, 0.0, 0.0)),
    "LEANING_FORWARD": Stance(0.06, -0.2, hips=(4.0, 0.0, 0.0), head=(4.0, 0.0, 0.0)),
    "LEANING_BACKWARD": Stance(0.08, 0.22, hips=(-4.0, 0.0, 0.0), head=(-4.0, 0.0, 0.0)),
    "LEANING_LEFT": Stance(0.05, 0.0, 0.14, hips=(0.0, 0.0, -7.0), head=(0.0, 0.0, 6.0)),
    "LEANING_RIGHT": Stance(0.05, 0.0, -0.14, hips=(0.0, 0.0, 7.0), head=(0.0, 0.0, -6.0)),
    "SLUMPED": Stance(0.1, head=(24.0, 0.0, 0.0)),
    "ERECT": Stance(0.0, head=(-9.0, 0.0, 0.0)),
}


class StanceJoints:
    """The joints with which one body takes stances.

    The values of a posture are the shift of the pelvis [legs], (3,), and the turns of pelvis,
    trunk, head and arms [degrees], (3,) each.
    """

    VALUES = 15
    """How many values there are."""

    def __init__(self, skeleton: Skeleton, anatomy: Anatomy) -> None:
        self._legs = find_paws(skeleton, anatomy) or find_legs(skeleton)
        self._stances = STANCES | (_QUADRUPED if anatomy.kind == "quadruped" else {})
        found = [(part, anatomy.joint(part)) for group in GROUPS for part in group]
        parts = {part: joint for part, joint in found if joint is not None}
        if self._legs is not None:
            parts["hips"] = int(self._legs.indices[self._legs.joints[0, 0]])
        self._joints = np.array([*parts.values()], np.intp)
        self._order = skeleton.with_ancestors(self._joints.tolist())
        self._parents = skeleton.parents
        self._shares = np.zeros((len(parts), len(GROUPS)))
        for column, names in enumerate(GROUPS):
            rows = [row for row, part in enumerate(parts) if part in names]
            self._shares[rows, column] = 1.0 if column == 3 else 1.0 / max(len(rows), 1)
        axes = body_axes(skeleton, self._joints)
        # From turns of the parts [degrees] to rotation vectors in the joints' frames, one below
        # the other.
        vectors = np.radians(axes[:, :, None] * self._shares[:, None, :, None])
        self._vectors = vectors.reshape(3 * len(parts), 3 * len(GROUPS))
        self._legs_follow = ON_TRUNK if anatomy.kind == "quadruped" else ON_HIPS
        self._leg_joints: list[list[int]] = [] if self._legs is None else self._legs.joints.tolist()
        # A pelvis that carries all legs takes their hips along as one.
        pelvises = {leg[0] for leg in self._leg_joints}
        self._one_pelvis = self._legs_follow == ON_HIPS and len(pelvises) == 1
        self._leg_length = 0.0 if self._legs is None else _leg_length(self._legs)

    @property
    def able(self) -> bool:
        """Whether the body has any of the joints."""
        return self._joints.size > 0

    def knows(self, name: str) -> bool:
        """Return whether a name is a stance that the body can take."""
        stance = self._stances.get(name)
        return stance is not None and self.able and (self._legs is not None or stance.down < 0.1)

    def values(self, intents: Sequence[PostureIntent], now: float) -> Array:
        """Return the values of postures at a time [s], (15,); a later one replaces the others."""
        shown = np.zeros(self.VALUES)
        for intent in intents:
            there = presence(intent.times, now)
            if there > 0.0:
                shown += (self._of(intent.name) - shown) * there
        return shown

    def _of(self, name: str) -> Array:
        stance = self._stances.get(name, Stance())
        if self._legs is None:
            stance = Stance(trunk=stance.trunk, head=stance.head, arms=stance.arms)
        return self.values_of(stance)

    @staticmethod
    def values_of(stance: Stance) -> Array:
        """Return the values of a stance, (15,)."""
        shift = (stance.aside, -stance.down, -stance.back)
        arms = (-stance.arms, 0.0, 0.0)
        return np.array([*shift, *stance.hips, *stance.trunk, *stance.head, *arms])

    def apply(self, pose: Pose, values: Array, hips: float = 0.0, trunk: float = 0.0) -> Pose:
        """Return a pose that stands by these values, with its feet where they are.

        Pelvis and trunk turn besides to the left, about the vertical [rad].
        """
        turns = rotations.from_rotation_vector((self._vectors @ values[3:]).reshape(-1, 3))
        local = pose.rotations.copy()
        local[self._joints] = rotations.multiply(local.take(self._joints, 0), turns)
        if hips or trunk:
            self._turn(local, hips, trunk)
        turned = pose.with_rotations(local)
        followed = values[: self._legs_follow].tolist()
        if self._legs is None or not (hips or trunk or any(followed)):
            return turned
        return self._plant_feet(pose, turned, values[:3] * self._leg_length)

    def _turn(self, local: Array, hips: float, trunk: float) -> None:
        """Turn pelvis and trunk to the left, in local rotations, about the vertical [rad].

        A turn about the vertical leaves the vertical of the joints above it as it is.
        """
        turns: dict[int, Quaternion] = {-1: IDENTITY}
        for joint in self._order:
            turns[joint] = multiply(turns[self._parents[joint]], local[joint].tolist())
        shares = self._shares[:, :2] @ (hips, trunk)
        for joint, angle in zip(self._joints.tolist(), shares.tolist(), strict=True):
            if angle:
                up = rotate(conjugate(turns[joint]), (0.0, angle, 0.0))
                local[joint] = multiply(local[joint].tolist(), from_rotation_vector(up))

    def _plant_feet(self, pose: Pose, turned: Pose, shift: Array) -> Pose:
        """Return a turned pose with its pelvis shifted [m] and its feet as in the first pose."""
        legs = self._legs
        assert legs is not None
        before = legs.frames(pose)
        pelvis = self._leg_joints[0][0]
        parent, number = legs.skeleton.parents[pelvis], legs.indices[pelvis]
        above = before.rotations[parent] if parent >= 0 else IDENTITY
        x, y, z = shift.tolist()
        hips: list[Vector] = []
        carrier = IDENTITY
        if self._legs_follow == ON_HIPS:
            carrier = multiply(above, turned.rotations[number].tolist())
            turn = multiply(carrier, conjugate(before.rotations[pelvis]))
            hips = self._hips_after(before, turn, (x, y, z))
            drop = self._needed_drop(before, hips)
            y, hips = y - drop, [(hx, hy - drop, hz) for hx, hy, hz in hips]
        moved = turned.translations.copy()
        moved[number] += rotate(conjugate(above), (x, y, z))
        turned = Pose(moved, turned.rotations, turned.scales, turned.morphs)
        if self._one_pelvis:
            return legs.plant(turned, before, hips, [carrier] * len(hips))
        after = legs.frames(turned)
        hips = [after.positions[hip] for _, hip, *_ in self._leg_joints]
        carriers = [after.rotations[above_hip] for above_hip, *_ in self._leg_joints]
        return legs.plant(turned, before, hips, carriers)

    def _hips_after(self, before: LegFrames, turn: Quaternion, shift: Vector) -> list[Vector]:
        """Return where hips are on a pelvis that has turned and been shifted [m]."""
        places = before.positions
        return [
            add(add(places[pelvis], rotate(turn, subtract(places[hip], places[pelvis]))), shift)
            for pelvis, hip, *_ in self._leg_joints
        ]

    def _needed_drop(self, before: LegFrames, hips: Sequence[Vector]) -> float:
        """Return how far hips are to come down so that their legs reach their feet [m].

        A leg that was straighter before may stay so.
        """
        needed = 0.0
        for (_, hip, _, ankle, _), (x, y, z) in zip(self._leg_joints, hips, strict=True):
            fx, fy, fz = foot = before.positions[ankle]
            most = max(MAX_EXTENSION * self._leg_length, math.dist(before.positions[hip], foot))
            squared = most * most - (x - fx) * (x - fx) - (z - fz) * (z - fz)
            needed = max(needed, y - fy - math.sqrt(max(squared, 0.0)))
        return needed


def _leg_length(legs: LegIK) -> float:
    """Return the length of the shortest leg from hip to ankle at rest [m]."""
    bones = np.linalg.norm(legs.skeleton.rest.translations[legs.joints[:, 2:4]], axis=-1)
    return float(bones.sum(axis=1).min())
