"""Chains of unit masses and springs: the solvers of Huang (S14, Algorithm 1, with its errata).

A bone is a spring whose length at rest is that of the bone; the stable state is a solution. The
base is pinned. In the force-based method the target pulls the end by a spring of its own; in the
position-based one the end is pinned to the target.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.ik.solvers import columns
from cubeling.characters.ik.solvers.task import Arrays, Task, until_done
from cubeling.characters.skeleton.pose import Array


def verlet(now: Array, before: Array, acceleration: Array, damping: float = 0.0) -> Array:
    """Return the positions after one more unit of time (Störmer-Verlet, 7.3.5).

    Exact for constant acceleration without damping. `damping` is the share of the velocity that is
    lost in a step.

    >>> float(verlet(np.array(4.5), np.array(2.0), np.array(1.0)))  # of t²/2, at t = 2, 3
    8.0
    """
    after: Array = now + (1.0 - damping) * (now - before) + acceleration
    return after


@dataclass(frozen=True)
class MassSprings:
    """A mass-spring solver of points."""

    pinned: bool
    """Whether the end is pinned to the target (method 2) or pulled to it (method 1)."""

    stiffness: float = 0.6
    """k of the bones, in masses over step². Chains are unstable at (2 − damping) / 2 and above."""

    pull: float = 0.5
    """k of the spring from the end to the target."""

    damping: float = 0.45
    """Share of the velocity that is lost in a step."""

    rest_energy: float = 0.1
    """Sum of the forces at which a chain is at rest, in tolerances of the target."""

    max_steps: int = 200
    """Most steps before the chain is made rigid and starts again."""

    def __call__(self, points: Array, task: Task) -> tuple[Array, NDArray[np.intp]]:
        """Return points (joints + 1, 3, batch) at rest, and steps (batch,)."""
        points = points.copy()
        if self.pinned:
            points[-1] = task.targets
        rest = self.rest_energy * task.tolerance
        state = (points, points, task.lengths, task.targets, rest)
        (moved, *_), steps = until_done(self._step, state, self.max_steps)
        return moved, steps

    def _step(self, state: Arrays) -> tuple[Arrays, NDArray[np.bool_]]:
        points, before, lengths, targets, rest = state
        bones = np.diff(points, axis=0)
        now = columns.length(bones)
        bones *= (self.stiffness * (1.0 - lengths / np.maximum(now, columns.TINY)))[:, None]
        forces = np.zeros_like(points)
        forces[:-1] += bones
        forces[1:] -= bones
        forces[0] = 0.0
        if self.pinned:
            forces[-1] = 0.0
        else:
            forces[-1] += self.pull * (targets - points[-1])
        energy = columns.length(forces).sum(0)
        after = verlet(points, before, forces, self.damping)
        return (after, points, lengths, targets, rest), energy <= rest
