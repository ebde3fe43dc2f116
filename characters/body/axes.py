"""Turns about the body's axes, in the frames of its joints."""

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.skeleton.pose import Array, Skeleton

Degrees = tuple[float, float, float]
"""A turn about the body's axes [degrees]: x to the left, y up, z forward."""


def body_axes(skeleton: Skeleton, joints: NDArray[np.intp]) -> Array:
    """Return the body's axes at rest in the frames of joints, (n, 3, 3), one axis a column."""
    turns = skeleton.rest.globals(skeleton)[joints, :3, :3]
    lengths = np.linalg.norm(turns, axis=1, keepdims=True)
    axes: Array = np.swapaxes(turns / np.where(lengths > 0, lengths, 1.0), -1, -2)
    return axes


def rotation_vectors(axes: Array, degrees: list[Degrees]) -> Array:
    """Return turns about the body's axes as rotation vectors in the joints' frames, (n, 3) [rad].

    `axes` is the result of `body_axes`, (n, 3, 3).
    """
    turns = np.radians(np.array(degrees).reshape(-1, 3))
    vectors: Array = np.einsum("jkb,jb->jk", axes, turns)
    return vectors
