"""Numbers that follow a wish without jumping, at any frame rate."""

import math
from bisect import bisect_right
from collections.abc import Sequence


def low_pass(value: float, wish: float, elapsed: float, lag: float) -> float:
    """Return a value after a time under a wish that it follows with a first-order lag.

    Two half steps end where one whole step does.

    >>> half = low_pass(0.0, 1.0, 0.05, 0.15)
    >>> math.isclose(low_pass(half, 1.0, 0.05, 0.15), low_pass(0.0, 1.0, 0.1, 0.15))
    True
    """
    return wish + (value - wish) * math.exp(-elapsed / lag)


def interpolate(value: float, knots: Sequence[float], values: Sequence[float]) -> float:
    """Return what lies at a value on straight lines between knots, which ascend; held beyond them.

    What `np.interp` does, for one number in a fraction of the time.

    >>> along(1.5, (1.0, 2.0, 4.0), (10.0, 20.0, 0.0)), along(9.0, (1.0, 2.0), (10.0, 20.0))
    (15.0, 20.0)
    """
    after = bisect_right(knots, value)
    if after == 0 or after == len(knots):
        return values[max(after - 1, 0)]
    low, a = knots[after - 1], values[after - 1]
    return a + (values[after] - a) * (value - low) / (knots[after] - low)


def damped_spring(
    value: float, speed: float, wish: float, elapsed: float, lag: float
) -> tuple[float, float]:
    """Return value and speed of a critically damped spring with its rest at `wish`.

    Exact for a constant wish, so it is stable for any time step.

    >>> damped_spring(1.0, 0.0, 1.0, 0.1, 0.2)
    (1.0, 0.0)
    """
    rate = 2.0 / lag
    away = value - wish
    push = speed + rate * away
    decay = math.exp(-rate * elapsed)
    return wish + (away + push * elapsed) * decay, (speed - rate * push * elapsed) * decay
