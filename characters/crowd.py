"""Global matrices of many poses at once.

The walk down the skeleton goes by depth: all joints of one depth, of all poses, in a few products.
Arrays lie component by component, with the poses innermost, so that each product runs over memory
in a straight line.
"""

from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from characters.pose import Pose, Skeleton

Floats = NDArray[Any]
Numbers = NDArray[np.intp]


@dataclass(frozen=True)
class _Level:
    """The joints of one depth."""

    place: slice
    """Where they are in the order of depth."""

    parents: Numbers
    """Where their parents are in it, (joints of the level,)."""


@dataclass(frozen=True)
class _Order:
    """Joints sorted by depth."""

    joints: Numbers
    """Number of the joint at each place, (joints,)."""

    places: Numbers
    """Place of each joint, (joints,)."""

    levels: tuple[_Level, ...]
    """Below the roots, from the top down."""


def globals_of_many(pose: Pose, skeleton: Skeleton) -> Floats:
    """Return `character_from_joint` of every joint of many poses, (poses, joints, 3, 4).

    The last row of each matrix, (0, 0, 0, 1), is left out. For one pose `Pose.globals` is faster.

    Parameters
    ----------
    pose
        (poses, joints, …), of any precision; the result has the same.
    skeleton
        Of all of them.
    """
    order = _order(skeleton.parents)
    count, joints = pose.rotations.shape[:2]
    matrices = np.empty((3, 4, joints, count), pose.rotations.dtype)
    _rotate(np.ascontiguousarray(pose.rotations.transpose(2, 1, 0)[:, order.joints]), matrices)
    if pose.scales is not None:
        matrices[:, :3] *= pose.scales.transpose(2, 1, 0)[:, order.joints]
    matrices[:, 3] = pose.translations.transpose(2, 1, 0)[:, order.joints]
    for level in order.levels:
        above = matrices[:, :, level.parents]
        here = matrices[:, :, level.place]
        below = above[:, 0, None] * here[0]
        below += above[:, 1, None] * here[1]
        below += above[:, 2, None] * here[2]
        below[:, 3] += above[:, 3]
        matrices[:, :, level.place] = below
    return matrices[:, :, order.places].transpose(3, 2, 0, 1)


def _rotate(q: Floats, matrices: Floats) -> None:
    """Write rotation matrices of quaternions (4, joints, poses) into (3, 4, joints, poses)."""
    _, y, z, w = q
    double = q[:3] * 2
    xx, yy, zz = double * q[:3]
    xy, xz, yz = double[0] * y, double[0] * z, double[1] * z
    wx, wy, wz = double * w
    matrices[0, 0] = 1 - (yy + zz)
    matrices[1, 1] = 1 - (xx + zz)
    matrices[2, 2] = 1 - (xx + yy)
    np.subtract(xy, wz, out=matrices[0, 1])
    np.add(xy, wz, out=matrices[1, 0])
    np.add(xz, wy, out=matrices[0, 2])
    np.subtract(xz, wy, out=matrices[2, 0])
    np.subtract(yz, wx, out=matrices[1, 2])
    np.add(yz, wx, out=matrices[2, 1])


@lru_cache(maxsize=64)
def _order(parents: tuple[int, ...]) -> _Order:
    """Return the joints by depth; a parent comes before its children already."""
    depths: list[int] = []
    for parent in parents:
        depths.append(0 if parent < 0 else depths[parent] + 1)
    depth = np.array(depths)
    joints = np.argsort(depth, kind="stable")
    places = np.argsort(joints, kind="stable")
    edges = np.searchsorted(depth[joints], np.arange(depth.max(initial=0) + 2))
    levels = []
    for start, end in pairwise(edges[1:]):
        own = joints[start:end]
        levels.append(_Level(slice(int(start), int(end)), places[np.array(parents)[own]]))
    return _Order(joints, places, tuple(levels))
