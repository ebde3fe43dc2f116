"""One batch of chains and targets, as solvers work on it: with the batch as the last axis."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Literal, Protocol

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.ik.solvers import columns
from cubeling.characters.ik.solvers.chains import Chains
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.pose import Array

Limiting = Literal["propagate", "clamp"]
"""What becomes of a rotation beyond a limit: passed on to the parent (S16), or cut off."""

_MIN_DROPPED = 0.2  # share of a batch that must be done before the rest is copied together


@dataclass(frozen=True)
class Bounds:
    """The intervals of the angles (φ, θ, ψ) of the joints of all chains."""

    low: Array
    """(joints, 3, 1) [rad]."""

    high: Array
    """(joints, 3, 1) [rad]."""

    def cut(self, turns: Array) -> tuple[Array, NDArray[np.bool_]]:
        """Return rotations (joints, 4, batch) within the bounds, and which were cut off.

        Those within are returned as they are, to the last bit.
        """
        angles = columns.to_euler(turns)
        within = np.clip(angles, self.low, self.high)
        events = (within != angles).any(-2)
        return np.where(events[..., None, :], columns.from_euler(within), turns), events

    def __getitem__(self, joint: int) -> "Bounds":
        """Return the bounds of one joint, for arrays without the axis of joints."""
        return Bounds(self.low[joint], self.high[joint])


@dataclass(frozen=True)
class Task:
    """A batch of chains with their start, targets and limits.

    The rotations are those between the axes of the limits: `before` and `after` of `AngleLimits`
    are in `links` and `offsets`.
    """

    offsets: Array
    """Bones in the axes of their joints, (joints, 3, batch) [m]."""

    lengths: Array
    """Lengths of the bones, (joints, batch) [m]."""

    links: Array | None
    """Rotation from each joint's axes at zero to the axes before it, (joints, 4, 1); None for
    identities."""

    start: Array
    """Rotations to start from, (joints, 4, batch)."""

    frames_at_start: Array
    """Base-frame rotations of the joints at the start, (joints, 4, batch)."""

    points_at_start: Array
    """Points of the joints, and the end of the last bone, at the start, (joints + 1, 3, batch)."""

    targets: Array
    """Where the ends of the chains are to be, (3, batch) [m]."""

    tolerance: Array
    """How near is near enough, (batch,) [m]."""

    bounds: Bounds | None = None
    """How far the joints turn; None for freely."""

    limiting: Limiting = "propagate"
    """What becomes of a rotation beyond a limit, where a solver leaves the choice."""

    @staticmethod
    def of(
        chains: Chains, targets: Array, start: Array, tolerance: Array, limiting: Limiting | None
    ) -> "Task":
        """Return the task of chains, targets (batch, 3) and local rotations (batch, joints, 4).

        The start is within the limits, unless `limiting` is None.
        """
        count, limits = len(targets), chains.limits
        turns, bones, links, bounds = columns.to_columns(start), chains.offsets, None, None
        if limits is not None:
            before, after = limits.before[..., None], limits.after[..., None]
            if limits.turned:
                inner = columns.multiply(columns.conjugate(before), turns)
                turns = columns.multiply(inner, columns.conjugate(after))
                bones = rotations.rotate(limits.after, bones)
                above = np.concatenate([columns.identities(1)[None], after[:-1]])
                links = columns.multiply(above, before)
            if limiting is not None:
                bounds = Bounds(limits.low[..., None], limits.high[..., None])
                turns, _ = bounds.cut(turns)
        offsets = columns.to_columns(np.broadcast_to(bones, (count, *bones.shape[-2:])))
        lengths = np.broadcast_to(chains.lengths, (count, chains.joints))
        frames, points = chain_frames(turns, offsets, links)
        return Task(
            offsets,
            columns.to_columns(lengths),
            links,
            turns,
            frames,
            points,
            columns.to_columns(targets),
            tolerance,
            bounds,
            limiting or "propagate",
        )

    def with_start(self, turns: Array) -> "Task":
        """Return the task with other rotations to start from."""
        frames, points = self.frames(turns)
        return replace(self, start=turns, frames_at_start=frames, points_at_start=points)

    @property
    def joints(self) -> int:
        """Number of joints of each chain."""
        return len(self.lengths)

    @property
    def count(self) -> int:
        """Number of chains that are solved at once: the batch."""
        return len(self.tolerance)

    @property
    def reach(self) -> Array:
        """Lengths of the chains, (batch,) [m]."""
        total: Array = self.lengths.sum(0)
        return total

    def select(self, which: NDArray[np.bool_] | NDArray[np.intp]) -> "Task":
        """Return some of the chains."""
        return replace(
            self,
            offsets=self.offsets[..., which],
            lengths=self.lengths[..., which],
            start=self.start[..., which],
            frames_at_start=self.frames_at_start[..., which],
            points_at_start=self.points_at_start[..., which],
            targets=self.targets[..., which],
            tolerance=self.tolerance[which],
        )

    def local_rotations(self, turns: Array, chains: Chains) -> Array:
        """Return rotations (joints, 4, batch) as local ones of the chains, (batch, joints, 4)."""
        if chains.limits is not None and chains.limits.turned:
            before, after = chains.limits.before[..., None], chains.limits.after[..., None]
            turns = columns.multiply(columns.multiply(before, turns), after)
        return columns.to_rows(turns)

    def frames(self, turns: Array) -> tuple[Array, Array]:
        """Return base-frame rotations (joints, 4, batch) and points (joints + 1, 3, batch)."""
        return chain_frames(turns, self.offsets, self.links)

    def zero_frame(self, frames: Array, joint: int) -> Array:
        """Return the base-frame rotation of the axes of a joint at zero, from those above it."""
        above = frames[joint - 1] if joint else columns.identities(frames.shape[-1])
        return above if self.links is None else columns.multiply(above, self.links[joint])

    def turns(self, frames: Array) -> Array:
        """Return the rotations of the joints from their base-frame rotations."""
        above = np.empty_like(frames)
        above[0], above[1:] = np.array([[0.0], [0.0], [0.0], [1.0]]), frames[:-1]
        if self.links is not None:
            above = columns.multiply(above, self.links)
        return columns.multiply(columns.conjugate(above), frames)


def chain_frames(turns: Array, offsets: Array, links: Array | None) -> tuple[Array, Array]:
    """Return base-frame rotations (joints, 4, batch) and points (joints + 1, 3, batch)."""
    frames = np.empty_like(turns)
    above = columns.identities(turns.shape[-1])
    for joint, turn in enumerate(turns):
        if links is not None:
            above = columns.multiply(above, links[joint])
        frames[joint] = above = columns.multiply(above, turn)
    return frames, columns.running_sum(columns.rotate(frames, offsets))


Solved = tuple[Array, Array, NDArray[np.intp]]
"""Rotations (joints, 4, batch), points (joints + 1, 3, batch) [m] and iterations (batch,)."""


class Solver(Protocol):
    """A method of inverse kinematics: one entry of `SOLVERS`."""

    def __call__(self, task: Task) -> Solved:
        """Return rotations within the limits."""


Arrays = tuple[Array, ...]
"""State of a batch; the batch is the last axis of each array."""


def until_done(
    step: Callable[[Arrays], tuple[Arrays, NDArray[np.bool_]]], state: Arrays, most: int
) -> tuple[Arrays, NDArray[np.intp]]:
    """Repeat a step, for each chain until it is done, at most so often; return states and counts.

    `step` takes the state of what is left; it returns the next state and which chains are done.
    Those take no part in later steps.
    """
    count = state[0].shape[-1]
    counts = np.full(count, most, np.intp)
    results = tuple(np.empty_like(array) for array in state)
    left = np.arange(count)
    waiting = np.ones(count, bool)
    for number in range(most):
        state, done = step(state)
        done &= waiting
        if done.any():
            which = left[done]
            counts[which] = number + 1
            for result, array in zip(results, state, strict=True):
                result[..., which] = array[..., done]
            waiting &= ~done
            remaining = np.count_nonzero(waiting)
            if remaining == 0:
                return results, counts
            if remaining <= (1 - _MIN_DROPPED) * len(left):
                left = left[waiting]
                state = tuple(array[..., waiting] for array in state)
                waiting = np.ones(len(left), bool)
    for result, array in zip(results, state, strict=True):
        result[..., left[waiting]] = array[..., waiting]
    return results, counts
