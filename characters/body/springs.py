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
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.body.spring_contacts import Contacts, with_length
from cubeling.characters.body.spring_frames import (
    PlacedBones,
    SpringFrames,
    rigid_moves,
    rows,
    transform_points,
)
from cubeling.characters.model.springs import REFERENCE_HEIGHT_M, SpringBone
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.pose import Array, Pose, Skeleton

REFERENCE_RATE = 60.0
"""Steps a second to which stiffness, drag and gravity belong [1/s]; also the fewest made."""

SETTLING_STEPS = 60
"""Steps before the first frame, so that gravity does not make hair fall when it appears."""

NEGLIGIBLE_STEP = 1e-6
"""A step that is shorter [1 / REFERENCE_RATE] is no time, but rounding of two equal timestamps: as
a divisor it would turn the rounding of places into a kick."""

MAX_TAIL_SPEED = 25.0
"""Speed of a tail in the pose [m/s] above which its chain is carried along instead of swinging: a
character of `REFERENCE_HEIGHT_M` was put elsewhere. A running person whips its hair around at less
than half of that."""


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
        self._frames = SpringFrames(skeleton, bones)
        bones = self._frames.bones
        self._half_turns = _half_turns(self._frames.axes)
        self._stiffness = rows([bone.stiffness for bone in bones])
        self._kept = np.repeat(1.0 - rows([bone.drag for bone in bones]), 3, axis=1)
        self._gravity = rows([bone.gravity for bone in bones])
        self._stillness = 1.0 - rows([bone.wind for bone in bones])
        self._has_still_air = bool(self._stillness.any())
        self._has_center = bool(self._frames.has_center.any())
        shapes = self._frames.shapes
        self._contacts = [Contacts.of(bones[level], shapes) for level in self._frames.levels]
        self._last: PlacedBones | None = None
        self._now = self._before = np.zeros((0, 3))  # tails in the world, after the last two steps
        self._step = 1.0  # length of the last step [1 / REFERENCE_RATE]
        self._factors: tuple[float, tuple[Array, Array, Array, Array]] | None = None  # of a length

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
        placed = self._frames.place_bones(pose, world_from_character)
        if self._last is None:
            # At rest at first: without a step before there is no speed.
            self._now = self._before = placed.tails
            before, elapsed = placed, SETTLING_STEPS / REFERENCE_RATE
        else:
            before = self._carry(self._last, placed, elapsed)
        self._last = placed
        # 1e-6: a frame of exactly 1/60 s is one step, whatever the rounding of its times.
        steps = max(math.ceil(elapsed * REFERENCE_RATE - 1e-6), 1)
        length = elapsed * REFERENCE_RATE / steps
        kept, falling, pulled, taken_along = self._step_factors(length)
        if self._has_still_air:
            falling = falling + taken_along * ((placed.place - before.place) / steps)
        frames, colliders = placed.steps_from(before, steps, self._frames.levels[0])
        for own, ends in zip(frames, colliders, strict=True):
            free = self._free(length, kept) + falling
            self._now = self._advance(free, pulled, own, placed.lengths, ends)
        aimed = (self._now - own[..., 3]) / placed.lengths
        directions = (aimed[:, None] @ own[..., :3])[:, 0]
        turned = pose.rotations.copy()
        turned[self._frames.joints] = rotations.multiply(
            turned.take(self._frames.joints, 0), self._turns(directions)
        )
        return pose.with_rotations(turned)

    def _turns(self, directions: Array) -> Array:
        """Return the smallest rotations of the bones' axes to directions, (bones, 4)."""
        halves: Array = np.vecdot(self._half_turns, directions[:, None])
        cosines = halves[:, 3:]
        cosines += 1.0
        if cosines.min() < 1e-9:  # any axis across will do
            return rotations.between(self._frames.axes, directions)
        halves /= np.sqrt(2.0 * cosines)
        return halves

    def _carry(self, before: PlacedBones, now: PlacedBones, elapsed: float) -> PlacedBones:
        """Carry along what does not swing, tails included; return the earlier placement then."""
        first = self._frames.levels[0]
        if self._has_center:
            moves = rigid_moves(before.centers, now.centers)
            before = self._move_along(before, moves, self._frames.has_center)
        ways = now.tails - before.tails
        jumps = np.vecdot(ways, ways) > (self._most_speed * elapsed) ** 2
        if np.count_nonzero(jumps):
            # Whole chains: a bone that is carried while its parent swings would tear them apart.
            chains = np.isin(self._frames.roots, self._frames.roots[jumps])
            moves = rigid_moves(before.frames[first], now.frames[first])
            before = self._move_along(before, moves[self._frames.roots], chains)
            before = replace(before, place=now.place)
        return before

    def _move_along(
        self, before: PlacedBones, moves: Array, which: NDArray[np.bool_]
    ) -> PlacedBones:
        matrices = np.where(which[:, None, None], moves, np.eye(3, 4))
        self._now, self._before = (
            transform_points(matrices, self._now),
            transform_points(matrices, self._before),
        )
        return before.carry(matrices, self._frames.levels[0])

    def _free(self, length: float, kept: Array) -> Array:
        """Return where the tails' own speeds take them in a step, and forget the step before."""
        drift = self._now - self._before
        if length != self._step:
            # Verlet has no speed but the last way, which belongs to the length of its own step.
            drift *= length / self._step
        # A frame without time must not forget the speed.
        if length > NEGLIGIBLE_STEP:
            self._before, self._step = self._now, length
        drift *= kept
        drift += self._now
        return drift

    def _advance(
        self, free: Array, pulled: Array, frames: Array, lengths: Array, colliders: Array
    ) -> Array:
        """Return where the tails are after a step, (bones, 3).

        `free` is where they are without stiffness, and `pulled` is how far that pulls them [m].
        The frames, (bones, 3, 5), become those in the world of all levels, before they swing.
        """
        tails, levels = np.empty_like(free), self._frames.levels
        swung = np.empty((len(free), 3, 4))  # rotations and origins
        for number, level in enumerate(levels):
            own, reach, ends = frames[level], lengths[level], tails[level]
            if number:
                above = swung.take(self._frames.parents[level], 0)
                own[:] = above[..., :3] @ own
                own[..., 3] += above[..., 3]
            origins = own[..., 3]
            way = pulled[level] * own[..., 4]
            way += free[level]
            way -= origins
            np.add(origins, with_length(way, reach), out=ends)
            # After the distance is restored, as in the specification; `push_out` keeps the distance
            # itself.
            contacts = self._contacts[number]
            if contacts is not None:
                contacts.push_out(ends, origins, reach, colliders)
            if number + 1 < len(levels):
                aimed = (ends - origins) / reach
                swung[level, :, :3] = _swing(own, self._frames.axes[level], aimed)
                swung[level, :, 3] = origins
        return tails

    def _step_factors(self, length: float) -> tuple[Array, Array, Array, Array]:
        """Return what a step of a length [1 / REFERENCE_RATE] does to tails, (bones, 3) each.

        It is the part of the speed that is kept, the ways by gravity and stiffness [m], and the
        part of its way by which the character takes them along with the air.
        """
        if self._factors is None or self._factors[0] != length:
            lost = 1.0 - self._kept
            kept = self._kept**length
            gained = np.where(lost > 1e-9, (1.0 - kept) / np.maximum(lost, 1e-9), length)
            gained = gained * length / REFERENCE_RATE
            taken_along = self._stillness * (1.0 - kept)
            ways = self._gravity * gained, self._stiffness * gained
            self._factors = length, (kept, *ways, taken_along)
        return self._factors[1]


def _swing(frames: Array, axes: Array, aimed: Array) -> Array:
    """Return the rotations of frames, (bones, 3, 3), turned by the smallest angle to `aimed`.

    A turn is two reflections: M + 2 b aᵀ − s (a + Mᵀb)ᵀ / (1 + rest·b), with a = Mᵀ rest, b the
    new direction and s = rest + b; the axes are a.
    """
    turns, rest = frames[..., :3], frames[..., 4]
    inner = (aimed[:, None] @ turns)[:, 0]
    cosine = np.vecdot(rest, aimed)
    columns, rows = np.empty((len(rest), 3, 2)), np.empty((len(rest), 2, 3))
    np.multiply(aimed, 2.0, out=columns[..., 0])
    np.add(rest, aimed, out=columns[..., 1])
    rows[:, 0] = axes
    np.divide(axes + inner, -np.maximum(1.0 + cosine, 1e-9)[:, None], out=rows[:, 1])
    turned: Array = turns + columns @ rows
    return turned


def _half_turns(axes: Array) -> Array:
    """Return matrices (n, 4, 3) whose products with directions b are a × b and a · b."""
    matrices = np.empty((len(axes), 4, 3))
    for column, unit in enumerate(np.eye(3)):
        matrices[:, :3, column] = rotations.cross(axes, unit)
    matrices[:, 3] = axes
    return matrices
