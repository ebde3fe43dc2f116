"""FABRIK: forward and backward reaching (Aristidou and Lasenby 2011)."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.ik.solvers import columns
from cubeling.characters.ik.solvers.task import Arrays, Task, until_done
from cubeling.characters.skeleton.pose import Array


@dataclass(frozen=True)
class Fabrik:
    """Moves points along the lines between them, from the target to the base and back."""

    max_iterations: int = 100
    """Most passes in both directions."""

    def __call__(self, points: Array, task: Task) -> tuple[Array, NDArray[np.intp]]:
        """Return points (joints + 1, 3, batch) and iterations (batch,)."""
        state = (points, task.lengths, task.targets, task.tolerance)
        (moved, *_), used = until_done(self._pass, state, self.max_iterations)
        return moved, used

    def _pass(self, state: Arrays) -> tuple[Arrays, NDArray[np.bool_]]:
        points, lengths, targets, tolerance = state
        points = points.copy()
        points[-1] = targets
        for joint in reversed(range(1, len(lengths))):
            points[joint] = _toward(points[joint + 1], points[joint], lengths[joint])
        for joint in range(len(lengths)):
            points[joint + 1] = _toward(points[joint], points[joint + 1], lengths[joint])
        near = columns.length(points[-1] - targets) <= tolerance
        return (points, lengths, targets, tolerance), near


def _toward(fixed: Array, moved: Array, length: Array) -> Array:
    """Return the point at a distance from a fixed one, on the line to another."""
    bone = moved - fixed
    size = np.sqrt(np.einsum("ib,ib->b", bone, bone))
    bone *= length / np.maximum(size, columns.TINY)
    bone += fixed
    return bone
