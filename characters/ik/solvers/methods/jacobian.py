"""Solvers by the Jacobian, without and with joint limits.

Without limits each joint turns about any axis: its part of the Jacobian is `ω × (end − p)`, and the
points alone are enough. Where they leave a
limit, the unknowns are the Euler angles, column i of the Jacobian is
`a_i × (end − p_i)` (S18), and an angle at a limit that would go beyond it is held while the step is
computed again without it, so that the others take its part (active set).
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.ik.solvers import columns
from cubeling.characters.ik.solvers.methods.positional import PositionalSolver
from cubeling.characters.ik.solvers.rules import Rule
from cubeling.characters.ik.solvers.task import Arrays, Bounds, Solved, Task, until_done
from cubeling.characters.skeleton.pose import Array

MAX_STEPS = 60
"""Most steps of a Jacobian method."""

MAX_TURN_RAD = 1.2
"""Most that an angle changes in a step: the Jacobian does not see farther."""


@dataclass(frozen=True)
class JacobianSolver:
    """Steps by a rule: of points without limits, of Euler angles with them."""

    rule: Rule
    """Makes a step of the error."""

    max_steps: int = MAX_STEPS
    """Number of steps after which it gives up."""

    def __call__(self, task: Task) -> Solved:
        """Return rotations within the limits."""
        free = PositionalSolver(JacobianMover(self.rule, self.max_steps), max_loops=1)
        turns, points, used = free(replace(task, bounds=None))
        if task.bounds is not None:
            _, events = task.bounds.cut(turns)
            beyond = np.flatnonzero(events.any(0))
            part = task.select(beyond)
            again, more = _with_limits(
                self.rule, self.max_steps, part, task.bounds, turns[..., beyond]
            )
            turns[..., beyond], points[..., beyond] = again, part.frames(again)[1]
            used[beyond] += more
        return turns, points, used


@dataclass(frozen=True)
class JacobianMover:
    """Moves points by turning all bones of a chain at once."""

    rule: Rule
    """Makes a step of the error."""

    max_steps: int = MAX_STEPS
    """Number of steps after which it gives up."""

    def __call__(self, points: Array, task: Task) -> tuple[Array, NDArray[np.intp]]:
        """Return points (joints + 1, 3, batch), of the right lengths, and steps (batch,)."""
        state = points, task.targets, task.tolerance
        (moved, *_), used = until_done(self._step, state, self.max_steps)
        return moved, used

    def _step(self, state: Arrays) -> tuple[Arrays, NDArray[np.bool_]]:
        points, targets, tolerance = state
        arms = points[-1] - points[:-1]
        pull = self.rule(_ball_gram(arms), targets - points[-1])
        # A bone turns by what its joint and all joints before it turn.
        turns = columns.running_sum(columns.cross(arms, pull[None]))[1:]
        moved = columns.running_sum(_turn(np.diff(points, axis=0), turns))
        near = columns.length(moved[-1] - targets) <= tolerance
        return (moved, targets, tolerance), near


def _ball_gram(arms: Array) -> Array:
    """Return J Jᵀ of joints that turn about any axis: the sum of |r|² I − r rᵀ, (6, batch)."""
    x, y, z = arms[:, 0], arms[:, 1], arms[:, 2]
    xx, yy, zz = (np.einsum("jb,jb->b", a, a) for a in (x, y, z))
    xy, xz, yz = (np.einsum("jb,jb->b", a, b) for a, b in ((x, y), (x, z), (y, z)))
    return np.stack([yy + zz, xx + zz, xx + yy, -xy, -xz, -yz])


def _turn(vectors: Array, turns: Array) -> Array:
    """Return vectors turned by about the rotation vectors `turns`, with their lengths unchanged.

    By the Cayley map, a rotation by 2 atan(angle / 2): it needs no sine, and turns that are too
    large for the Jacobian become smaller.
    """
    half = 0.5 * turns
    first = columns.cross(half, vectors)
    first += columns.cross(half, first)
    first *= (2.0 / (1.0 + columns.dot(half, half)))[:, None]
    first += vectors
    return first


def _with_limits(
    rule: Rule, max_steps: int, task: Task, bounds: Bounds, start: Array
) -> tuple[Array, NDArray[np.intp]]:
    angles = np.clip(columns.to_euler(start), bounds.low, bounds.high)
    least = np.full(task.count, np.inf)
    state = angles, angles, least, task.offsets, task.targets, task.tolerance

    def step(state: Arrays) -> tuple[Arrays, NDArray[np.bool_]]:
        angles, best, least, offsets, targets, tolerance = state
        axes, points = _axes(task.links, angles, offsets)
        error = targets - points[-1]
        size = columns.length(error)
        better = size < least
        best, least = np.where(better, angles, best), np.where(better, size, least)
        change = _change(rule, bounds, angles, axes, points[-1] - points[:-1], error)
        angles = np.clip(angles + change, bounds.low, bounds.high)
        return (angles, best, least, offsets, targets, tolerance), size <= tolerance

    (_, best, *_), used = until_done(step, state, max_steps)
    return columns.from_euler(best), used - 1


def _change(
    rule: Rule, bounds: Bounds, angles: Array, axes: Array, arms: Array, error: Array
) -> Array:
    """Return the change of the angles, (joints, 3, batch) [rad]."""
    jacobian = columns.cross(axes, arms[:, None])  # (joints, 3 angles, 3, batch)
    change = _rows(rule, jacobian, error)
    low, high = angles <= bounds.low, angles >= bounds.high
    held = (low & (change < 0)) | (high & (change > 0))
    which = np.flatnonzero(held.any((0, 1)))
    if len(which):
        free = jacobian[..., which] * ~held[..., None, which]
        change[..., which] = _rows(rule, free, error[..., which])
    largest = np.abs(change).max((0, 1))
    change *= np.minimum(1.0, MAX_TURN_RAD / np.maximum(largest, columns.TINY))
    return change


def _rows(rule: Rule, jacobian: Array, error: Array) -> Array:
    x, y, z = jacobian[:, :, 0], jacobian[:, :, 1], jacobian[:, :, 2]
    pairs = ((x, x), (y, y), (z, z), (x, y), (x, z), (y, z))
    gram = np.stack([np.einsum("jab,jab->b", a, b) for a, b in pairs])
    return columns.dot(jacobian, rule(gram, error))


def _axes(links: Array | None, angles: Array, offsets: Array) -> tuple[Array, Array]:
    """Return the axes of the angles (φ, θ, ψ), (joints, 3, 3, batch), and points.

    The three columns of the base-frame rotation are turned in pairs, which takes a third of the
    operations of quaternion products.
    """
    sines, cosines = np.sin(angles), np.cos(angles)
    count = angles.shape[-1]
    axes = np.empty((len(angles), 3, 3, count))
    points = np.zeros((len(angles) + 1, 3, count))
    x, y, z = (np.broadcast_to(row[:, None], (3, count)) for row in np.eye(3))
    for joint, (sine, cosine) in enumerate(zip(sines, cosines, strict=True)):
        if links is not None:
            x, y, z = _link(links[joint], (x, y, z))
        axes[joint, 2] = z
        x, y = cosine[2] * x + sine[2] * y, cosine[2] * y - sine[2] * x
        axes[joint, 1] = y
        x, z = cosine[1] * x - sine[1] * z, cosine[1] * z + sine[1] * x
        axes[joint, 0] = x
        y, z = cosine[0] * y + sine[0] * z, cosine[0] * z - sine[0] * y
        bone = offsets[joint]
        points[joint + 1] = points[joint] + bone[0] * x + bone[1] * y + bone[2] * z
    return axes, points


def _link(link: Array, basis: tuple[Array, Array, Array]) -> list[Array]:
    """Return the columns of a rotation followed by a fixed one, given as quaternion (4, 1)."""
    fixed = [columns.rotate(link, axis[:, None]) for axis in np.eye(3)]
    x, y, z = basis
    return [column[0] * x + column[1] * y + column[2] * z for column in fixed]
