"""Inverse kinematics of the legs of a skeleton: hips and knees bend so that feet reach places."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.ik import two_bones
from cubeling.characters.skeleton.anatomy import SIDES, Anatomy
from cubeling.characters.skeleton.feet import foot_joints_by_side
from cubeling.characters.skeleton.masks import subtree
from cubeling.characters.skeleton.pose import Array, Pose, Skeleton
from cubeling.characters.skeleton.scalar_quaternions import (
    Quaternion,
    Vector,
    conjugate,
    make_global,
    multiply,
    rotate,
    subtract,
)


class LegFrames(NamedTuple):
    """Global frames of the joints of legs and their ancestors, in one pose."""

    rotations: list[Quaternion]
    """`character_from_joint` rotations."""

    positions: list[Vector]
    """[m]."""


@dataclass(frozen=True)
class LegIK:
    """The legs of a skeleton and the joints that they depend on."""

    indices: NDArray[np.intp]
    """Numbers in the whole skeleton of the joints from the roots to the toes, (n,)."""

    skeleton: Skeleton
    """The skeleton of these joints only."""

    joints: NDArray[np.intp]
    """Pelvis, hip, knee, ankle and toes of each leg, numbers in `skeleton`, (legs, 5)."""

    knees_ahead: bool = True
    """Whether all knees bend forward, as those of people do."""

    @property
    def count(self) -> int:
        """Number of legs, two or four."""
        return len(self.joints)

    @property
    def feet(self) -> tuple[tuple[int, ...], ...]:
        """Ankle and toes of each leg, numbers in the whole skeleton."""
        return tuple(map(tuple, self.indices[self.joints[:, 3:]].tolist()))

    def globals(self, pose: Pose) -> Array:
        """Return `character_from_joint` of the joints, (…, n, 4, 4)."""
        part = Pose(pose.translations[..., self.indices, :], pose.rotations[..., self.indices, :])
        return part.globals(self.skeleton)

    def frames(self, pose: Pose) -> LegFrames:
        """Return the global frames of the joints in one pose."""
        turns: list[Quaternion] = pose.rotations.take(self.indices, 0).tolist()
        positions: list[Vector] = pose.translations.take(self.indices, 0).tolist()
        make_global(turns, positions, self.skeleton.parents)
        return LegFrames(turns, positions)

    def reach(
        self, pose: Pose, balls: Sequence[Vector], facings: Sequence[Sequence[float]]
    ) -> Pose:
        """Return a pose with the balls of its feet at given positions and the feet facing so.

        Hips and knees bend as far as the legs reach.
        """
        frames = self.frames(pose)
        offsets = pose.translations.take(self._toes, 0).tolist()
        ankles, turns = [], []
        for (*_, ankle, _), offset, ball, facing in zip(
            self._joints, offsets, balls, facings, strict=True
        ):
            ankles.append(subtract(ball, rotate(facing, offset)))
            turns.append(multiply(facing, conjugate(frames.rotations[ankle])))
        return self.bend(pose, frames, ankles, turns)

    def bend(
        self,
        pose: Pose,
        frames: LegFrames,
        ankles: Sequence[Vector],
        turns: Sequence[Sequence[float]],
    ) -> Pose:
        """Return a pose with its ankles moved to new positions [m] and its feet turned.

        `turns` are rotations from the present orientation of the feet, in the character's frame.
        """
        rows: list[Quaternion] = []
        for (pelvis, hip, knee, ankle, _), target, foot in zip(
            self._joints, ankles, turns, strict=True
        ):
            upper, lower = two_bones.reach(
                frames.positions[hip],
                frames.positions[knee],
                frames.positions[ankle],
                target,
                knees_ahead=self.knees_ahead,
            )
            thigh = multiply(upper, frames.rotations[hip])
            shin = multiply(multiply(upper, lower), frames.rotations[knee])
            rows.append(multiply(conjugate(frames.rotations[pelvis]), thigh))
            rows.append(multiply(conjugate(thigh), shin))
            rows.append(multiply(conjugate(shin), multiply(foot, frames.rotations[ankle])))
        bent = pose.rotations.copy()
        bent[self._rows] = rows
        return pose.with_rotations(bent)

    def plant(
        self,
        pose: Pose,
        before: LegFrames,
        hips: Sequence[Vector],
        carriers: Sequence[Sequence[float]],
    ) -> Pose:
        """Return a pose whose hips have moved, with its feet where they were before.

        Knees bend in the planes that they were in: they go with their feet.

        Parameters
        ----------
        pose
            The pose with its pelvis moved.
        before
            Frames before that.
        hips
            Where hips are now [m].
        carriers
            Rotation of what carries each of them now, in the character's frame.
        """
        rows: list[Quaternion] = []
        turns, places = before.rotations, before.positions
        for (_, hip, knee, ankle, _), (x, y, z), above in zip(
            self._joints, hips, carriers, strict=True
        ):
            # The same as to move the foot the other way.
            hx, hy, hz = places[hip]
            fx, fy, fz = places[ankle]
            foot = fx + hx - x, fy + hy - y, fz + hz - z
            upper, lower = two_bones.reach(
                places[hip], places[knee], places[ankle], foot, knees_ahead=self.knees_ahead
            )
            thigh = multiply(upper, turns[hip])
            shin = multiply(multiply(upper, lower), turns[knee])
            rows.append(multiply(conjugate(above), thigh))
            rows.append(multiply(conjugate(thigh), shin))
            rows.append(multiply(conjugate(shin), turns[ankle]))
        bent = pose.rotations.copy()
        bent[self._rows] = rows
        return pose.with_rotations(bent)

    def lower_pelvis(
        self, pose: Pose, frames: LegFrames, distance: float
    ) -> tuple[Pose, LegFrames]:
        """Return a pose and its frames with the pelvis lowered by a distance [m]."""
        pelvis = int(self.joints[0, 0])
        parent = self.skeleton.parents[pelvis]
        down: Vector = (0.0, -distance, 0.0)
        if parent >= 0:
            down = rotate(conjugate(frames.rotations[parent]), down)
        moved = pose.translations.copy()
        moved[self.indices[pelvis]] += down
        positions = list(frames.positions)
        for joint in subtree(self.skeleton, pelvis):
            x, y, z = positions[joint]
            positions[joint] = (x, y - distance, z)
        return replace(pose, translations=moved), LegFrames(frames.rotations, positions)

    @cached_property
    def _rows(self) -> NDArray[np.intp]:
        """Hip, knee and ankle of each leg, numbers in the whole skeleton."""
        return self.indices[self.joints[:, 1:4]].ravel()

    @cached_property
    def _toes(self) -> NDArray[np.intp]:
        """Toes of each leg, numbers in the whole skeleton."""
        return self.indices[self.joints[:, 4]]

    @cached_property
    def _joints(self) -> list[list[int]]:
        joints: list[list[int]] = self.joints.tolist()
        return joints


def find_legs(skeleton: Skeleton) -> LegIK | None:
    """Return the legs of a skeleton that have hip, knee, ankle and toes, or None.

    Skeletons with scales at rest are not supported.
    """
    sides = foot_joints_by_side(skeleton)
    chains = [chain for feet in sides for chain in _leg_chains(feet, skeleton)[:1]]
    if not chains or skeleton.rest.scales is not None:
        return None
    return _legs(chains, skeleton)


def find_paws(skeleton: Skeleton, anatomy: Anatomy) -> LegIK | None:
    """Return the four legs of a quadruped, whose paws have no toes, or None."""
    names = [(f"{side}{end}UpperLeg", f"{side}{end}LowerLeg", f"{side}{end}Foot")
             for side in SIDES for end in ("", "Front")]  # fmt: skip
    if anatomy.kind != "quadruped" or any(n not in anatomy.joints for leg in names for n in leg):
        return None
    legs = [[anatomy.joints[name] for name in leg] for leg in names]
    chains = [[skeleton.parents[hip], hip, knee, paw, paw] for hip, knee, paw in legs]
    jointed = all(skeleton.parents[b] == a for _, *leg, _ in chains for a, b in pairwise(leg))
    return replace(_legs(chains, skeleton), knees_ahead=False) if jointed else None


def _legs(chains: list[list[int]], skeleton: Skeleton) -> LegIK:
    order = skeleton.with_ancestors(joint for chain in chains for joint in chain)
    number = {joint: index for index, joint in enumerate(order)} | {-1: -1}
    part = Skeleton(
        tuple(skeleton.names[joint] for joint in order),
        tuple(number[skeleton.parents[joint]] for joint in order),
        Pose(skeleton.rest.translations[order], skeleton.rest.rotations[order]),
    )
    joints = np.array([[number[joint] for joint in chain] for chain in chains])
    return LegIK(np.array(order), part, joints)


def _leg_chains(feet: list[int], skeleton: Skeleton) -> list[list[int]]:
    """Return pelvis, hip, knee, ankle and toes for each foot joint that has all of them."""
    chains: list[list[int]] = []
    for toes in feet:
        chain = [toes]
        while len(chain) < 5 and skeleton.parents[chain[-1]] >= 0:
            chain.append(skeleton.parents[chain[-1]])
        if len(chain) == 5 and chain[1] in feet and chain[2] not in feet:
            chains.append(chain[::-1])
    return chains
