"""Feet that stay planted when clips are mixed.

A mix of joint angles moves the feet on a path of no clip: they slide, and dip into the ground.
Here a mix's feet are put where the mean of the clips' feet is, by bending hips and knees. A foot
that stands still over the ground in every clip then stands still in the mix.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from characters.ik import two_bones
from characters.skeleton import rotations
from characters.skeleton.feet import foot_joints_by_side
from characters.skeleton.pose import Array, Pose, Skeleton
from characters.skeleton.scalar_quaternions import (
    Quaternion,
    Vector,
    conjugate,
    multiply,
    rotate,
    subtract,
)


@dataclass(frozen=True)
class Placed:
    """Where the carriers of legs are in a pose, in the character."""

    turns: list[Quaternion]
    """How each is turned."""

    places: list[Vector]
    """Where each is [m]."""


@dataclass(frozen=True)
class LegIK:
    """The legs of a skeleton, with all that carries them."""

    carriers: NDArray[np.intp]
    """Numbers in the whole skeleton of the joints from the roots to the toes, (n,)."""

    skeleton: Skeleton
    """These joints alone."""

    joints: NDArray[np.intp]
    """Pelvis, hip, knee, ankle and toes of each leg among them, (legs, 5)."""

    @property
    def count(self) -> int:
        """Number of legs."""
        return len(self.joints)

    @property
    def feet(self) -> tuple[tuple[int, ...], ...]:
        """Ankle and toes of each leg, numbered as in the whole skeleton."""
        return tuple(map(tuple, self.carriers[self.joints[:, 3:]].tolist()))

    @cached_property
    def lengths(self) -> Array:
        """Thigh and shin together, (legs,) [m]."""
        offsets = self.skeleton.rest.translations[self.joints[:, 2:4]]
        long: Array = np.sqrt(np.einsum("lji,lji->lj", offsets, offsets)).sum(1)
        return long

    @cached_property
    def at_rest(self) -> Array:
        """`character_from_joint` of the carriers at rest, (n, 4, 4)."""
        return self.skeleton.rest.globals(self.skeleton)

    def globals(self, pose: Pose) -> Array:
        """Return `character_from_joint` of the carriers, (…, n, 4, 4)."""
        part = Pose(pose.translations[..., self.carriers, :], pose.rotations[..., self.carriers, :])
        return part.globals(self.skeleton)

    def plant(self, mixed: Pose, poses: Sequence[Pose], weights: Sequence[float]) -> Pose:
        """Return a mix of poses with its feet at the mean of theirs.

        Parameters
        ----------
        mixed
            The mix.
        poses, weights
            What was mixed, and how much of each; the weights sum to one.
        """
        stacked = Pose(
            np.stack([pose.translations for pose in poses]),
            np.stack([pose.rotations for pose in poses]),
        )
        balls, facings = self._mean_feet(self.globals(stacked), np.asarray(weights))
        return self.reach(mixed, balls.tolist(), facings.tolist())

    def placed(self, pose: Pose) -> "Placed":
        """Return where the carriers are in one pose, in plain numbers."""
        turns: list[Quaternion] = pose.rotations[self.carriers].tolist()
        places: list[Vector] = pose.translations[self.carriers].tolist()
        for joint, parent in enumerate(self.skeleton.parents):
            if parent >= 0:
                above, (x, y, z) = turns[parent], places[parent]
                turns[joint] = multiply(above, turns[joint])
                dx, dy, dz = rotate(above, places[joint])
                places[joint] = (x + dx, y + dy, z + dz)
        return Placed(turns, places)

    def reach(
        self, pose: Pose, balls: Sequence[Vector], facings: Sequence[Sequence[float]]
    ) -> Pose:
        """Return a pose with the balls of its feet at places, facing so.

        Hips and knees bend, as far as the legs are long.
        """
        placed = self.placed(pose)
        # The ball of the foot is what it stands and rolls on.
        offsets = pose.translations[self._toes].tolist()
        ankles, turned = [], []
        for (*_, ankle, _), offset, ball, facing in zip(
            self._joints, offsets, balls, facings, strict=True
        ):
            ankles.append(subtract(ball, rotate(facing, offset)))
            turned.append(multiply(facing, conjugate(placed.turns[ankle])))
        return self.bend(pose, placed, ankles, turned)

    def bend(
        self,
        pose: Pose,
        placed: "Placed",
        ankles: Sequence[Vector],
        turned: Sequence[Sequence[float]],
    ) -> Pose:
        """Return a pose with its ankles moved and its feet turned.

        Parameters
        ----------
        pose, placed
            What is changed, and where its joints are.
        ankles
            Where the ankles are to be [m].
        turned
            How the feet turn from how they face, in the character's frame.
        """
        rows: list[Quaternion] = []
        for (pelvis, hip, knee, ankle, _), target, foot in zip(
            self._joints, ankles, turned, strict=True
        ):
            upper, lower = two_bones.reach(
                placed.places[hip], placed.places[knee], placed.places[ankle], target
            )
            thigh = multiply(upper, placed.turns[hip])
            shin = multiply(multiply(upper, lower), placed.turns[knee])
            rows.append(multiply(conjugate(placed.turns[pelvis]), thigh))
            rows.append(multiply(conjugate(thigh), shin))
            rows.append(multiply(conjugate(shin), multiply(foot, placed.turns[ankle])))
        bent = pose.rotations.copy()
        bent[self._bent] = rows
        return Pose(pose.translations, bent, pose.scales, pose.morphs)

    def lowered(self, pose: Pose, placed: "Placed", sink: float) -> tuple[Pose, "Placed"]:
        """Return a pose, and where it is, with the first leg's pelvis `sink` lower [m]."""
        pelvis = int(self.joints[0, 0])
        parent = self.skeleton.parents[pelvis]
        down: Vector = (0.0, -sink, 0.0)
        if parent >= 0:
            down = rotate(conjugate(placed.turns[parent]), down)
        moved = pose.translations.copy()
        moved[self.carriers[pelvis]] += down
        places = list(placed.places)
        for joint in self._carried:
            x, y, z = places[joint]
            places[joint] = (x, y - sink, z)
        return replace(pose, translations=moved), Placed(placed.turns, places)

    @cached_property
    def _joints(self) -> list[list[int]]:
        """`joints` in plain numbers."""
        joints: list[list[int]] = self.joints.tolist()
        return joints

    @cached_property
    def _toes(self) -> NDArray[np.intp]:
        """The toes, numbered as in the whole skeleton."""
        return self.carriers[self.joints[:, 4]]

    @cached_property
    def _bent(self) -> NDArray[np.intp]:
        """Hip, knee and ankle of one leg after the other, numbered as in the whole skeleton."""
        return self.carriers[self.joints[:, 1:4]].ravel()

    @cached_property
    def _carried(self) -> list[int]:
        """The pelvis of the first leg and what it carries, numbered among the carriers."""
        carried = {int(self.joints[0, 0])}
        for joint, parent in enumerate(self.skeleton.parents):
            if parent in carried:
                carried.add(joint)
        return sorted(carried)

    def _mean_feet(self, globals_: Array, share: Array) -> tuple[Array, Array]:
        """Return where the balls of the feet are, (legs, 3), and how the feet face, (legs, 4)."""
        ankle, toes = self.joints[:, 3], self.joints[:, 4]
        place = np.einsum("p,pli->li", share, globals_[..., :3, 3][:, toes])
        facing = rotations.from_matrix(globals_[..., :3, :3][:, ankle])
        facing = rotations.align(facing, facing[int(share.argmax())])
        return place, rotations.normalize(np.einsum("p,pli->li", share, facing))


def find_legs(skeleton: Skeleton) -> LegIK | None:
    """Return the legs whose feet have ankle and toes under a knee and a hip, or None.

    A skeleton that is scaled at rest is left alone.
    """
    lines = [line for feet in foot_joints_by_side(skeleton) for line in _lines(feet, skeleton)[:1]]
    if not lines or skeleton.rest.scales is not None:
        return None
    order = skeleton.with_ancestors(joint for line in lines for joint in line)
    number = {joint: place for place, joint in enumerate(order)} | {-1: -1}
    part = Skeleton(
        tuple(skeleton.names[joint] for joint in order),
        tuple(number[skeleton.parents[joint]] for joint in order),
        skeleton.rest[np.array(order)],
    )
    joints = np.array([[number[joint] for joint in line] for line in lines])
    return LegIK(np.array(order), part, joints)


def _lines(feet: list[int], skeleton: Skeleton) -> list[list[int]]:
    """Return pelvis, hip, knee, ankle and toes for each joint of a foot that has all of them."""
    lines: list[list[int]] = []
    for toes in feet:
        line = [toes]
        while len(line) < 5 and skeleton.parents[line[-1]] >= 0:
            line.append(skeleton.parents[line[-1]])
        if len(line) == 5 and line[1] in feet and line[2] not in feet:
            lines.append(line[::-1])
    return lines
