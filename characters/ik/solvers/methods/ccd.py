"""Cyclic coordinate descent (Wang and Chen 1991)."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.ik.solvers import columns
from cubeling.characters.ik.solvers.task import Arrays, Solved, Task, until_done
from cubeling.characters.skeleton.pose import Array


@dataclass(frozen=True)
class CyclicCoordinateDescent:
    """Turns one joint after the other, the last one first, so that the end faces its target.

    With limits, the angles of each joint are cut off as soon as it has turned.
    """

    max_sweeps: int = 100
    """Most sweeps over the joints."""

    def __call__(self, task: Task) -> Solved:
        """Return rotations within the limits."""

        def sweep(state: Arrays) -> tuple[Arrays, NDArray[np.bool_]]:
            turns, index = state
            part = task.select(index.astype(np.intp))
            turns = turns.copy()
            frames, points = part.frames(turns)
            end = points[-1]
            for joint in reversed(range(part.joints)):
                end = _aim(part, turns, frames, joint, points[joint], end)
            done = columns.length(end - part.targets) <= part.tolerance
            return (columns.normalize(turns), index), done

        state = task.start, np.arange(task.count, dtype=float)
        (turns, _), used = until_done(sweep, state, self.max_sweeps)
        return turns, task.frames(turns)[1], used


def _aim(task: Task, turns: Array, frames: Array, joint: int, at: Array, end: Array) -> Array:
    """Turn one joint so that the end of the chain faces the target; return where the end goes.

    The joints above have not turned yet in this sweep, so their frames hold.
    """
    way = columns.between(end - at, task.targets - at)
    above = task.zero_frame(frames, joint)
    turned = columns.multiply(columns.multiply(way, above), turns[joint])
    local = columns.multiply(columns.conjugate(above), turned)
    if task.bounds is not None:
        local, _ = task.bounds[joint].cut(local)
        way = columns.multiply(columns.multiply(above, local), columns.conjugate(frames[joint]))
    turns[joint] = local
    moved: Array = at + columns.rotate(way, end - at)
    return moved
