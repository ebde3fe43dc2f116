"""Solvers by the Jacobian of the Euler angles: transpose, pseudo-inverse, damped least squares.

Each joint has three axes; column i of the Jacobian is `a_i × (end − p_i)` (S18). An angle at a
limit that would go beyond it is held, and the step is computed again without it, so the others take
its part (active set).
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from characters.ik.solvers import columns
from characters.ik.solvers.task import Arrays, Bounds, Task, until_done
from characters.skeleton.pose import Array

Rule = Callable[[Array, Array], Array]
"""From J Jᵀ as (xx, yy, zz, xy, xz, yz), (6, batch), and errors (3, batch), to a factor of Jᵀ."""


def transpose(gram: Array, error: Array) -> Array:
    """Return α e, with α = e·JJᵀe / JJᵀe·JJᵀe (Buss 2004)."""
    pushed = _times(gram, error)
    scale = columns.dot(error, pushed) / np.maximum(columns.dot(pushed, pushed), columns.TINY**2)
    step: Array = scale * error
    return step


def pseudo_inverse(gram: Array, error: Array) -> Array:
    """Return (J Jᵀ)⁻¹ e; the damping only keeps singular matrices invertible."""
    return _solved(gram, error, 1e-9 * gram[:3].sum(0))


@dataclass(frozen=True)
class DampedLeastSquares:
    """The rule (J Jᵀ + λ² I)⁻¹ e, whose damping falls with the error (Sugihara 2011)."""

    damping: float = 0.05
    """λ² over the squared error."""

    floor: float = 1e-6
    """Least λ² over the trace of J Jᵀ."""

    def __call__(self, gram: Array, error: Array) -> Array:
        """Return what Jᵀ multiplies."""
        damping = self.damping * columns.dot(error, error) + self.floor * gram[:3].sum(0)
        return _solved(gram, error, damping)


@dataclass(frozen=True)
class JacobianSolver:
    """Steps of the angles by a rule."""

    rule: Rule
    """Makes a step of the error."""

    max_iterations: int = 100
    """Most steps."""

    max_turn: float = 0.8
    """Most that an angle changes in a step [rad]: the Jacobian does not see farther."""

    def __call__(self, task: Task) -> tuple[Array, NDArray[np.intp]]:
        """Return rotations (joints, 4, batch), within the limits, and steps (batch,)."""
        angles = columns.to_euler(task.start)
        bounds = task.bounds
        if bounds is not None:
            angles = np.clip(angles, bounds.low, bounds.high)
        state = (angles, angles, np.full(task.count, np.inf), task.offsets, task.targets,
                 task.tolerance)  # fmt: skip

        def step(number: int, state: Arrays) -> tuple[Arrays, NDArray[np.bool_]]:
            angles, best, least, offsets, targets, tolerance = state
            axes, points = _axes(task.links, angles, offsets)
            error = targets - points[-1]
            size = columns.length(error)
            better = size < least
            best, least = np.where(better, angles, best), np.where(better, size, least)
            angles = angles + self._change(bounds, angles, axes, points, error)
            if bounds is not None:
                angles = np.clip(angles, bounds.low, bounds.high)
            return (angles, best, least, offsets, targets, tolerance), size <= tolerance

        (_, best, *_), used = until_done(step, state, self.max_iterations)
        return columns.from_euler(best), used - 1

    def _change(
        self, bounds: Bounds | None, angles: Array, axes: Array, points: Array, error: Array
    ) -> Array:
        """Return the change of the angles, (joints, 3, batch)."""
        arms = points[-1] - points[:-1]
        jacobian = columns.cross(axes, arms[:, None])  # (joints, 3 angles, 3, batch)
        change = self._rows(jacobian, error)
        if bounds is not None:
            low, high = angles <= bounds.low, angles >= bounds.high
            held = (low & (change < 0)) | (high & (change > 0))
            which = np.flatnonzero(held.any((0, 1)))
            if len(which):
                free = jacobian[..., which] * ~held[..., None, which]
                change[..., which] = self._rows(free, error[..., which])
        largest = np.abs(change).max((0, 1))
        change *= np.minimum(1.0, self.max_turn / np.maximum(largest, columns.TINY))
        return change

    def _rows(self, jacobian: Array, error: Array) -> Array:
        x, y, z = jacobian[:, :, 0], jacobian[:, :, 1], jacobian[:, :, 2]
        pairs = ((x, x), (y, y), (z, z), (x, y), (x, z), (y, z))
        gram = np.stack([np.einsum("jab,jab->b", a, b) for a, b in pairs])
        return columns.dot(jacobian, self.rule(gram, error))


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
            x, y, z = _linked(links[joint], (x, y, z))
        axes[joint, 2] = z
        x, y = cosine[2] * x + sine[2] * y, cosine[2] * y - sine[2] * x
        axes[joint, 1] = y
        x, z = cosine[1] * x - sine[1] * z, cosine[1] * z + sine[1] * x
        axes[joint, 0] = x
        y, z = cosine[0] * y + sine[0] * z, cosine[0] * z - sine[0] * y
        bone = offsets[joint]
        points[joint + 1] = points[joint] + bone[0] * x + bone[1] * y + bone[2] * z
    return axes, points


def _linked(link: Array, basis: tuple[Array, Array, Array]) -> list[Array]:
    """Return the columns of a rotation followed by a fixed one, given as quaternion (4, 1)."""
    fixed = [columns.rotate(link, axis[:, None]) for axis in np.eye(3)]
    x, y, z = basis
    return [column[0] * x + column[1] * y + column[2] * z for column in fixed]


def _times(gram: Array, v: Array) -> Array:
    """Return J Jᵀ v."""
    xx, yy, zz, xy, xz, yz = gram
    a, b, c = v
    return np.stack([xx * a + xy * b + xz * c, xy * a + yy * b + yz * c, xz * a + yz * b + zz * c])


def _solved(gram: Array, error: Array, damping: Array) -> Array:
    """Return (J Jᵀ + λ² I)⁻¹ e by the adjugate."""
    xx, yy, zz, xy, xz, yz = gram
    xx, yy, zz = xx + damping, yy + damping, zz + damping
    a, b, c = yy * zz - yz * yz, xz * yz - xy * zz, xy * yz - xz * yy
    d, e, f = xx * zz - xz * xz, xy * xz - xx * yz, xx * yy - xy * xy
    determinant = xx * a + xy * b + xz * c
    solved = _times(np.stack([a, d, f, b, c, e]), error)
    step: Array = solved / np.maximum(determinant, columns.TINY**3)
    return step
