"""Turns that are told about the body's axes, in the frames of its joints."""

import numpy as np
from numpy.typing import NDArray

from characters.skeleton.pose import Array, Skeleton


def body_axes(skeleton: Skeleton, joints: NDArray[np.intp]) -> Array:
    """Return the body's axes at rest in the frames of joints, (n, 3, 3), a column each."""
    turns = skeleton.rest.globals(skeleton)[joints, :3, :3]
    lengths = np.linalg.norm(turns, axis=1, keepdims=True)
    axes: Array = np.swapaxes(turns / np.where(lengths > 0, lengths, 1.0), -1, -2)
    return axes


def turned(axes: Array, degrees: list[tuple[float, float, float]]) -> Array:
    """Return rotation vectors in joints' frames, (n, 3), of turns about the body's axes.

    `axes` is what `body_axes` gives, (n, 3, 3); the degrees are about x to the left, y up and
    z forward.
    """
    wanted = np.radians(np.array(degrees).reshape(-1, 3))
    vectors: Array = np.einsum("jkb,jb->jk", axes, wanted)
    return vectors
