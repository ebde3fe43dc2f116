"""How time runs from key to key: power accelerates a stroke (Huang 2013, section 8.7).

Each easing maps 0…1 to 0…1, and numbers or arrays alike. The thesis prints OutBack with (x + 1),
which does not start at 0; here it is (x − 1), as in Penner 2001.
"""

from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.behaviour.expressivity import GestureExpressivity

Time = TypeVar("Time", float, NDArray[np.float64])

OVERSHOOT = 1.70158
"""Overshoots by a tenth."""

QUART_POWER = 0.7
"""Power of OutQuart alone; above it OutBack joins in."""

BOUNCE_TENSION = 0.8
"""Tension above which a hand rebounds where it arrives."""


def out_quart(x: Time) -> Time:
    """Return the easing that starts fast: 1 − (x − 1)⁴.

    >>> out_quart(0.0), out_quart(0.5), out_quart(1.0)
    (0.0, 0.9375, 1.0)
    """
    return 1.0 - (x - 1.0) ** 4


def out_back(x: Time) -> Time:
    """Return the easing that overshoots and comes back.

    >>> [round(out_back(x), 4) for x in (0.0, 0.58, 1.0)]
    [0.0, 1.1, 1.0]
    """
    back = x - 1.0
    return back * back * ((OVERSHOOT + 1.0) * back + OVERSHOOT) + 1.0


def out_bounce(x: Time) -> Time:
    """Return the easing that rebounds three times.

    >>> out_bounce(0.0), round(out_bounce(4 / 11), 6), out_bounce(1.0)
    (0.0, 1.0, 1.0)
    """
    n, d = 7.5625, 2.75
    where = np.select(
        [x < 1.0 / d, x < 2.0 / d, x < 2.5 / d],
        [
            n * x * x,
            n * (x - 1.5 / d) ** 2 + 0.75,
            n * (x - 2.25 / d) ** 2 + 0.9375,
        ],
        n * (x - 2.625 / d) ** 2 + 0.984375,
    )
    return float(where) if isinstance(x, float) else where


def ease_time(x: Time, expressivity: GestureExpressivity) -> Time:
    """Return the share of the way from key to key at a share of the time.

    Without power it is the time itself. Power blends in OutQuart, and above `QUART_POWER` OutBack,
    so that it has no jump; a tension above `BOUNCE_TENSION` blends in OutBounce.
    """
    power, tension = expressivity.power, expressivity.tension
    quart = min(max(power, 0.0) / QUART_POWER, 1.0)
    back = max(power - QUART_POWER, 0.0) / (1.0 - QUART_POWER)
    bounce = max(tension - BOUNCE_TENSION, 0.0) / (1.0 - BOUNCE_TENSION)
    way = x + (out_quart(x) - x) * quart
    way = way + (out_back(x) - way) * min(back, 1.0)
    return way + (out_bounce(x) - way) * min(bounce, 1.0) if bounce > 0.0 else way
