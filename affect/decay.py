"""Exponential decay under a constant push, solved exactly."""

import math


def decay(value: float, home: float, rate: float, half_life: float, elapsed: float) -> float:
    """Return the solution of x′ = rate + (home − x)·ln 2/half-life after a time [s].

    It is monotone: whoever clamps its end has clamped it exactly.

    >>> decay(1.0, 0.0, 0.0, 15.0, 15.0), decay(0.0, 0.0, 0.1, math.inf, 2.0)
    (0.5, 0.2)
    """
    # The limit of the formula below, which would divide by a decay of zero.
    if half_life == math.inf:
        return value + rate * elapsed
    constant = math.log(2.0) / half_life
    # 1 − e^−x loses its digits for the small x of one frame; expm1 keeps them.
    share = -math.expm1(-constant * elapsed)
    return value + (home - value) * share + rate * share / constant
