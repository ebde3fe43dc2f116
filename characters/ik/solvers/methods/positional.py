"""Solvers that move points, and leave the rotations to `orientation`: springs, FABRIK.

The outer loop is that of Huang (Listing 11.2, whose counter never moves): points, rotations,
limits, and again from the rigid chain until its end is near enough. What the limits cut off is
passed on to the parent (S16, Algorithm 3), or lost.
"""

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.ik.solvers import columns
from cubeling.characters.ik.solvers.orientation import orient, rigid
from cubeling.characters.ik.solvers.task import Arrays, Solved, Task, until_done
from cubeling.characters.skeleton.pose import Array

MAX_LOOPS = 20
"""Most rounds of points, rotations and limits."""

MAX_LEVER_RATIO = 2.0
"""Most that a parent turns for each radian of its child: near the target the ratio has no bound."""


class PointMover(Protocol):
    """Moves the points of chains so that the last ones come to their targets."""

    def __call__(self, points: Array, task: Task) -> tuple[Array, NDArray[np.intp]]:
        """Return points (joints + 1, 3, batch), of about the right lengths, and iterations."""


@dataclass(frozen=True)
class PositionalSolver:
    """Makes a solver of joint rotations from one of points."""

    move: PointMover
    """What moves the points."""

    max_loops: int = MAX_LOOPS
    """Number of rounds over the chain after which it gives up."""

    def __call__(self, task: Task) -> Solved:
        """Return rotations within the limits."""
        if task.bounds is None:
            return self._free(task)
        return self._with_limits(task)

    def _free(self, task: Task) -> Solved:
        """Solve without limits: rotations are needed only once, at the end."""
        frames, start = task.frames_at_start, task.points_at_start
        points, total = self._move_rigidly(start, task)
        left = np.flatnonzero(~_near(points, task))
        for _ in range(1, self.max_loops):
            if len(left) == 0:
                break
            part = task.select(left)
            points[..., left], used = self._move_rigidly(points[..., left], part)
            total[left] += used
            left = left[~_near(points[..., left], part)]
        return orient(task, frames, start, points), points, total

    def _with_limits(self, task: Task) -> Solved:
        def one_round(state: Arrays) -> tuple[Arrays, NDArray[np.bool_]]:
            turns, index, used, best, least = state
            part = task.select(index.astype(np.intp))
            frames, before = part.frames(turns)
            moved, iterations = self._move_rigidly(before, part)
            free = orient(part, frames, before, moved)
            turns = limit(part, free, moved)
            _, after = part.frames(turns)
            errors = columns.length(after[-1] - part.targets)
            better = errors < least
            best, least = np.where(better, turns, best), np.where(better, errors, least)
            return (turns, index, used + iterations, best, least), errors <= part.tolerance

        unused = np.zeros(task.count)
        least = columns.length(task.points_at_start[-1] - task.targets)
        state = task.start, np.arange(task.count, dtype=float), unused, task.start, least
        (_, _, used, best, _), _ = until_done(one_round, state, self.max_loops)
        return best, task.frames(best)[1], used.astype(np.intp)

    def _move_rigidly(self, points: Array, task: Task) -> tuple[Array, NDArray[np.intp]]:
        moved, used = self.move(points, task)
        return rigid(moved, task.lengths), used


def _near(points: Array, task: Task) -> NDArray[np.bool_]:
    near: NDArray[np.bool_] = columns.length(points[-1] - task.targets) <= task.tolerance
    return near


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
