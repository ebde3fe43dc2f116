"""Smoothing of single numbers, independent of the frame rate, and of recorded signals."""

import math
from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

_Value = TypeVar("_Value", float, NDArray[np.float64])


def low_pass(value: float, target: float, elapsed: float, lag: float) -> float:
    """Return a value that follows a target through a first-order low-pass filter.

    `elapsed` and `lag`, the time constant, are in seconds. Two half steps give the same result as
    one whole step.

    >>> half = low_pass(0.0, 1.0, 0.05, 0.15)
    >>> math.isclose(low_pass(half, 1.0, 0.05, 0.15), low_pass(0.0, 1.0, 0.1, 0.15))
    True
    """
    return target + (value - target) * math.exp(-elapsed / lag)


def interpolate(value: float, knots: Sequence[float], values: Sequence[float]) -> float:
    """Return the linear interpolation between ascending knots, held beyond the ends.

    The same as `np.interp`, several times as fast for a single number.

    >>> interpolate(1.5, (1.0, 2.0, 4.0), (10.0, 20.0, 0.0))
    15.0
    >>> interpolate(9.0, (1.0, 2.0), (10.0, 20.0))
    20.0
    """
    after = bisect_right(knots, value)
    if after == 0 or after == len(knots):
        return values[max(after - 1, 0)]
    low, a = knots[after - 1], values[after - 1]
    return a + (values[after] - a) * (value - low) / (knots[after] - low)


def damped_spring(
    value: float, speed: float, target: float, elapsed: float, lag: float
) -> tuple[float, float]:
    """Return value and speed of a critically damped spring that pulls towards a target.

    The solution is exact for a constant target, so it is stable for any time step [s].

    >>> damped_spring(1.0, 0.0, 1.0, 0.1, 0.2)
    (1.0, 0.0)
    """
    rate = 2.0 / lag
    offset = value - target
    slope = speed + rate * offset
    decay = math.exp(-rate * elapsed)
    return target + (offset + slope * elapsed) * decay, (speed - rate * slope * elapsed) * decay


@dataclass
class SpringValue:
    """A number that follows a target by `damped_spring`: it sets off and arrives gently."""

    value: float
    """What it is now."""

    speed: float = 0.0
    """[1/s]."""

    def follow(self, target: float, elapsed: float, lag: float) -> float:
        """Advance by a time [s] towards a target, and return the value."""
        self.value, self.speed = damped_spring(self.value, self.speed, target, elapsed, lag)
        return self.value


def hermite(a: _Value, slope_a: _Value, b: _Value, slope_b: _Value, u: float) -> _Value:
    """Return the cubic from a at u = 0 to b at u = 1 with the given slopes at its ends.

    >>> hermite(1.0, 2.0, 3.0, 2.0, 0.5)
    2.0
    """
    bend = 3 * (b - a) - 2 * slope_a - slope_b
    return a + u * (slope_a + u * (bend + u * (slope_a + slope_b - 2 * (b - a))))


def smoothstep(u: _Value) -> _Value:
    """Return the cubic that goes from 0 at u = 0 to 1 at u = 1, level at both; u is not limited.

    >>> [smoothstep(u) for u in (0.0, 0.25, 0.5, 1.0)]
    [0.0, 0.15625, 0.5, 1.0]
    """
    return u * u * (3.0 - 2.0 * u)


def gaussian_smooth(values: NDArray[np.float64], deviation: float) -> NDArray[np.float64]:
    """Return values (frames, …) under a Gaussian of a standard deviation [frames].

    Point reflection continues them at both ends: a body that enters or leaves keeps its speed.
    """
    reach = min(int(3 * deviation), len(values) - 1)
    if reach < 1:
        return values.copy()
    before = 2 * values[0] - values[reach:0:-1]
    after = 2 * values[-1] - values[-2 : -2 - reach : -1]
    padded = np.concatenate([before, values, after])
    offsets = np.arange(-reach, reach + 1)
    kernel = np.exp(-0.5 * (offsets / deviation) ** 2)
    kernel /= kernel.sum()
    windows = np.lib.stride_tricks.sliding_window_view(padded, len(kernel), axis=0)
    smooth: NDArray[np.float64] = windows @ kernel
    return smooth
