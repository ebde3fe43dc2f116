"""How the errors of a Jacobian method become a step: transpose, pseudo-inverse, damped (S18).

A rule maps J Jᵀ, which is symmetric and 3 × 3, and the error e to what Jᵀ multiplies. J Jᵀ is given
as its elements (xx, yy, zz, xy, xz, yz), (6, batch).
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from cubeling.characters.ik.solvers import columns
from cubeling.characters.skeleton.pose import Array
from cubeling.characters.skeleton.scalar_quaternions import Vector

Rule = Callable[[Array, Array], Array]
"""From J Jᵀ (6, batch) and errors (3, batch) to the vectors that Jᵀ multiplies, (3, batch)."""


DAMPING = 0.03
"""λ² over the squared error."""

MIN_DAMPING_SHARE = 1e-6
"""Least λ² over the trace of J Jᵀ, which keeps it invertible."""


def transpose(gram: Array, error: Array) -> Array:
    """Return α e, with α = e·JJᵀe / JJᵀe·JJᵀe (Buss 2004)."""
    pushed = np.stack(_times(gram, error))
    scale = columns.dot(error, pushed) / np.maximum(columns.dot(pushed, pushed), columns.TINY**2)
    step: Array = scale * error
    return step


def pseudo_inverse(gram: Array, error: Array) -> Array:
    """Return (J Jᵀ)⁻¹ e; the damping only keeps singular matrices invertible."""
    return _solve(gram, error, 1e-9 * (gram[0] + gram[1] + gram[2]))


@dataclass(frozen=True)
class Damped:
    """The rule (J Jᵀ + λ² I)⁻¹ e, whose damping falls with the error (Sugihara 2011)."""

    damping: float = DAMPING
    """λ² over the squared error."""

    floor: float = MIN_DAMPING_SHARE
    """Least λ² over the trace of J Jᵀ."""

    def __call__(self, gram: Array, error: Array) -> Array:
        """Return what Jᵀ multiplies."""
        trace = gram[0] + gram[1] + gram[2]
        return _solve(gram, error, self.damping * columns.dot(error, error) + self.floor * trace)


def damped_pull(gram: Sequence[float], error: Vector) -> Vector:
    """Return what `Damped()` does for one chain, in scalars."""
    xx, yy, zz, xy, xz, yz = gram
    p, q, r = error
    damping = DAMPING * (p * p + q * q + r * r) + MIN_DAMPING_SHARE * (xx + yy + zz)
    xx, yy, zz = xx + damping, yy + damping, zz + damping
    a, b, c = yy * zz - yz * yz, xz * yz - xy * zz, xy * yz - xz * yy
    d, e, f = xx * zz - xz * xz, xy * xz - xx * yz, xx * yy - xy * xy
    size = 1.0 / max(xx * a + xy * b + xz * c, 1e-36)
    return (
        (a * p + b * q + c * r) * size,
        (b * p + d * q + e * r) * size,
        (c * p + e * q + f * r) * size,
    )


def _times(gram: Array, v: Array) -> tuple[Array, Array, Array]:
    """Return the product of a symmetric matrix and a vector."""
    xx, yy, zz, xy, xz, yz = gram
    a, b, c = v
    return xx * a + xy * b + xz * c, xy * a + yy * b + yz * c, xz * a + yz * b + zz * c


def _solve(gram: Array, error: Array, damping: Array) -> Array:
    """Return (J Jᵀ + λ² I)⁻¹ e by the adjugate."""
    xx, yy, zz, xy, xz, yz = gram
    xx, yy, zz = xx + damping, yy + damping, zz + damping
    a, b, c = yy * zz - yz * yz, xz * yz - xy * zz, xy * yz - xz * yy
    d, e, f = xx * zz - xz * xz, xy * xz - xx * yz, xx * yy - xy * xy
    inverse = 1.0 / np.maximum(xx * a + xy * b + xz * c, columns.TINY**3)
    p, q, r = error * inverse
    return np.stack([a * p + b * q + c * r, b * p + d * q + e * r, c * p + e * q + f * r])
