"""Global joint transforms of many characters at once, depth by depth.

Characters are the innermost axis, so that the products run over contiguous memory.
"""

from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise
from typing import Any

import cv2
import numpy as np
from numpy.typing import ArrayLike, NDArray

from cubeling.characters.motion.batch.bank import ClipBank
from cubeling.characters.skeleton.pose import Skeleton

Floats = NDArray[Any]
Indices = NDArray[np.intp]


@dataclass(frozen=True)
class _DepthOrder:
    """Joints sorted by depth."""

    joints: Indices
    """Joint number at each position, (joints,)."""

    positions: Indices
    """Position of each joint, (joints,)."""

    levels: tuple[tuple[slice, Indices], ...]
    """Positions of the joints and of their parents in each depth below the roots."""


def crowd_globals(bank: ClipBank, clips: ArrayLike, times: ArrayLike, weights: ArrayLike) -> Floats:
    """Return `character_from_joint` of many characters, each of which mixes some clips.

    Equal to `Pose.globals` of `ClipBank.sample`, with the same arguments, but faster. The shape is
    (characters, joints, 3, 4): the last row of each matrix, (0, 0, 0, 1), is left out.
    """
    rows = bank.mixed_rows(clips, times, weights)
    columns = _transpose(rows)
    joints = len(bank.skeleton)
    turned, shifted, sized, _ = bank.column_ends
    turns = columns[:turned].reshape(joints, 4, -1)
    turns = turns / np.sqrt(np.einsum("jkn,jkn->jn", turns, turns))[:, None]
    shifts = _with_constants(bank.constant.translations, bank.moving, columns[turned:shifted])
    scaled, scales = bank.non_unit_scale, None
    if bank.constant.scales is not None:
        scales = _with_constants(bank.constant.scales, bank.scaling, columns[shifted:sized])[scaled]
    return _globals(turns, shifts, scales, scaled, bank.skeleton)


def _globals(
    turns: Floats, shifts: Floats, scales: Floats | None, scaled: Indices, skeleton: Skeleton
) -> Floats:
    """Return matrices (characters, joints, 3, 4) of local values (joints, 4 or 3, characters).

    The scales are those of the joints `scaled` (n,) only.
    """
    order = _depth_order(skeleton.parents)
    joints, _, count = turns.shape
    # For each component the joints of a depth are contiguous.
    matrices = np.empty((3, 4, joints, count), turns.dtype)
    _rotate(turns.swapaxes(0, 1)[:, order.joints], matrices)
    if scales is not None:
        matrices[:, :3, order.positions[scaled]] *= scales.swapaxes(0, 1)
    matrices[:, 3] = shifts.swapaxes(0, 1)[:, order.joints]
    for positions, parents in order.levels:
        above, here = matrices[:, :, parents], matrices[:, :, positions]
        below = above[:, 0, None] * here[0]
        part = above[:, 1, None] * here[1]
        below += part
        np.multiply(above[:, 2, None], here[2], out=part)
        below += part
        below[:, 3] += above[:, 3]
        matrices[:, :, positions] = below
    sorted_back = matrices.transpose(2, 0, 1, 3)[order.positions]
    return _transpose(sorted_back.reshape(-1, count)).reshape(count, joints, 3, 4)


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


def _with_constants(constant: Floats, moving: Indices, columns: Floats) -> Floats:
    """Return values (joints, 3, n) for all n characters: constants, and varying columns."""
    everyone = np.repeat(constant[..., None], columns.shape[1], axis=2)
    everyone[moving] = columns.reshape(len(moving), 3, columns.shape[1])
    return everyone


def _transpose(rows: Floats) -> Floats:
    """Return a transposed copy of a matrix; OpenCV does it block by block, faster than NumPy."""
    return np.asarray(cv2.transpose(rows)) if rows.size else np.zeros(rows.shape[::-1], rows.dtype)


@lru_cache(maxsize=64)
def _depth_order(parents: tuple[int, ...]) -> _DepthOrder:
    depths: list[int] = []
    for parent in parents:
        depths.append(0 if parent < 0 else depths[parent] + 1)
    depth = np.array(depths)
    joints = np.argsort(depth, kind="stable")
    positions = np.argsort(joints, kind="stable")
    column_ends = np.searchsorted(depth[joints], np.arange(depth.max(initial=0) + 2))
    levels = []
    for start, end in pairwise(column_ends[1:]):
        own = joints[start:end]
        levels.append((slice(int(start), int(end)), positions[np.array(parents)[own]]))
    return _DepthOrder(joints, positions, tuple(levels))
