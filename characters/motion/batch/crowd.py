"""Where the joints of many characters are, all at once.

The walk down the skeleton goes by depth: all joints of one depth, of all characters, in a few
products. Characters lie innermost in memory meanwhile, so that each product runs over it in a
straight line.
"""

from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise
from typing import Any

import cv2
import numpy as np
from numpy.typing import ArrayLike, NDArray

from characters.motion.batch.bank import Bank
from characters.skeleton.pose import Pose, Skeleton

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


def crowd_globals(bank: Bank, clips: ArrayLike, times: ArrayLike, weights: ArrayLike) -> Floats:
    """Return `character_from_joint` of many characters that each mix some clips.

    The same as `globals_of_many` of `Bank.sample`, in less time.

    Parameters
    ----------
    bank
        The clips.
    clips, times
        What each character plays and when [s], (characters, voices).
    weights
        How much of each, (characters, voices); each row sums to one.

    Returns
    -------
    ndarray
        (characters, joints, 3, 4); the last row of each matrix, (0, 0, 0, 1), is left out.
    """
    rows = bank.mixed(clips, times, weights)
    columns = _innermost(rows)
    joints = len(bank.skeleton)
    turned, shifted, sized, _ = bank.edges
    turns = columns[:turned].reshape(joints, 4, -1)
    turns = turns / np.sqrt(np.einsum("jkn,jkn->jn", turns, turns))[:, None]
    shifts = _filled(bank.still.translations, bank.moved, columns[turned:shifted])
    stretched, scales = bank.stretched, None
    if bank.still.scales is not None:
        scales = _filled(bank.still.scales, bank.scaled, columns[shifted:sized])[stretched]
    return _globals(turns, shifts, scales, stretched, bank.skeleton)


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
    count, joints = pose.rotations.shape[:2]
    turns, shifts = (
        _innermost(part.reshape(count, -1)).reshape(joints, -1, count)
        for part in (pose.rotations, pose.translations)
    )
    scales = None
    if pose.scales is not None:
        scales = _innermost(pose.scales.reshape(count, -1)).reshape(joints, 3, count)
    return _globals(turns, shifts, scales, np.arange(joints), skeleton)


def _globals(
    turns: Floats, shifts: Floats, scales: Floats | None, stretched: Numbers, skeleton: Skeleton
) -> Floats:
    """Return matrices (characters, joints, 3, 4) of locals (joints, 4 or 3, characters).

    The scales are those of the joints `stretched` (n,) alone.
    """
    order = _order(skeleton.parents)
    joints, _, count = turns.shape
    # Joints of a depth lie side by side, under each component: one long line for each product.
    matrices = np.empty((3, 4, joints, count), turns.dtype)
    _rotate(turns.swapaxes(0, 1)[:, order.joints], matrices)
    if scales is not None:
        matrices[:, :3, order.places[stretched]] *= scales.swapaxes(0, 1)
    matrices[:, 3] = shifts.swapaxes(0, 1)[:, order.joints]
    for level in order.levels:
        above, here = matrices[:, :, level.parents], matrices[:, :, level.place]
        below = above[:, 0, None] * here[0]
        part = above[:, 1, None] * here[1]
        below += part
        np.multiply(above[:, 2, None], here[2], out=part)
        below += part
        below[:, 3] += above[:, 3]
        matrices[:, :, level.place] = below
    sorted_back = matrices.transpose(2, 0, 1, 3)[order.places]
    return _innermost(sorted_back.reshape(-1, count)).reshape(count, joints, 3, 4)


def _rotate(q: Floats, matrices: Floats) -> None:
    """Write rotation matrices of quaternions (4, joints, n) into (3, 4, joints, n)."""
    _, y, z, w = q
    double = q[:3] * 2
    xx, yy, zz = double * q[:3]
    xy, xz, yz = double[0] * y, double[0] * z, double[1] * z
    wx, wy, wz = double * w
    for row, (a, b) in enumerate(((yy, zz), (xx, zz), (xx, yy))):
        np.subtract(1.0, a + b, out=matrices[row, row])
    np.subtract(xy, wz, out=matrices[0, 1])
    np.add(xy, wz, out=matrices[1, 0])
    np.add(xz, wy, out=matrices[0, 2])
    np.subtract(xz, wy, out=matrices[2, 0])
    np.subtract(yz, wx, out=matrices[1, 2])
    np.add(yz, wx, out=matrices[2, 1])


def _filled(still: Floats, moved: Numbers, columns: Floats) -> Floats:
    """Return numbers (joints, 3) for all characters, (joints, 3, n), some of them moved."""
    everyone = np.repeat(still[..., None], columns.shape[1], axis=2)
    everyone[moved] = columns.reshape(len(moved), 3, -1)
    return everyone


def _innermost(rows: Floats) -> Floats:
    """Return a matrix transposed, in its own memory; OpenCV does it block by block."""
    return np.asarray(cv2.transpose(rows)) if rows.size else np.zeros(rows.shape[::-1], rows.dtype)


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
