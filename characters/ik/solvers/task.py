"""One batch of chains and targets, as solvers work on it: with the batch as the last axis."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Literal, Protocol

import numpy as np
from numpy.typing import NDArray

from characters.ik.solvers import columns
from characters.ik.solvers.chains import Chains
from characters.skeleton import rotations
from characters.skeleton.pose import Array

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

    The rotations are those between the axes of the limits: `before` and `after` of `JointLimits`
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
        """Return the task of chains, targets (batch, 3) and local rotations (batch, joints, 4)."""
        count = len(targets)
        offsets = np.broadcast_to(chains.offsets, (count, chains.joints, 3))
        lengths = np.broadcast_to(chains.lengths, (count, chains.joints))
        links = bounds = None
        if chains.limits is not None:
            limits = chains.limits
            before, after = limits.before, limits.after
            inner = rotations.multiply(rotations.conjugate(before), start)
            start = rotations.multiply(inner, rotations.conjugate(after))
            offsets = rotations.rotate(after, offsets)
            above = np.concatenate([rotations.IDENTITY[None], after[:-1]])
            links = rotations.multiply(above, before)[..., None]
            if np.allclose(np.abs(links[:, 3]), 1.0, atol=1e-12):
                links = None
            if limiting is not None:
                bounds = Bounds(limits.low[..., None], limits.high[..., None])
        return Task(
            columns.to_columns(offsets),
            columns.to_columns(lengths),
            links,
            columns.to_columns(start),
            columns.to_columns(targets),
            tolerance,
            bounds,
            limiting or "propagate",
        )

    @property
    def joints(self) -> int:
        """Number of joints of each chain."""
        return len(self.lengths)

    @property
    def count(self) -> int:
        """Number of chains."""
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
            targets=self.targets[..., which],
            tolerance=self.tolerance[which],
        )

    def local_rotations(self, turns: Array, chains: Chains) -> Array:
        """Return rotations (joints, 4, batch) as local ones of the chains, (batch, joints, 4)."""
        rows = columns.to_rows(turns)
        if chains.limits is None:
            return rows
        inner = rotations.multiply(chains.limits.before, rows)
        return rotations.multiply(inner, chains.limits.after)

    def frames(self, turns: Array) -> tuple[Array, Array]:
        """Return base-frame rotations (joints, 4, batch) and points (joints + 1, 3, batch)."""
        frames = np.empty_like(turns)
        points = np.zeros((self.joints + 1, 3, turns.shape[-1]))
        for joint in range(self.joints):
            frames[joint] = self.below(frames, joint, turns[joint])
            bone = columns.rotate(frames[joint], self.offsets[joint])
            np.add(points[joint], bone, out=points[joint + 1])
        return frames, points

    def below(self, frames: Array, joint: int, turn: Array) -> Array:
        """Return the base-frame rotation of a joint with a rotation, from those above it."""
        if joint == 0:
            return turn if self.links is None else columns.multiply(self.links[0], turn)
        return columns.multiply(self.zero_frame(frames, joint), turn)

    def zero_frame(self, frames: Array, joint: int) -> Array:
        """Return the base-frame rotation of the axes of a joint (not the first) at zero."""
        above = frames[joint - 1]
        return above if self.links is None else columns.multiply(above, self.links[joint])

    def turns(self, frames: Array) -> Array:
        """Return the rotations of the joints from their base-frame rotations."""
        above = np.empty_like(frames)
        above[0], above[1:] = np.array([[0.0], [0.0], [0.0], [1.0]]), frames[:-1]
        if self.links is not None:
            above = columns.multiply(above, self.links)
        return columns.multiply(columns.conjugate(above), frames)


class Solver(Protocol):
    """A method of inverse kinematics: one entry of `SOLVERS`."""

    def __call__(self, task: Task) -> tuple[Array, NDArray[np.intp]]:
        """Return rotations (joints, 4, batch), within the limits, and iterations (batch,)."""


Arrays = tuple[Array, ...]
"""State of a batch; the batch is the last axis of each array."""


def until_done(
    step: Callable[[int, Arrays], tuple[Arrays, NDArray[np.bool_]]], state: Arrays, most: int
) -> tuple[Arrays, NDArray[np.intp]]:
    """Repeat a step, for each chain until it is done, at most so often; return states and counts.

    `step` takes the number of the step and the state of what is left; it returns the next state and
    which chains are done. Those take no part in later steps.
    """
    count = state[0].shape[-1]
    counts = np.full(count, most, np.intp)
    results = tuple(np.empty_like(array) for array in state)
    left = np.arange(count)
    waiting = np.ones(count, bool)
    for number in range(most):
        state, done = step(number, state)
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
