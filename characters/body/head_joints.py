"""The joints from the root to the head and the eyes: where they are, and turning them."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from cubeling.characters.skeleton.anatomy import Anatomy
from cubeling.characters.skeleton.pose import Array, Pose, Skeleton
from cubeling.characters.skeleton.rotations import from_matrix
from cubeling.characters.skeleton.scalar_quaternions import (
    IDENTITY,
    Quaternion,
    Vector,
    add,
    conjugate,
    from_rotation_vector,
    make_global,
    multiply,
    rotate,
    subtract,
)

RAISED_RAD, UPRIGHT_RAD = math.radians(28.0), math.radians(58.0)
"""How far the chest of a quadruped is raised in its actions at most, and where it sits up [rad]:
between, its head's turns are more and more measured from the level."""


@dataclass
class HeadJoint:
    """A joint on the way from the root to the head or an eye."""

    number: int
    """Its index in the skeleton."""

    parent: int
    """Index of its parent among these joints; −1 for none."""

    from_rest: Quaternion
    """The inverse of its rotation at rest, in the character frame."""

    turn: Quaternion = IDENTITY
    """Its present rotation, in the character frame."""

    place: Vector = (0.0, 0.0, 0.0)
    """Its present position in the character frame [m]."""

    @property
    def facing(self) -> Quaternion:
        """The body's axes as this joint turns them."""
        return multiply(self.turn, self.from_rest)


class HeadJoints:
    """Neck, head and eyes of one skeleton, and the joints below them.

    Parameters
    ----------
    head
        Number of the head's joint.
    """

    def __init__(self, skeleton: Skeleton, anatomy: Anatomy, head: int) -> None:
        line = _line(head, anatomy.joint("neck"), skeleton)
        eyes = [j for side in ("left", "right") if (j := anatomy.joint(f"{side}Eye")) is not None]
        self._joints = _with_ancestors(skeleton, [*line, *eyes])
        self._parents = [joint.parent for joint in self._joints]
        places = {joint.number: place for place, joint in enumerate(self._joints)}
        self._numbers = np.array([joint.number for joint in self._joints], np.intp)
        self._line = [self._joints[places[joint]] for joint in line]
        self.head = self._line[-1]
        self._four_legs = anatomy.kind == "quadruped"
        self.eyes = [self._joints[places[joint]] for joint in eyes]
        """The left and the right eye; none, one or both."""
        self.eye_offset: Vector = (0.0, 0.0, 0.0)
        """Where the eyes are in the head's frame if they have no joints [m]."""

    @property
    def body(self) -> Quaternion:
        """The rotation of the chest; it is taken as level where a quadruped sits up."""
        base = self._line[0].parent
        facing = self._joints[base].facing if base >= 0 else IDENTITY
        return _level(facing) if self._four_legs else facing

    def place(self, pose: Pose) -> None:
        """Compute the joints' rotations and positions in a pose."""
        turns = pose.rotations.take(self._numbers, 0).tolist()
        shifts = pose.translations.take(self._numbers, 0).tolist()
        if pose.scales is not None:
            # glTF: a parent's scale stretches where its children are, not how far they turn. Shear
            # is neglected: bodies are scaled along their joints' axes, or uniformly.
            scales = pose.scales.take(self._numbers, 0).tolist()
            for number, parent in enumerate(self._parents):
                if parent >= 0:
                    shifts[number], scales[number] = (
                        [a * b for a, b in zip(own, scales[parent], strict=True)]
                        for own in (shifts[number], scales[number])
                    )
        make_global(turns, shifts, self._parents)
        for joint, turn, place in zip(self._joints, turns, shifts, strict=True):
            joint.turn, joint.place = turn, place

    def eye_places(self, turned: Vector) -> list[Vector]:
        """Return where the eyes are once neck and head are turned; without eyes, the head."""
        x, y, z = (value / len(self._line) for value in turned)
        place = self._line[0].place
        for part, (below, above) in enumerate(pairwise(self._line), start=1):
            turn = from_rotation_vector((part * x, part * y, part * z))
            place = add(place, rotate(turn, subtract(above.place, below.place)))
        whole = from_rotation_vector(turned)
        if not self.eyes:
            return [add(place, rotate(whole, rotate(self.head.turn, self.eye_offset)))]
        return [
            add(place, rotate(whole, subtract(eye.place, self.head.place))) for eye in self.eyes
        ]

    def turn_head(self, local: Array, turned: Vector) -> None:
        """Turn neck and head in local rotations, (joints, 4): each joint by an equal part.

        Powers of one rotation commute: the part of each joint is the same vector, in the frame of
        its parent before the turn.
        """
        x, y, z = (value / len(self._line) for value in turned)
        for joint in self._line:
            self.turn(local, joint, (x, y, z))

    def turn(self, local: Array, joint: HeadJoint, turned: Vector) -> None:
        """Turn a joint in local rotations by a rotation vector in the character frame."""
        if joint.parent >= 0:
            turned = rotate(conjugate(self._joints[joint.parent].turn), turned)
        # From the left: the turn is in the parent's frame.
        local[joint.number] = multiply(from_rotation_vector(turned), local[joint.number].tolist())


def _level(chest: Quaternion) -> Quaternion:
    """Return the rotation of a chest that is level where it is as far up as `UPRIGHT_RAD`."""
    _, up, _ = rotate(chest, (0.0, 0.0, 1.0))
    raised = math.asin(min(max(up, -1.0), 1.0))
    if raised <= RAISED_RAD:
        return chest
    share = min((raised - RAISED_RAD) / (UPRIGHT_RAD - RAISED_RAD), 1.0)
    # About +x by a positive angle +z turns down: it takes back what the chest is raised.
    return multiply(chest, from_rotation_vector((raised * share, 0.0, 0.0)))


def middle(places: Sequence[Vector]) -> Vector:
    """Return the middle of some places."""
    x, y, z = (sum(axis) / len(places) for axis in zip(*places, strict=True))
    return x, y, z


def _with_ancestors(skeleton: Skeleton, joints: list[int]) -> list[HeadJoint]:
    """Return joints with all their ancestors, parents first."""
    order = skeleton.with_ancestors(joints)
    place = {joint: number for number, joint in enumerate(order)} | {-1: -1}
    matrices = skeleton.rest.globals(skeleton)[order, :3, :3]
    sizes = np.linalg.norm(matrices, axis=1, keepdims=True)
    rest = from_matrix(matrices / np.where(sizes > 0, sizes, 1.0)).tolist()
    return [
        HeadJoint(joint, place[skeleton.parents[joint]], conjugate(turned))
        for joint, turned in zip(order, rest, strict=True)
    ]


def _line(head: int, neck: int | None, skeleton: Skeleton) -> list[int]:
    """Return the joints from the neck to the head; without a neck, the head alone."""
    line = [head]
    while neck is not None and line[-1] not in (neck, -1):
        line.append(skeleton.parents[line[-1]])
    return line[::-1] if line[-1] == neck else [head]
