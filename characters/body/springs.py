"""The swing of spring bones, by Verlet integration as in VRM.

Source: the specification VRMC_springBone 1.0, "SpringBone Algorithm". The end of each bone, its
tail, keeps its speed, is slowed down by drag, and pulled by gravity and to where the pose has it;
then it is put back to its distance from the joint, and out of colliders. The joint turns by the
smallest angle that points to it. The parents' turns come first.

The specification makes one such step a frame, so that hair depends on the frame rate. Here its
numbers mean what they do at `REFERENCE_RATE`, and a step of another length decays and accelerates
by the same recurrence in between: at the reference rate both are the same.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from characters.model.springs import SpringBone, SpringCollider
from characters.skeleton import rotations
from characters.skeleton.pose import Array, Pose, Skeleton

REFERENCE_RATE = 60.0
"""Steps a second to which stiffness, drag and gravity belong [1/s]; also the fewest made."""

SETTLING_STEPS = 60
"""Steps before the first frame, so that gravity does not make hair fall when it appears."""

MAX_TAIL_SPEED = 25.0
"""Speed of a tail in the pose [m/s] above which its chain is carried along instead of swinging: the
character was put elsewhere. A running person whips its hair around at less than half of that."""

_Indices = NDArray[np.intp]


@dataclass(frozen=True)
class _Placed:
    """Where the bones are in the pose; those of the first level hang on what does not swing."""

    frames: Array
    """Rotations, (bones, 3, 3): of the first level in the world, of others in the frame of the
    spring bone above."""

    heads: Array
    """Where the joints are, (bones, 3) [m], in the same frames."""

    tails: Array
    """Ends of the bones in the world, (bones, 3) [m]."""

    lengths: Array
    """Of the bones, (bones, 1) [m]."""

    centers: Array
    """World placements of the centres, (bones, 4, 4); any matrix for bones without one."""

    colliders: Array
    """Both ends of the colliders' axes in the world, (colliders, 2, 3) [m]."""

    place: Array
    """Where the character stands, (3,) [m]."""

    def carried(self, matrices: Array, first: slice) -> "_Placed":
        """Return the bones moved rigidly by a matrix each, (bones, 4, 4)."""
        frames, heads = self.frames.copy(), self.heads.copy()
        frames[first] = matrices[first, :3, :3] @ frames[first]
        heads[first] = _moved(matrices[first], heads[first])
        return replace(self, frames=frames, heads=heads, tails=_moved(matrices, self.tails))

    def between(self, before: "_Placed", share: float, first: slice) -> "_Placed":
        """Return the bones with their first level on its way from an earlier placement."""
        if share >= 1.0:
            return self
        frames, heads = self.frames.copy(), self.heads.copy()
        mixed = before.frames[first] + share * (frames[first] - before.frames[first])
        # One Newton step of the polar decomposition makes the mixture a rotation again.
        frames[first] = 1.5 * mixed - 0.5 * mixed @ mixed.swapaxes(1, 2) @ mixed
        heads[first] = before.heads[first] + share * (heads[first] - before.heads[first])
        colliders = before.colliders + share * (self.colliders - before.colliders)
        return replace(self, frames=frames, heads=heads, colliders=colliders)


class SpringBody:
    """The spring bones of one character, in the order of time.

    Parameters
    ----------
    skeleton
        All joints.
    bones
        Those that swing; at most one for each joint.
    """

    def __init__(self, skeleton: Skeleton, bones: Sequence[SpringBone]) -> None:
        depths = _depths(skeleton, {bone.joint for bone in bones})
        bones = sorted(bones, key=lambda bone: (depths[bone.joint], bone.joint))
        self._joints: _Indices = np.array([bone.joint for bone in bones], np.intp)
        self._parents = _parents(skeleton, self._joints)
        levels = [depths[bone.joint] for bone in bones]
        self._levels = [
            slice(levels.index(level), levels.index(level) + levels.count(level))
            for level in sorted(set(levels))
        ]
        self._roots: _Indices = np.arange(len(bones))
        for level in self._levels[1:]:
            self._roots[level] = self._roots[self._parents[level]]
        self._offsets = _rows([bone.tail for bone in bones])
        self._axes = self._offsets / np.linalg.norm(self._offsets, axis=1, keepdims=True)
        self._stiffness = _rows([bone.stiffness for bone in bones])
        self._kept = 1.0 - _rows([bone.drag for bone in bones])
        self._gravity = _rows([bone.gravity for bone in bones])
        self._stillness = 1.0 - _rows([bone.wind for bone in bones])
        centers = [-1 if bone.center is None else bone.center for bone in bones]
        self._has_center = np.array(centers) >= 0
        shapes = list(dict.fromkeys(each for bone in bones for each in bone.colliders))
        self._shapes = np.array([[shape.start, shape.end] for shape in shapes]).reshape(-1, 2, 3)
        self._contacts = [_Contacts.of(bones[level], shapes) for level in self._levels]
        carriers = [shape.joint for shape in shapes]
        self._part = _SkeletonPart.of(skeleton, [*self._joints.tolist(), *carriers, *centers])
        # The last joint of the part stands for "none".
        self._own, self._carriers, self._centers = (
            self._part.places(joints) for joints in (self._joints.tolist(), carriers, centers)
        )
        self._last: _Placed | None = None
        self._now = self._before = np.zeros((0, 3))  # tails in the world, after the last two steps
        self._step = 1.0  # length of the last step [1 / REFERENCE_RATE]

    def update(self, pose: Pose, world_from_character: Array, elapsed: float) -> Pose:
        """Advance by a time [s] and return the pose with its spring bones swung.

        Parameters
        ----------
        pose
            Where the bones are pulled to, of one frame.
        world_from_character
            Rigid placement of the character, (4, 4) [m].
        elapsed
            Time since the last call [s].
        """
        placed = self._placed(pose, world_from_character)
        if self._last is None:
            self._now = self._before = placed.tails
            before, elapsed = placed, SETTLING_STEPS / REFERENCE_RATE
        else:
            before = self._carried(self._last, placed, elapsed)
        self._last = placed
        steps = max(math.ceil(elapsed * REFERENCE_RATE - 1e-6), 1)
        air = (placed.place - before.place) / steps * self._stillness
        for number in range(1, steps + 1):
            on_its_way = placed.between(before, number / steps, self._levels[0])
            directions = self._advance(on_its_way, elapsed * REFERENCE_RATE / steps, air)
        turned = pose.rotations.copy()
        turned[self._joints] = rotations.multiply(
            turned[self._joints], rotations.between(self._axes, directions)
        )
        return Pose(pose.translations, turned, pose.scales, pose.morphs)

    def _placed(self, pose: Pose, world_from_character: Array) -> _Placed:
        """Return where the pose has the bones."""
        world_from_joint = world_from_character @ self._part.globals(pose)
        own = world_from_joint[self._own]
        linear, heads = own[:, :3, :3], own[:, :3, 3]
        reach = (linear @ self._offsets[:, :, None])[..., 0]
        frames = linear
        if pose.scales is not None:
            frames = linear / np.maximum(np.linalg.norm(linear, axis=1, keepdims=True), 1e-9)
        tails, first = heads + reach, self._levels[0].stop
        if first < len(frames):
            above = self._parents[first:]
            back = frames[above].swapaxes(1, 2)
            inner = (back @ (heads[first:] - heads[above])[:, :, None])[..., 0]
            heads = np.concatenate([heads[:first], inner])
            frames = np.concatenate([frames[:first], back @ frames[first:]])
        ends = _moved(world_from_joint[self._carriers, None], self._shapes)
        lengths = np.sqrt(np.einsum("ni,ni->n", reach, reach))[:, None]
        centers = world_from_joint[self._centers]
        return _Placed(
            frames, heads, tails, lengths, centers, ends, world_from_character[:3, 3].copy()
        )

    def _carried(self, before: _Placed, now: _Placed, elapsed: float) -> _Placed:
        """Carry along what does not swing, tails included; return the earlier placement then."""
        first = self._levels[0]
        if self._has_center.any():
            moves = now.centers @ np.linalg.inv(before.centers)
            before = self._moved_along(before, moves, self._has_center)
        jumps = np.linalg.norm(now.tails - before.tails, axis=1) > MAX_TAIL_SPEED * elapsed
        if jumps.any():
            chains = np.isin(self._roots, self._roots[jumps])
            moves = _rigid(now.frames[first], now.heads[first]) @ np.linalg.inv(
                _rigid(before.frames[first], before.heads[first])
            )
            before = self._moved_along(before, moves[self._roots], chains)
            before = replace(before, place=now.place)
        return before

    def _moved_along(self, before: _Placed, moves: Array, which: NDArray[np.bool_]) -> _Placed:
        matrices = np.where(which[:, None, None], moves, np.eye(4))
        self._now, self._before = _moved(matrices, self._now), _moved(matrices, self._before)
        return before.carried(matrices, self._levels[0])

    def _advance(self, placed: _Placed, length: float, air: Array) -> Array:
        """Make a step of a length [1 / REFERENCE_RATE]; return where the bones point.

        `air` is how far the air about each tail moves meanwhile. The directions, (bones, 3), are
        in the frames of the joints in the pose.
        """
        kept = self._kept**length
        lost = 1.0 - self._kept
        gained = np.where(lost > 1e-9, (1.0 - kept) / np.maximum(lost, 1e-9), length)
        gained = gained * length / REFERENCE_RATE
        drift = (self._now - self._before) * (length / self._step)
        free = self._now + air + (drift - air) * kept + self._gravity * gained
        pulled = self._stiffness * gained
        tails, directions = np.empty_like(free), np.empty_like(free)
        turned, heads = np.empty_like(placed.frames), np.empty_like(free)
        for number, level in enumerate(self._levels):
            frames, origins, axes = placed.frames[level], placed.heads[level], self._axes[level]
            if number:
                above = self._parents[level]
                origins = heads[above] + (turned[above] @ origins[:, :, None])[..., 0]
                frames = turned[above] @ frames
            lengths = placed.lengths[level]
            rest = (frames @ axes[:, :, None])[..., 0]
            way = _with_length(free[level] + pulled[level] * rest - origins, lengths)
            way = self._contacts[number].pushed_out(way, origins, lengths, placed.colliders)
            aimed = way / lengths
            heads[level], tails[level] = origins, origins + way
            inner = directions[level] = (aimed[:, None] @ frames)[:, 0]
            if number + 1 < len(self._levels):
                turned[level] = _swung(frames, axes, inner, rest, aimed)
        if length > 0.0:
            self._before, self._step = self._now, length
        self._now = tails
        return directions


@dataclass(frozen=True)
class _SkeletonPart:
    """The joints on which some joints depend, as a skeleton of their own."""

    skeleton: Skeleton
    """These joints."""

    joints: _Indices
    """Their numbers in the whole skeleton."""

    @staticmethod
    def of(skeleton: Skeleton, joints: Sequence[int]) -> "_SkeletonPart":
        kept = skeleton.with_ancestors(joint for joint in joints if joint >= 0)
        places = {joint: number for number, joint in enumerate(kept)}
        names = tuple(skeleton.names[joint] for joint in kept)
        parents = tuple(places.get(skeleton.parents[joint], -1) for joint in kept)
        rest = Pose(skeleton.rest.translations[kept], skeleton.rest.rotations[kept])
        return _SkeletonPart(Skeleton(names, parents, rest), np.array(kept, np.intp))

    def places(self, joints: Sequence[int]) -> _Indices:
        """Return the numbers of joints in the part; any for −1."""
        return np.searchsorted(self.joints, np.maximum(np.array(joints, np.intp), 0))

    def globals(self, pose: Pose) -> Array:
        """Return `character_from_joint` of its joints, (joints, 4, 4), in a pose of all."""
        scales = None if pose.scales is None else pose.scales[self.joints]
        own = Pose(pose.translations[self.joints], pose.rotations[self.joints], scales)
        return own.globals(self.skeleton)


@dataclass(frozen=True)
class _Contacts:
    """Which bones of a level hit which colliders."""

    bones: _Indices
    """A bone of the level for each pair, (pairs,)."""

    colliders: _Indices
    """A collider for each pair, (pairs,)."""

    reach: Array
    """The least distance of the tail to the axis of the collider, (pairs,) [m]."""

    turns: tuple[slice, ...]
    """Pairs that are treated together: no bone is in one of them twice."""

    @staticmethod
    def of(bones: Sequence[SpringBone], shapes: Sequence[SpringCollider]) -> "_Contacts":
        pairs = sorted(
            (turn, number, shapes.index(shape), bone.radius + shape.radius)
            for number, bone in enumerate(bones)
            for turn, shape in enumerate(bone.colliders)
        )
        turns = [turn for turn, *_ in pairs]
        return _Contacts(
            np.array([number for _, number, _, _ in pairs], np.intp),
            np.array([shape for _, _, shape, _ in pairs], np.intp),
            np.array([reach for *_, reach in pairs]),
            tuple(
                slice(turns.index(turn), turns.index(turn) + turns.count(turn))
                for turn in sorted(set(turns))
            ),
        )

    def pushed_out(self, way: Array, origins: Array, lengths: Array, ends: Array) -> Array:
        """Return the ways from joints to tails, (bones, 3), with the tails out of colliders."""
        if not len(self.bones):
            return way
        tails = (origins + way)[self.bones]
        if (self._distances(slice(None), tails, ends)[1] >= self.reach).all():
            return way
        way = way.copy()
        for turn in self.turns:
            bones = self.bones[turn]
            heads = origins[bones]
            away, distances = self._distances(turn, heads + way[bones], ends)
            depth = np.maximum(self.reach[turn] - distances, 0.0)[:, None]
            pushed = way[bones] + away * (depth / np.maximum(distances, 1e-9)[:, None])
            way[bones] = np.where(depth > 0, _with_length(pushed, lengths[bones]), way[bones])
        return way

    def _distances(self, which: slice, tails: Array, ends: Array) -> tuple[Array, Array]:
        """Return the ways from the axes of colliders to tails, (pairs, 3), and their lengths."""
        start, end = ends[self.colliders[which], 0], ends[self.colliders[which], 1]
        along, away = end - start, tails - start
        squared = np.einsum("ni,ni->n", along, along)
        shares = np.einsum("ni,ni->n", away, along) / np.maximum(squared, 1e-18)
        away -= np.clip(shares, 0.0, 1.0)[:, None] * along
        return away, np.sqrt(np.einsum("ni,ni->n", away, away))


def _swung(frames: Array, axes: Array, inner: Array, rest: Array, aimed: Array) -> Array:
    """Return frames, (bones, 3, 3), turned by the smallest angle from `rest` to `aimed`.

    A turn is two reflections: M + 2 b aᵀ − s (a + Mᵀb)ᵀ / (1 + rest·b), with a = Mᵀ rest, b the
    new direction and s = rest + b; the axes are a, and `inner` is Mᵀb.
    """
    cosine = np.einsum("ni,ni->n", rest, aimed)
    shares = (axes + inner) / np.maximum(1.0 + cosine, 1e-9)[:, None]
    turned: Array = frames + 2.0 * aimed[:, :, None] * axes[:, None]
    turned -= (rest + aimed)[:, :, None] * shares[:, None]
    return turned


def _with_length(vectors: Array, lengths: Array) -> Array:
    """Return vectors (n, 3) with these lengths (n, 1)."""
    squared = np.einsum("ni,ni->n", vectors, vectors)[:, None]
    scaled: Array = vectors * (lengths / np.sqrt(np.maximum(squared, 1e-18)))
    return scaled


def _moved(matrices: Array, points: Array) -> Array:
    """Return points (…, 3) after matrices (…, 4, 4)."""
    moved: Array = (matrices[..., :3, :3] @ points[..., None])[..., 0] + matrices[..., :3, 3]
    return moved


def _rigid(frames: Array, origins: Array) -> Array:
    """Return the matrices (n, 4, 4) of frames (n, 3, 3) at origins (n, 3)."""
    matrices = np.tile(np.eye(4), (len(frames), 1, 1))
    matrices[:, :3, :3], matrices[:, :3, 3] = frames, origins
    return matrices


def _rows(values: Sequence[object]) -> Array:
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
