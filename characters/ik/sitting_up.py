"""Sitting up: a four-legged body that raises its trunk, so that its front legs are free as arms."""

import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from cubeling.characters.ik.legs import LegFrames, LegIK, find_paws
from cubeling.characters.skeleton.anatomy import Anatomy
from cubeling.characters.skeleton.masks import subtree
from cubeling.characters.skeleton.pose import Array, Pose, Skeleton
from cubeling.characters.skeleton.scalar_quaternions import (
    Quaternion,
    Vector,
    add,
    conjugate,
    from_rotation_vector,
    multiply,
    rotate,
    subtract,
)

PITCH_RAD = math.radians(62.0)
"""Angle by which the hips turn up [rad]."""

HEAD_SHARE = 0.95
"""Part of that angle by which neck and head turn down again: the head stays upright."""

TAIL_SHARE = 1.0
"""Part of it by which the tail turns down again: it lies on the ground."""

TAIL_JOINTS = 1
"""Joints of the tail that turn."""

DROP, BACK = 0.2, 0.2
"""How far the hips sink and move back, in parts of the hind legs' height."""


@dataclass(frozen=True, eq=False)
class SittingUp:
    """What a four-legged skeleton turns when it sits up."""

    skeleton: Skeleton
    """The whole skeleton, of which it turns the trunk."""

    hind: LegIK
    """The hind legs; their paws stay where they are."""

    hips: int
    """The joint that carries trunk and hind legs."""

    neck: tuple[int, ...]
    """The joints of neck and head, from the trunk up."""

    tail: tuple[int, ...]
    """The first joints of the tail."""

    axes: Array
    """The direction to the left at rest, in the frames of neck and tail, (n, 3)."""

    @staticmethod
    def of(skeleton: Skeleton, anatomy: Anatomy) -> "SittingUp | None":
        """Return what a body turns; None if it has not four legs."""
        legs = find_paws(skeleton, anatomy)
        hips = anatomy.joint("hips")
        if legs is None or hips is None:
            return None
        thighs = {anatomy.joint("leftUpperLeg"), anatomy.joint("rightUpperLeg")}
        rows = [
            row for row in range(legs.count) if int(legs.indices[legs.joints[row, 1]]) in thighs
        ]
        neck = _from_neck_to_head(skeleton, anatomy)
        tail = tuple(
            joint
            for number in range(1, TAIL_JOINTS + 1)
            if (joint := anatomy.joint(f"tail{number}")) is not None
        )
        turns = skeleton.rest.globals(skeleton)[[*neck, *tail], :3, :3]
        lengths = np.linalg.norm(turns, axis=1, keepdims=True)
        left = (turns / np.where(lengths > 0, lengths, 1.0))[:, 0, :]
        return SittingUp(skeleton, replace(legs, joints=legs.joints[rows]), hips, neck, tail, left)

    def sit_up(self, pose: Pose, share: float) -> Pose:
        """Return a pose with its trunk raised, 0…1; the hind paws stay where they are."""
        if share <= 0.0:
            return pose
        pitch = share * PITCH_RAD
        up = from_rotation_vector((-pitch, 0.0, 0.0))
        frames = self.hind.frames(pose)
        paws = [frames.positions[paw] for *_, paw, _ in self._legs]
        raised = self._raise(frames, up, math.sin(pitch))
        shown = self._with_hips(pose, raised)
        self._turn(shown.rotations, self.neck, 0, pitch * HEAD_SHARE)
        self._turn(shown.rotations, self.tail, len(self.neck), pitch * TAIL_SHARE)
        level = [conjugate(up)] * len(paws)
        return self.hind.bend(shown, raised, paws, level)

    def _raise(self, frames: LegFrames, up: Quaternion, sine: float) -> LegFrames:
        """Return frames with the hips, and all they carry, turned about the thighs' middle."""
        (xs, ys, zs) = zip(*(frames.positions[thigh] for _, thigh, *_ in self._legs), strict=True)
        count = len(xs)
        middle: Vector = (sum(xs) / count, sum(ys) / count, sum(zs) / count)
        sunk = add(middle, (0.0, -DROP * sine * middle[1], -BACK * sine * middle[1]))
        turns, places = list(frames.rotations), list(frames.positions)
        for joint in self._carried:
            turns[joint] = multiply(up, turns[joint])
            places[joint] = add(rotate(up, subtract(places[joint], middle)), sunk)
        return LegFrames(turns, places)

    def _with_hips(self, pose: Pose, frames: LegFrames) -> Pose:
        """Return a pose with its hips as in some frames."""
        own = self._carried[0]
        above = self.hind.skeleton.parents[own]
        turn, place = frames.rotations[own], frames.positions[own]
        if above >= 0:
            back = conjugate(frames.rotations[above])
            turn = multiply(back, turn)
            place = rotate(back, subtract(place, frames.positions[above]))
        turns, places = pose.rotations.copy(), pose.translations.copy()
        turns[self.hips], places[self.hips] = turn, place
        return replace(pose, rotations=turns, translations=places)

    @cached_property
    def _legs(self) -> list[list[int]]:
        legs: list[list[int]] = self.hind.joints.tolist()
        return legs

    @cached_property
    def _carried(self) -> list[int]:
        """Numbers among the legs' joints of the hips and all below them, the hips first."""
        part = self.hind.skeleton
        return subtree(part, self.hind.indices.tolist().index(self.hips))

    def _turn(self, turns: Array, joints: tuple[int, ...], first: int, angle: float) -> None:
        """Turn joints down, each by its part of an angle [rad]."""
        for number, joint in enumerate(joints, first):
            x, y, z = (self.axes[number] * (angle / len(joints))).tolist()
            bent: Vector = (x, y, z)
            turns[joint] = multiply(turns[joint].tolist(), from_rotation_vector(bent))


def _from_neck_to_head(skeleton: Skeleton, anatomy: Anatomy) -> tuple[int, ...]:
    """Return the joints from the neck up to the head; the head alone without a neck."""
    neck, head = anatomy.joint("neck"), anatomy.joint("head")
    if head is None:
        return ()
    above = [head]
    while neck is not None and above[-1] != neck and skeleton.parents[above[-1]] >= 0:
        above.append(skeleton.parents[above[-1]])
    return tuple(reversed(above)) if neck in above else (head,)
