"""A start for targets near the base: the chain curls up in one sense instead of in zig-zag.

From a far start a solver folds a chain to and fro, since each joint turns only by what brings the
end nearer. A curled chain is there at once, and its bend has one sense (Godot's documentation of
FABRIK warns of the zig-zag).
"""

import numpy as np

from cubeling.characters.ik.solvers import columns
from cubeling.characters.ik.solvers.orientation import orient
from cubeling.characters.ik.solvers.task import Task
from cubeling.characters.skeleton.pose import Array

NEAR_BASE = 0.3
"""A target nearer than this is near the base, in lengths of the chain."""

FAR_START = 0.2
"""A chain whose end is farther from its target is curled, in lengths of the chain: a chain that
follows a moving target goes on from where it is."""

_STEPS, _BISECTIONS = 32, 6


def curl(task: Task) -> Task:
    """Return the task with chains curled whose targets are near the base and far from the end."""
    near = columns.length(task.targets) < NEAR_BASE * task.reach
    far = columns.length(task.points_at_start[-1] - task.targets) > FAR_START * task.reach
    which = np.flatnonzero(near & far)
    if len(which) == 0 or task.joints < 3:
        return task
    part = task.select(which)
    before = part.points_at_start
    after = _curled_points(part, np.diff(before, axis=0))
    turns = orient(part, part.frames_at_start, before, after)
    if task.bounds is not None:
        turns, _ = task.bounds.cut(turns)
    start = task.start.copy()
    start[..., which] = turns
    return task.with_start(start)


def _curled_points(task: Task, bones: Array) -> Array:
    """Return points (joints + 1, 3, batch) curled as much as the distance of the target asks for.

    Each joint bends by the same angle more, and the whole chain turns to the target.
    """
    axis = _bend_axis(bones, task.targets)
    wanted = columns.length(task.targets)
    angles = np.linspace(0.0, 2 * np.pi / task.joints, _STEPS)
    sizes = np.stack([_size(bones, axis, np.full_like(wanted, angle)) for angle in angles])
    inside = sizes <= wanted
    first = np.where(inside.any(0), inside.argmax(0), sizes.argmin(0))
    low, high = angles[np.maximum(first - 1, 0)], angles[first]
    for _ in range(_BISECTIONS):
        middle = 0.5 * (low + high)
        outside = _size(bones, axis, middle) > wanted
        low, high = np.where(outside, middle, low), np.where(outside, high, middle)
    points = columns.running_sum(_bend(bones, axis, high))
    return columns.rotate(columns.between(points[-1], task.targets), points)


def _bend_axis(bones: Array, targets: Array) -> Array:
    """Return the mean axis of the bends of chains; for a straight one, across to its target."""
    total = columns.cross(bones[:-1], bones[1:]).sum(0)
    across = columns.cross(bones[0], targets)
    bent = columns.length(total) > 1e-6 * columns.length(bones[0]) * columns.length(bones[1])
    axis = np.where(bent, total, across)
    axis = np.where(columns.length(axis) > columns.TINY**2, axis, np.array([[0.0], [0.0], [1.0]]))
    unit: Array = axis / columns.length(axis)
    return unit


def _bend(bones: Array, axis: Array, angle: Array) -> Array:
    """Return bones (joints, 3, batch) with an angle (batch,) more in each joint but the first."""
    half = 0.5 * angle * np.arange(len(bones))[:, None]
    turns = np.concatenate([axis * np.sin(half)[:, None], np.cos(half)[:, None]], axis=1)
    return columns.rotate(turns, bones)


def _size(bones: Array, axis: Array, angle: Array) -> Array:
    return columns.length(_bend(bones, axis, angle).sum(0))
