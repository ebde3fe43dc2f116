"""Joint limits after a step of a solver: passed on to the parent (S16, Algorithm 3), or cut off."""

import numpy as np

from cubeling.characters.ik.solvers import columns
from cubeling.characters.ik.solvers.task import Task
from cubeling.characters.skeleton.pose import Array

MAX_LEVER_RATIO = 2.0
"""Most that a parent turns for each radian of its child: near the target the ratio has no bound."""


def clamp(task: Task, turns: Array) -> Array:
    """Return rotations (joints, 4, batch) with all angles cut off at the limits."""
    return turns if task.bounds is None else task.bounds.cut(turns)[0]


def propagate(task: Task, turns: Array, points: Array) -> Array:
    """Return rotations within the limits, with what is cut off passed on to the parents.

    From the end to the base: where a joint is cut off by α, its parent turns in the same sense by
    β = α |t − p_i| / |t − p_(i−1)| of the distances to the target (S16). What the base cannot take
    is lost. The printed algorithm turns the parent the wrong way and tests upper limits only.
    """
    if task.bounds is None:
        return turns
    turns = turns.copy()
    levers = columns.length(task.targets - points[:-1])
    for joint in reversed(range(task.joints)):
        cut, event = task.bounds[joint].cut(turns[joint])
        if joint > 0 and event.any():
            excess = columns.multiply(turns[joint], columns.conjugate(cut))
            if task.links is not None:  # from the axes of the joint at zero to those of its parent
                link = task.links[joint]
                excess = columns.multiply(columns.multiply(link, excess), columns.conjugate(link))
            ratio = levers[joint] / np.maximum(levers[joint - 1], columns.TINY)
            part = columns.share(excess, np.minimum(ratio, MAX_LEVER_RATIO))
            passed = columns.normalize(columns.multiply(turns[joint - 1], part))
            turns[joint - 1] = np.where(event, passed, turns[joint - 1])
        turns[joint] = cut
    return turns


def limit(task: Task, turns: Array, points: Array) -> Array:
    """Return rotations within the limits, in the way that the task asks for."""
    if task.limiting == "clamp":
        return clamp(task, turns)
    return propagate(task, turns, points)
