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

from characters import rotations, two_bones
from characters.phase import find_feet
from characters.plain_rotations import Quaternion, Vector, conjugate, multiply, turn
from characters.pose import Array, Pose, Skeleton


@dataclass(frozen=True)
class Legs:
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
        return self.reach(mixed, *self._mean_feet(self.globals(stacked), np.asarray(weights)))

    def reach(self, pose: Pose, balls: Array, facings: Array) -> Pose:
        """Return a pose with the balls of its feet at places (legs, 3), facing so (legs, 4).

        Hips and knees bend, as far as the legs are long.
        """
        placed, local = self.globals(pose), pose.rotations[self.carriers].tolist()
        # The ball of the foot is what it stands and rolls on.
        offsets = pose.translations[self.carriers[self.joints[:, 4]]].tolist()
        ankles, turned = [], []
        for line, offset, ball, facing in zip(
            self._lines, offsets, balls.tolist(), facings.tolist(), strict=True
        ):
            x, y, z = turn(facing, offset)
            ankles.append((ball[0] - x, ball[1] - y, ball[2] - z))
            faced = local[line[0]]
            for joint in line[1:]:
                faced = multiply(faced, local[joint])
            turned.append(multiply(facing, conjugate(faced)))
        return self.bend(pose, placed, ankles, turned)

    def bend(
        self, pose: Pose, placed: Array, ankles: Sequence[Vector], turned: Sequence[Quaternion]
    ) -> Pose:
        """Return a pose with its ankles moved and its feet turned.

        Parameters
        ----------
        pose, placed
            What is changed, and its `globals`.
        ankles
            Where the ankles are to be [m].
        turned
            How the feet turn from how they face, in the character's frame.
        """
        turns: list[tuple[Quaternion, ...]] = []
        for frames, target, foot in zip(
            placed[self.joints[:, :4]].tolist(), ankles, turned, strict=True
        ):
            hip, knee, ankle = ((f[0][3], f[1][3], f[2][3]) for f in frames[1:])
            upper, lower = two_bones.reach(hip, knee, ankle, target)
            foot = multiply(conjugate(multiply(upper, lower)), foot)
            # What is above a joint has turned along.
            turns.append(
                tuple(
                    two_bones.seen_from(frame[:3], own)
                    for frame, own in zip(frames, (upper, lower, foot), strict=False)
                )
            )
        where = self.carriers[self.joints[:, 1:4]]
        bent = pose.rotations.copy()
        bent[where] = rotations.multiply(np.array(turns), bent[where])
        return replace(pose, rotations=bent)

    def lowered(self, pose: Pose, placed: Array, sink: float) -> tuple[Pose, Array]:
        """Return a pose and its `globals` with the first leg's pelvis `sink` lower [m]."""
        pelvis = int(self.joints[0, 0])
        parent = self.skeleton.parents[pelvis]
        down = np.array([0.0, -sink, 0.0])
        moved = pose.translations.copy()
        moved[self.carriers[pelvis]] += down if parent < 0 else down @ placed[parent, :3, :3]
        lower = placed.copy()
        lower[self._carried, 1, 3] -= sink
        return replace(pose, translations=moved), lower

    @cached_property
    def _carried(self) -> NDArray[np.intp]:
        """The pelvis of the first leg and what it carries, numbered among the carriers."""
        carried = {int(self.joints[0, 0])}
        for joint, parent in enumerate(self.skeleton.parents):
            if parent in carried:
                carried.add(joint)
        return np.array(sorted(carried))

    @cached_property
    def _lines(self) -> list[list[int]]:
        """The joints from the root to each ankle, numbered among the carriers."""
        lines = []
        for ankle in self.joints[:, 3].tolist():
            line = [ankle]
            while self.skeleton.parents[line[-1]] >= 0:
                line.append(self.skeleton.parents[line[-1]])
            lines.append(line[::-1])
        return lines

    def _mean_feet(self, globals_: Array, share: Array) -> tuple[Array, Array]:
        """Return where the balls of the feet are, (legs, 3), and how the feet face, (legs, 4)."""
        ankle, toes = self.joints[:, 3], self.joints[:, 4]
        place = np.einsum("p,pli->li", share, globals_[..., :3, 3][:, toes])
        facing = rotations.from_matrix(globals_[..., :3, :3][:, ankle])
        facing = rotations.align(facing, facing[int(share.argmax())])
        return place, rotations.normalize(np.einsum("p,pli->li", share, facing))


def find_legs(skeleton: Skeleton) -> Legs | None:
    """Return the legs whose feet have ankle and toes under a knee and a hip, or None.

    A skeleton that is scaled at rest is left alone.
    """
    lines = [line for feet in find_feet(skeleton) for line in _lines(feet, skeleton)[:1]]
    if not lines or skeleton.rest.scales is not None:
        return None
    carriers = {joint for line in lines for joint in line}
    for joint in reversed(range(len(skeleton))):
        if joint in carriers and skeleton.parents[joint] >= 0:
            carriers.add(skeleton.parents[joint])
    order = sorted(carriers)
    number = {joint: place for place, joint in enumerate(order)} | {-1: -1}
    part = Skeleton(
        tuple(skeleton.names[joint] for joint in order),
        tuple(number[skeleton.parents[joint]] for joint in order),
        skeleton.rest[np.array(order)],
    )
    joints = np.array([[number[joint] for joint in line] for line in lines])
    return Legs(np.array(order), part, joints)


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
