"""Rotations of joints from their positions, in closed form (S15)."""

import numpy as np

from cubeling.characters.ik.solvers import columns
from cubeling.characters.ik.solvers.task import Task
from cubeling.characters.skeleton.pose import Array


def orient(task: Task, frames: Array, before: Array, after: Array) -> Array:
    """Return the rotations (joints, 4, batch) that put the joints at new points.

    Each bone takes the shortest way from its direction in the points `before`, where the base-frame
    rotations are `frames`, to that in the points `after`; its up vector is transported with it, so
    no joint twists. For an orthonormal frame this is Horn's (1987) closed-form solution.
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
