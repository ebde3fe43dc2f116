"""Ways over the ground of motions that are mixed.

A mix moves at each moment with the mean of its members' velocities, each in its own frame. Means
are therefore taken of twists (the constant velocities that lead along a step), not of the steps'
ends: two arcs of even speed give an arc of even speed, and the parts of a way add up to the whole.
"""

import math
from collections.abc import Callable, Sequence

from characters.motion.motion import RootDelta

_GRID = 1 / 60  # [s]: weights that vary are taken as constant for so long
_HALF_CIRCLE = 3.0  # [rad]: beyond it, no single arc describes a step


def twist(step: RootDelta) -> tuple[float, float, float]:
    """Return the constant velocity (x, z, yaw) that leads along a step in one unit of time.

    >>> [round(v, 6) for v in twist(RootDelta(2.0, 2.0, math.pi / 2))]
    [0.0, 3.141593, 1.570796]
    """
    half = max(-_HALF_CIRCLE, min(step.yaw, _HALF_CIRCLE)) / 2
    stretch = half / math.sin(half) if abs(half) > 1e-9 else 1.0
    # The chord of an arc points half of the turn away from its start.
    sine, cosine = math.sin(half) * stretch, math.cos(half) * stretch
    return cosine * step.x - sine * step.z, sine * step.x + cosine * step.z, step.yaw


def along(x: float, z: float, yaw: float) -> RootDelta:
    """Return the step along a constant velocity for one unit of time: the inverse of `twist`.

    >>> step = along(*twist(RootDelta(0.3, 1.0, 0.5)))
    >>> round(step.x, 9), round(step.z, 9), step.yaw
    (0.3, 1.0, 0.5)
    """
    half = max(-_HALF_CIRCLE, min(yaw, _HALF_CIRCLE)) / 2
    stretch = math.sin(half) / half if abs(half) > 1e-9 else 1.0
    sine, cosine = math.sin(half) * stretch, math.cos(half) * stretch
    return RootDelta(cosine * x + sine * z, cosine * z - sine * x, yaw)


def mean_step(steps: Sequence[RootDelta], weights: Sequence[float]) -> RootDelta:
    """Return the mean of steps that are taken at the same time; the weights sum to one.

    >>> mean_step([RootDelta(0.0, 1.0), RootDelta(0.0, 3.0)], [0.25, 0.75])
    RootDelta(x=0.0, z=2.5, yaw=0.0)
    """
    if len(steps) == 1 and weights[0] == 1.0:
        return steps[0]
    x = z = yaw = 0.0
    for step, weight in zip(steps, weights, strict=True):
        along_x, along_z, turn = twist(step)
        x, z, yaw = x + weight * along_x, z + weight * along_z, yaw + weight * turn
    return along(x, z, yaw)


def accumulated(
    start: float, end: float, step: Callable[[float, float, float], RootDelta]
) -> RootDelta:
    """Return the way between two times [s] of a mix whose weights vary.

    Parameters
    ----------
    start, end
        The times, start ≤ end.
    step
        Called with the ends of a short interval and the moment whose weights hold in it. The
        moments lie on a grid of their own, so a way does not depend on how it is cut into parts.
    """
    total = RootDelta()
    for cell in range(math.floor(start / _GRID), math.floor(end / _GRID) + 1):
        low, high = max(start, cell * _GRID), min(end, (cell + 1) * _GRID)
        if high > low:
            total = total.then(step(low, high, (cell + 0.5) * _GRID))
    return total
