"""Values that follow a plan over time, and do not jump when the plan changes."""

from collections.abc import Callable, Hashable

import numpy as np

from cubeling.characters.behaviour.intents import Times
from cubeling.characters.motion.curves import ease
from cubeling.characters.motion.inertialization import OffsetDecay
from cubeling.characters.skeleton.pose import Array

BLEND_S = 0.4
"""Time in which values go over from one plan to another [s]."""

RELEASE_S = 0.5
"""Time in which something goes if its end is not told [s]."""

MIN_PHASE_S = 1e-6
"""Shortest phase that is divided by [s]."""


def presence(times: Times, now: float) -> float:
    """Return how much of something is there at a time [s], 0…1.

    >>> [round(presence(Times(0.0, 1.0, 2.0, 3.0), t), 3) for t in (0.0, 0.5, 1.5, 2.5, 3.0)]
    [0.0, 0.5, 1.0, 0.5, 0.0]
    """
    rising = max(times.ready - times.start, MIN_PHASE_S)
    there = ease((now - times.start) / rising, "gonio")
    relax, end = times.relax, times.end
    if relax is None:
        if end is None:
            return there
        relax = max(times.ready, end - RELEASE_S)
    falling = RELEASE_S if end is None else max(end - relax, MIN_PHASE_S)
    return there * (1.0 - ease((now - relax) / falling, "gonio"))


class PlannedValues:
    """Values that a plan gives for each time; another plan takes over without a jump.

    The difference of the old plan's values from the new one's, and of their rates, decays in
    `blend` seconds (Bollo, "Inertialization", 2018). `size` is the number of values.
    """

    def __init__(self, size: int, blend: float = BLEND_S) -> None:
        self._blend = blend
        self._plan: Hashable = ()
        self._now: float | None = None
        self._zeros = self._shown = self._before = np.zeros(size)
        self._step = 0.0
        self._decay: OffsetDecay | None = None
        self._changed = 0.0

    @property
    def resting(self) -> bool:
        """Whether nothing is planned, and what was shown last are zeros."""
        return self._shown is self._zeros

    def update(self, plan: Hashable, values: Callable[[float], Array], now: float) -> Array:
        """Return the values to show at a time [s], (size,).

        Parameters
        ----------
        plan
            What tells one plan from another; () for a plan of zeros.
        values
            Returns the values of the present plan at a time, (size,).
        """
        last = now if self._now is None else self._now
        if plan == self._plan == () and self._decay is None:
            self._now, self._step = now, now - last
            self._shown = self._before = self._zeros
            return self._zeros
        if plan != self._plan:
            self._plan = plan
            self._change(values, last)
        planned = values(now)
        if self._decay is not None:
            if now - self._changed < self._decay.length:
                planned = planned + self._decay.at(now - self._changed)
            else:
                self._decay = None
        if now > last:
            self._before, self._step = self._shown, now - last
        self._shown, self._now = planned, now
        return planned

    def _change(self, values: Callable[[float], Array], last: float) -> None:
        """Take what was shown last as the start of the decay."""
        offset, velocity = self._shown - values(last), np.zeros_like(self._shown)
        if self._step > 0.0:
            earlier = self._before - values(last - self._step)
            velocity = (offset - earlier) / self._step
        self._decay, self._changed = None, last
        if np.abs(offset).max(initial=0.0) > 1e-9 or np.abs(velocity).max(initial=0.0) > 1e-9:
            self._decay = OffsetDecay(offset, velocity, self._blend)
