"""Where a pose has spring bones: in the world, or as they hang on other spring bones."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.model.springs import SpringBone
from cubeling.characters.skeleton.pose import Array, Pose, Skeleton
from cubeling.characters.skeleton.skeleton_part import SkeletonPart

_Indices = NDArray[np.intp]


@dataclass(frozen=True)
class PlacedBones:
    """Where the bones are in the pose; those of the first level hang on what does not swing."""

    frames: Array
    """(bones, 3, 5): rotation, origin [m] and direction of each bone. They are those of the first
    level in the world, of others in the frame of the spring bone above."""

    tails: Array
    """Ends of the bones in the world, (bones, 3) [m]."""

    lengths: Array
    """Of the bones, (bones, 1) [m]."""

    centers: Array
    """Rotations and origins of the centres in the world, (bones, 3, 4) [m]: of any joint for a bone
    without a centre, and of none if no bone has one."""

    colliders: Array
    """Both ends of the colliders' axes in the world, (colliders, 2, 3) [m]."""

    place: Array
    """Where the character stands, (3,) [m]."""

    def carry(self, matrices: Array, first: slice) -> "PlacedBones":
        """Return the bones moved rigidly by a matrix each, (bones, 3, 4)."""
        frames = self.frames.copy()
        frames[first] = matrices[first, :3, :3] @ frames[first]
        frames[first, :, 3] += matrices[first, :3, 3]
        return replace(self, frames=frames, tails=transform_points(matrices, self.tails))

    def steps_from(self, before: "PlacedBones", steps: int, first: slice) -> tuple[Array, Array]:
        """Return frames and colliders at each of equal steps from an earlier placement to this.

        They are copies, (steps, bones, 3, 5) and (steps, colliders, 2, 3). The first level moves.
        """
        if steps == 1:
            return self.frames.copy()[None], self.colliders[None]
        shares = _shares_of_steps(steps)
        earlier = before.frames[first]
        mixed = earlier + shares[:-1] * (self.frames[first] - earlier)
        # Directions between two frames are a little too short.
        columns = mixed.swapaxes(-1, -2)
        sizes = np.sqrt(np.vecdot(columns, columns))
        sizes[..., 3] = 1.0  # the origin
        frames = np.empty((steps, *self.frames.shape))
        frames[:] = self.frames
        np.divide(mixed, sizes[..., None, :], out=frames[:-1, first])
        return frames, before.colliders + shares * (self.colliders - before.colliders)


class SpringFrames:
    """The spring bones of a skeleton in levels: each level hangs on those before it."""

    def __init__(self, skeleton: Skeleton, bones: Sequence[SpringBone]) -> None:
        joint_of = {name: joint for joint, name in enumerate(skeleton.names)}
        depths = _depths(skeleton, {joint_of[bone.joint] for bone in bones})
        order = sorted((depths[joint_of[bone.joint]], joint_of[bone.joint], bone) for bone in bones)
        self.bones = [bone for _, _, bone in order]
        """The spring bones in the order of all arrays: level by level."""
        self.joints: _Indices = np.array([joint for _, joint, _ in order], np.intp)
        """Their joints."""
        self.parents = _parents(skeleton, self.joints)
        """The spring bone above each, −1 for none."""
        depth_of = [depth for depth, _, _ in order]
        self.levels = [
            slice(depth_of.index(depth), depth_of.index(depth) + depth_of.count(depth))
            for depth in sorted(set(depth_of))
        ]
        """The bones of each level."""
        self.roots: _Indices = np.arange(len(order))
        """The first spring bone of the chain of each."""
        for level in self.levels[1:]:
            self.roots[level] = self.roots[self.parents[level]]
        tails = rows([bone.tail for bone in self.bones])
        self._lengths = np.linalg.norm(tails, axis=1, keepdims=True)
        self.axes = tails / self._lengths
        """Directions of the bones in their joints' frames, (bones, 3)."""
        # Columns of rotation, origin, direction and tail of each bone in its joint's frame.
        self._columns = np.zeros((len(tails), 4, 6))
        self._columns[:, :, :4] = np.eye(4)
        self._columns[:, :3, 4], self._columns[:, :3, 5] = self.axes, tails
        self._columns[:, 3, 5] = 1.0
        self.shapes = list(dict.fromkeys(each for bone in self.bones for each in bone.colliders))
        """The colliders."""
        ends = np.array([[shape.start, shape.end] for shape in self.shapes]).reshape(-1, 2, 3)
        self._ends = np.concatenate([ends.swapaxes(1, 2), np.ones((len(ends), 1, 2))], 1)
        centers = [None if bone.center is None else joint_of[bone.center] for bone in self.bones]
        self.has_center = np.array([center is not None for center in centers])
        """Which bones have a centre."""
        wanted = [*self.joints.tolist(), *(joint_of[shape.joint] for shape in self.shapes)]
        if self.has_center.any():
            wanted += [center or 0 for center in centers]
        self._part = SkeletonPart.of(skeleton, wanted)
        self._wanted = self._part.places(wanted)

    def place_bones(self, pose: Pose, world_from_character: Array) -> PlacedBones:
        """Return where the pose has the bones."""
        bones, carriers = len(self.bones), len(self.bones) + len(self.shapes)
        placed = self._part.globals(pose, world_from_character)[self._wanted, :3]
        columns = placed[:bones] @ self._columns
        frames, tails, lengths = columns[..., :5], columns[..., 5], self._lengths
        centers = placed[carriers:]
        if pose.scales is not None:
            reach = tails - frames[..., 3]
            lengths = np.maximum(np.linalg.norm(reach, axis=1, keepdims=True), 1e-9)
            frames[..., :3], frames[..., 4] = _unscale(frames[..., :3]), reach / lengths
            centers[..., :3] = _unscale(centers[..., :3])
        first = self.levels[0].stop
        if first < bones:
            above = frames.take(self.parents[first:], 0)
            frames[first:, :, 3] -= above[..., 3]
            frames[first:] = above[..., :3].swapaxes(1, 2) @ frames[first:]
        ends = (placed[bones:carriers] @ self._ends).swapaxes(1, 2)
        return PlacedBones(
            frames, tails, lengths, centers, ends, world_from_character[:3, 3].copy()
        )


@cache
def _shares_of_steps(steps: int) -> Array:
    """Return which part of the way is behind after each of equal steps, (steps, 1, 1, 1)."""
    return (np.arange(1.0, steps + 1) / steps)[:, None, None, None]


def transform_points(matrices: Array, points: Array) -> Array:
    """Return points (…, 3) after matrices (…, 3 or 4, 4)."""
    moved: Array = (matrices[..., :3, :3] @ points[..., None])[..., 0] + matrices[..., :3, 3]
    return moved


def _unscale(matrices: Array) -> Array:
    """Return matrices (n, 3, 3) with columns of length one, as far as they have any."""
    unit: Array = matrices / np.maximum(np.linalg.norm(matrices, axis=1, keepdims=True), 1e-9)
    return unit


def rigid_moves(before: Array, after: Array) -> Array:
    """Return the rigid moves (n, 3, 4) from rotations and origins (n, 3, 4 or 5) to others."""
    moves = np.empty((len(before), 3, 4))
    moves[..., :3] = after[..., :3] @ before[..., :3].swapaxes(1, 2)
    moves[..., 3] = after[..., 3] - (moves[..., :3] @ before[..., 3, None])[..., 0]
    return moves


def rows(values: Sequence[object]) -> Array:
    """Return numbers or vectors as (n, 1) or (n, 3)."""
    return np.array(values, float).reshape(len(values), -1)


def _depths(skeleton: Skeleton, swinging: set[int]) -> list[int]:
    """Return how many joints above each joint swing."""
    depths: list[int] = []
    for parent in skeleton.parents:
        depths.append(0 if parent < 0 else depths[parent] + (parent in swinging))
    return depths


def _parents(skeleton: Skeleton, joints: _Indices) -> _Indices:
    """Return for each joint which of them is the nearest above it, −1 for none."""
    places = {joint: number for number, joint in enumerate(joints.tolist())}
    found = []
    for joint in joints.tolist():
        above = skeleton.parents[joint]
        while above >= 0 and above not in places:
            above = skeleton.parents[above]
        found.append(places.get(above, -1))
    return np.array(found, np.intp)
