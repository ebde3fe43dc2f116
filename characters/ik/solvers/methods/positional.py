"""Solvers that move points, and leave the rotations to `orientation`: springs, FABRIK.

The outer loop is that of Huang (Listing 11.2, whose counter never moves): points, rotations,
limits, and again from the rigid chain until its end is near enough.
"""

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.ik.solvers import columns
from cubeling.characters.ik.solvers.limiting import limit
from cubeling.characters.ik.solvers.orientation import orient, rigid
from cubeling.characters.ik.solvers.task import Arrays, Solved, Task, until_done
from cubeling.characters.skeleton.pose import Array

MAX_LOOPS = 20
"""Most rounds of points, rotations and limits."""


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
