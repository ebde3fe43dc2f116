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

from characters import rotations
from characters.phase import find_feet
from characters.pose import Array, Pose, Skeleton

_STRAIGHTEST = 0.999  # part of a leg's length that a target may need
_KNEE_AXIS = np.array([-1.0, 0.0, 0.0])  # of a leg that is straight: it bends the shin backward


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
        placed = self.globals(pose)
        ankle, toes = self.joints[:, 3], self.joints[:, 4]
        # The ball of the foot is what it stands and rolls on.
        offsets = pose.translations[self.carriers[toes]]
        turned = rotations.multiply(
            facings, rotations.conjugate(rotations.from_matrix(placed[ankle, :3, :3]))
        )
        return self.bend(pose, placed, balls - rotations.rotate(facings, offsets), turned)

    def bend(self, pose: Pose, placed: Array, ankles: Array, turned: Array) -> Pose:
        """Return a pose with its ankles moved and its feet turned.

        Parameters
        ----------
        pose, placed
            What is changed, and its `globals`.
        ankles
            Where the ankles are to be, (legs, 3) [m].
        turned
            How the feet turn from how they face, in the character's frame, (legs, 4).
        """
        pelvis, hip, knee = self.joints[:, :3].T
        upper, lower = self._reach(placed[..., :3, 3], ankles)
        # A turn T in the frame of the character is Gᵀ T G in that of a joint G: only the axis
        # of a quaternion changes. What is above a joint has turned along.
        foot = rotations.multiply(rotations.conjugate(rotations.multiply(upper, lower)), turned)
        turns = np.stack([upper, lower, foot])
        frames = placed[np.stack([pelvis, hip, knee]), :3, :3]
        turns[..., :3] = (turns[..., None, :3] @ frames)[..., 0, :]
        where = self.carriers[self.joints[:, 1:4].T]
        bent = pose.rotations.copy()
        bent[where] = rotations.multiply(turns, bent[where])
        return replace(pose, rotations=bent)

    def _mean_feet(self, globals_: Array, share: Array) -> tuple[Array, Array]:
        """Return where the balls of the feet are, (legs, 3), and how the feet face, (legs, 4)."""
        ankle, toes = self.joints[:, 3], self.joints[:, 4]
        place = np.einsum("p,pli->li", share, globals_[..., :3, 3][:, toes])
        facing = rotations.from_matrix(globals_[..., :3, :3][:, ankle])
        facing = rotations.align(facing, facing[int(share.argmax())])
        return place, rotations.normalize(np.einsum("p,pli->li", share, facing))

    def _reach(self, at: Array, target: Array) -> tuple[Array, Array]:
        """Return the turns of the whole leg and of the shin, (legs, 4) each, in the character.

        The knee keeps its plane; the law of cosines says how far it bends.
        """
        hip, knee, ankle = (at[self.joints[:, column]] for column in (1, 2, 3))
        thigh, shin = hip - knee, ankle - knee
        long, short = _length(thigh), _length(shin)
        wanted = np.clip(
            _length(target - hip), np.abs(long - short) + 1e-6, _STRAIGHTEST * (long + short)
        )
        across = rotations.cross(thigh, shin)
        size = _length(across)
        axis = np.where(size > 1e-9, across / np.maximum(size, 1e-9), _KNEE_AXIS)
        bend = np.arctan2(size, np.einsum("ij,ij->i", thigh, shin)[:, None])
        goal = np.arccos(np.clip((long**2 + short**2 - wanted**2) / (2 * long * short), -1, 1))
        lower = rotations.about(axis, (goal - bend)[:, 0])
        reached = knee + rotations.rotate(lower, shin) - hip
        return rotations.between(reached, target - hip), lower


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


def _length(vectors: Array) -> Array:
    length: Array = np.sqrt(np.einsum("ij,ij->i", vectors, vectors))[:, None]
    return length
