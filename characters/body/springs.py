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

from characters.body.spring_contacts import Contacts, with_length
from characters.model.springs import REFERENCE_HEIGHT_M, SpringBone
from characters.skeleton import rotations
from characters.skeleton.pose import Array, Pose, Skeleton

REFERENCE_RATE = 60.0
"""Steps a second to which stiffness, drag and gravity belong [1/s]; also the fewest made."""

SETTLING_STEPS = 60
"""Steps before the first frame, so that gravity does not make hair fall when it appears."""

MAX_TAIL_SPEED = 25.0
"""Speed of a tail in the pose [m/s] above which its chain is carried along instead of swinging: a
character of `REFERENCE_HEIGHT_M` was put elsewhere. A running person whips its hair around at less
than half of that."""

_Indices = NDArray[np.intp]


@dataclass(frozen=True)
class _Placed:
    """Where the bones are in the pose; those of the first level hang on what does not swing."""

    frames: Array
    """(bones, 3, 5): rotation, origin [m] and direction of each bone. They are those of the first
    level in the world, of others in the frame of the spring bone above."""

    tails: Array
    """Ends of the bones in the world, (bones, 3) [m]."""

    lengths: Array
    """Of the bones, (bones, 1) [m]."""

    centers: Array
    """Rotations and origins of the centres in the world, (bones, 3, 4) [m]; any for none."""

    colliders: Array
    """Both ends of the colliders' axes in the world, (colliders, 2, 3) [m]."""

    place: Array
    """Where the character stands, (3,) [m]."""

    def carried(self, matrices: Array, first: slice) -> "_Placed":
        """Return the bones moved rigidly by a matrix each, (bones, 3, 4)."""
        frames = self.frames.copy()
        frames[first] = matrices[first, :3, :3] @ frames[first]
        frames[first, :, 3] += matrices[first, :3, 3]
        return replace(self, frames=frames, tails=_moved(matrices, self.tails))

    def between(self, before: "_Placed", share: float, first: slice) -> "_Placed":
        """Return the bones with their first level on its way from an earlier placement."""
        if share >= 1.0:
            return self
        frames = self.frames.copy()
        mixed = before.frames[first] + share * (frames[first] - before.frames[first])
        # One Newton step of the polar decomposition makes the mixture a rotation again.
        turns = mixed[..., :3]
        grown = turns.swapaxes(1, 2) @ mixed[..., [0, 1, 2, 4]]
        mixed[..., [0, 1, 2, 4]] = 1.5 * mixed[..., [0, 1, 2, 4]] - 0.5 * turns @ grown
        frames[first] = mixed
        colliders = before.colliders + share * (self.colliders - before.colliders)
        return replace(self, frames=frames, colliders=colliders)


class SpringBody:
    """The spring bones of one character, in the order of time.

    Parameters
    ----------
    skeleton
        All joints.
    bones
        Those that swing; at most one for each joint.
    height
        Of the character [m].
    """

    def __init__(
        self,
        skeleton: Skeleton,
        bones: Sequence[SpringBone],
        height: float = REFERENCE_HEIGHT_M,
    ) -> None:
        self._most_speed = MAX_TAIL_SPEED * height / REFERENCE_HEIGHT_M
        joint_of = {name: joint for joint, name in enumerate(skeleton.names)}
        depths = _depths(skeleton, {joint_of[bone.joint] for bone in bones})
        order = sorted((depths[joint_of[bone.joint]], joint_of[bone.joint], bone) for bone in bones)
        bones = [bone for _, _, bone in order]
        self._joints: _Indices = np.array([joint for _, joint, _ in order], np.intp)
        self._parents = _parents(skeleton, self._joints)
        levels = [depth for depth, _, _ in order]
        self._levels = [
            slice(levels.index(level), levels.index(level) + levels.count(level))
            for level in sorted(set(levels))
        ]
        self._roots: _Indices = np.arange(len(bones))
        for level in self._levels[1:]:
            self._roots[level] = self._roots[self._parents[level]]
        offsets = _rows([bone.tail for bone in bones])
        self._offsets = offsets[:, :, None]
        self._lengths = np.linalg.norm(offsets, axis=1, keepdims=True)
        self._axes = offsets / self._lengths
        self._half_turns = _half_turns(self._axes)
        self._stiffness = _rows([bone.stiffness for bone in bones])
        self._kept = 1.0 - _rows([bone.drag for bone in bones])
        self._gravity = _rows([bone.gravity for bone in bones])
        self._stillness = 1.0 - _rows([bone.wind for bone in bones])
        self._has_still_air = bool(self._stillness.any())
        centers = [-1 if bone.center is None else joint_of[bone.center] for bone in bones]
        self._has_center = np.array(centers) >= 0
        shapes = list(dict.fromkeys(each for bone in bones for each in bone.colliders))
        self._shapes = np.array([[shape.start, shape.end] for shape in shapes]).reshape(-1, 2, 3)
        self._contacts = [Contacts.of(bones[level], shapes) for level in self._levels]
        carriers = [joint_of[shape.joint] for shape in shapes]
        self._part = _SkeletonPart.of(skeleton, [*self._joints.tolist(), *carriers, *centers])
        self._own, self._carriers, self._centers = (
            self._part.places(joints) for joints in (self._joints.tolist(), carriers, centers)
        )
        self._last: _Placed | None = None
        self._now = self._before = np.zeros((0, 3))  # tails in the world, after the last two steps
        self._step = 1.0  # length of the last step [1 / REFERENCE_RATE]
        self._factors: tuple[float, tuple[Array, Array, Array]] | None = None  # of a length

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
        air = None
        if self._has_still_air:
            air = (placed.place - before.place) / steps * self._stillness
        length = elapsed * REFERENCE_RATE / steps
        for number in range(1, steps + 1):
            on_its_way = placed.between(before, number / steps, self._levels[0])
            directions = self._advance(on_its_way, length, air)
        turned = pose.rotations.copy()
        turned[self._joints] = rotations.multiply(turned[self._joints], self._turns(directions))
        return Pose(pose.translations, turned, pose.scales, pose.morphs)

    def _turns(self, directions: Array) -> Array:
        """Return the smallest rotations of the bones' axes to directions, (bones, 4)."""
        halves: Array = (self._half_turns @ directions[:, :, None])[..., 0]
        halves[:, 3] += 1.0
        if halves[:, 3].min() < 1e-9:  # any axis across will do
            return rotations.between(self._axes, directions)
        halves /= np.sqrt(2.0 * halves[:, 3:])
        return halves

    def _placed(self, pose: Pose, world_from_character: Array) -> _Placed:
        """Return where the pose has the bones."""
        world_from_joint = world_from_character @ self._part.globals(pose)
        own = world_from_joint[self._own]
        turns, heads = own[:, :3, :3], own[:, :3, 3]
        reach = (turns @ self._offsets)[..., 0]
        lengths = self._lengths
        centers = world_from_joint[self._centers, :3]
        if pose.scales is not None:
            turns, centers[..., :3] = _unscaled(turns), _unscaled(centers[..., :3])
            lengths = np.maximum(np.linalg.norm(reach, axis=1, keepdims=True), 1e-9)
        frames = np.empty((len(own), 3, 5))
        frames[..., :3], frames[..., 3], frames[..., 4] = turns, heads, reach / lengths
        first = self._levels[0].stop
        if first < len(frames):
            above = self._parents[first:]
            frames[first:, :, 3] -= heads[above]
            frames[first:] = turns[above].swapaxes(1, 2) @ frames[first:]
        ends = self._shapes
        if len(ends):
            ends = _moved(world_from_joint[self._carriers, None], ends)
        place = world_from_character[:3, 3].copy()
        return _Placed(frames, heads + reach, lengths, centers, ends, place)

    def _carried(self, before: _Placed, now: _Placed, elapsed: float) -> _Placed:
        """Carry along what does not swing, tails included; return the earlier placement then."""
        first = self._levels[0]
        if self._has_center.any():
            moves = _moves(before.centers, now.centers)
            before = self._moved_along(before, moves, self._has_center)
        jumps = np.linalg.norm(now.tails - before.tails, axis=1) > self._most_speed * elapsed
        if jumps.any():
            chains = np.isin(self._roots, self._roots[jumps])
            moves = _moves(before.frames[first], now.frames[first])
            before = self._moved_along(before, moves[self._roots], chains)
            before = replace(before, place=now.place)
        return before

    def _moved_along(self, before: _Placed, moves: Array, which: NDArray[np.bool_]) -> _Placed:
        matrices = np.where(which[:, None, None], moves, np.eye(3, 4))
        self._now, self._before = _moved(matrices, self._now), _moved(matrices, self._before)
        return before.carried(matrices, self._levels[0])

    def _advance(self, placed: _Placed, length: float, air: Array | None) -> Array:
        """Make a step of a length [1 / REFERENCE_RATE]; return where the bones point.

        `air` is how far the air about each tail moves meanwhile, if it does. The directions,
        (bones, 3), are in the frames of the joints in the pose.
        """
        kept, falling, pulled = self._step_factors(length)
        drift = (self._now - self._before) * (length / self._step)
        if air is not None:
            drift = drift - air
        free = self._now + drift * kept + falling
        if air is not None:
            free += air
        tails, directions = np.empty_like(free), np.empty_like(free)
        # Rotations and origins of the swung bones, (bones, 3, 4).
        swung = np.empty((len(free), 3, 4))
        for number, level in enumerate(self._levels):
            frames, lengths, axes = placed.frames[level], placed.lengths[level], self._axes[level]
            if number:
                above = swung.take(self._parents[level], 0)
                frames = above[..., :3] @ frames
                frames[..., 3] += above[..., 3]
            turns, origins, rest = frames[..., :3], frames[..., 3], frames[..., 4]
            way = with_length(free[level] + pulled[level] * rest - origins, lengths)
            contacts = self._contacts[number]
            if contacts is not None:
                way = contacts.pushed_out(way, origins, lengths, placed.colliders)
            aimed = way / lengths
            tails[level] = origins + way
            inner = directions[level] = (aimed[:, None] @ turns)[:, 0]
            if number + 1 < len(self._levels):
                swung[level, :, :3] = _swung(turns, axes, inner, rest, aimed)
                swung[level, :, 3] = origins
        if length > 0.0:
            self._before, self._step = self._now, length
        self._now = tails
        return directions

    def _step_factors(self, length: float) -> tuple[Array, Array, Array]:
        """Return the part of the speed that is kept, and the ways by gravity and stiffness [m].

        They are (bones, 1), (bones, 3) and (bones, 1) for a step [1 / REFERENCE_RATE].
        """
        if self._factors is None or self._factors[0] != length:
            lost = 1.0 - self._kept
            kept = self._kept**length
            gained = np.where(lost > 1e-9, (1.0 - kept) / np.maximum(lost, 1e-9), length)
            gained = gained * length / REFERENCE_RATE
            self._factors = length, (kept, self._gravity * gained, self._stiffness * gained)
        return self._factors[1]


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


def _swung(frames: Array, axes: Array, inner: Array, rest: Array, aimed: Array) -> Array:
    """Return frames, (bones, 3, 3), turned by the smallest angle from `rest` to `aimed`.

    A turn is two reflections: M + 2 b aᵀ − s (a + Mᵀb)ᵀ / (1 + rest·b), with a = Mᵀ rest, b the
    new direction and s = rest + b; the axes are a, and `inner` is Mᵀb.
    """
    cosine = np.vecdot(rest, aimed)
    columns, rows = np.empty((len(rest), 3, 2)), np.empty((len(rest), 2, 3))
    np.multiply(aimed, 2.0, out=columns[..., 0])
    np.add(rest, aimed, out=columns[..., 1])
    rows[:, 0] = axes
    np.divide(axes + inner, -np.maximum(1.0 + cosine, 1e-9)[:, None], out=rows[:, 1])
    turned: Array = frames + columns @ rows
    return turned


def _moved(matrices: Array, points: Array) -> Array:
    """Return points (…, 3) after matrices (…, 3 or 4, 4)."""
    moved: Array = (matrices[..., :3, :3] @ points[..., None])[..., 0] + matrices[..., :3, 3]
    return moved


def _unscaled(matrices: Array) -> Array:
    """Return matrices (n, 3, 3) with columns of length one, as far as they have any."""
    unit: Array = matrices / np.maximum(np.linalg.norm(matrices, axis=1, keepdims=True), 1e-9)
    return unit


def _moves(before: Array, after: Array) -> Array:
    """Return the rigid moves (n, 3, 4) from rotations and origins (n, 3, 4 or 5) to others."""
    moves = np.empty((len(before), 3, 4))
    moves[..., :3] = after[..., :3] @ before[..., :3].swapaxes(1, 2)
    moves[..., 3] = after[..., 3] - (moves[..., :3] @ before[..., 3, None])[..., 0]
    return moves


def _half_turns(axes: Array) -> Array:
    """Return matrices (n, 4, 3) whose products with directions b are a × b and a · b."""
    matrices = np.empty((len(axes), 4, 3))
    for column, unit in enumerate(np.eye(3)):
        matrices[:, :3, column] = rotations.cross(axes, unit)
    matrices[:, 3] = axes
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
