"""Inverse kinematics of a limb of two bones with a hinge between them, over many frames."""

import numpy as np
from numpy.typing import ArrayLike

from cubeling.characters.skeleton import rotations
from tools.authoring.modelling.shapes import Array


def hinge_position(start: Array, end: Array, pole: Array, upper: float, lower: float) -> Array:
    """Return the position of the hinge, (…, 3), by the law of cosines.

    Parameters
    ----------
    start, end : ends of the limb, (…, 3) [m]; towards an end out of reach it is straight
    pole : direction towards which the hinge bends, (…, 3)
    upper, lower : lengths of the two bones [m]

    >>> hip, ankle, forward = np.array([[0, 2.0, 0], [0, 0, 0], [0, 0, 1]])
    >>> hinge_position(hip, ankle, forward, 1.25, 1.25).round(6).tolist()
    [0.0, 1.0, 0.75]
    """
    line = end - start
    reach = np.linalg.norm(line, axis=-1, keepdims=True)
    line = line / np.maximum(reach, 1e-9)
    reach = np.clip(reach, abs(upper - lower) + 1e-6, upper + lower - 1e-9)
    along = (upper**2 - lower**2 + reach**2) / (2 * reach)
    out = np.sqrt(np.maximum(upper**2 - along**2, 0.0))
    across = pole - line * np.sum(pole * line, axis=-1, keepdims=True)
    across = across / np.maximum(np.linalg.norm(across, axis=-1, keepdims=True), 1e-9)
    return np.asarray(start + along * line + out * across)


def aim_rotation(rest_bone: ArrayLike, rest_hinge: ArrayLike, bone: Array, hinge: Array) -> Array:
    """Return the rotation (…, 4) that takes a bone and its hinge axis from rest to a pose.

    Only the component of a hinge axis perpendicular to its bone counts.
    """
    rest, posed = _frame(np.asarray(rest_bone), np.asarray(rest_hinge)), _frame(bone, hinge)
    return rotations.from_matrix(posed @ np.swapaxes(rest, -1, -2))


def _frame(bone: Array, hinge: Array) -> Array:
    """Return a right-handed orthonormal frame, (…, 3, 3), its first axis along the bone."""
    first = bone / np.linalg.norm(bone, axis=-1, keepdims=True)
    third = np.cross(first, hinge)
    third = third / np.linalg.norm(third, axis=-1, keepdims=True)
    return np.stack([first, np.cross(third, first), third], axis=-1)
