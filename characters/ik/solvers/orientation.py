"""Rotations of joints from their positions, in closed form (S15)."""

import numpy as np

from cubeling.characters.ik.solvers import columns
from cubeling.characters.ik.solvers.task import Task
from cubeling.characters.skeleton.pose import Array


def orient(task: Task, frames: Array, before: Array, after: Array) -> Array:
    """Return the rotations (joints, 4, batch) that put the joints at new points.

    Each bone takes the shortest way from its direction in the points `before`, where the base-frame
    rotations are `frames`, to that in the points `after`; its up vector is transported with it, so
    no joint twists. For an orthonormal frame this is Horn's solution, see `horn`.
    """
    old, new = np.diff(before, axis=0), np.diff(after, axis=0)
    ways = columns.between(old, new)
    short = task.lengths < columns.TINY
    if short.any():  # a bone without a direction follows the one before it
        for joint in range(1, task.joints):
            ways[joint] = np.where(short[joint], ways[joint - 1], ways[joint])
    return columns.normalize(task.turns(columns.multiply(ways, frames)))


def rigid(points: Array, lengths: Array) -> Array:
    """Return points (joints + 1, 3, batch) with the exact lengths of bones, from the base on."""
    bones = np.diff(points, axis=0)
    bones *= (lengths / np.maximum(columns.length(bones), columns.TINY))[:, None]
    return columns.running_sum(bones)


def straight(task: Task) -> Array:
    """Return the points (joints + 1, 3, batch) of chains that point straight to their targets."""
    direction = task.targets / np.maximum(columns.length(task.targets), columns.TINY)
    return columns.running_sum(task.lengths[:, None] * direction)


def horn(start: Array, end: Array, weights: Array | None = None) -> Array:
    """Return the rotations (…, 4) that best turn vectors `start` to `end`, both (…, vectors, 3).

    Horn, "Closed-form solution of absolute orientation using unit quaternions", 1987: the
    eigenvector of the largest eigenvalue. `weights` are (…, vectors).

    >>> from cubeling.characters.skeleton import rotations
    >>> turn = rotations.about([0.6, 0.0, 0.8], 2.0)
    >>> vectors = np.array([[1.0, 0.0, 0.0], [0.0, 2.0, 0.0]])
    >>> np.allclose(horn(vectors, rotations.rotate(turn, vectors)), turn)
    True
    """
    weighted = start if weights is None else start * weights[..., None]
    s = np.swapaxes(weighted, -1, -2) @ end
    trace = np.trace(s, axis1=-2, axis2=-1)
    n = np.empty((*s.shape[:-2], 4, 4))  # in the order xyzw
    n[..., :3, :3] = s + np.swapaxes(s, -1, -2) - trace[..., None, None] * np.eye(3)
    n[..., 3, 3] = trace
    for i, (j, k) in enumerate(((1, 2), (2, 0), (0, 1))):
        n[..., 3, i] = n[..., i, 3] = s[..., j, k] - s[..., k, j]
    best = np.linalg.eigh(n)[1][..., -1]
    return np.where(best[..., 3:] < 0, -best, best)
