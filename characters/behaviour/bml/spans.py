"""How the time between two sync points is shared among the spans between them."""

import math
from itertools import pairwise

from cubeling.characters.behaviour.bml.timing import Timing

TOLERANCE = 1e-6
"""Seconds by which limits may be missed: rounding of sums."""


def fits(timing: Timing, first: int, last: int, duration: float) -> bool:
    """Return whether spans from a sync point to a later one can take so long together.

    >>> fits(Timing(("start", "end"), (1.0,), (0.5,), (2.0,)), 0, 1, 2.5)
    False
    """
    least, most = sum(timing.shortest[first:last]), sum(timing.longest[first:last])
    return least - TOLERANCE <= duration <= most + TOLERANCE


def share_duration(timing: Timing, first: int, last: int, duration: float) -> list[float]:
    """Return the lengths of the spans between two sync points that take `duration` together [s].

    Each span gives or takes the same part of what its limits allow; holds without limit take all
    that is to be taken. What the limits do not allow is shared in proportion to natural lengths.

    >>> timing = Timing(("start", "ready", "relax", "end"), (0.5,) * 3, (0.2,) * 3,
    ...                 (1.0, math.inf, 1.0))
    >>> share_duration(timing, 0, 3, 4.5)
    [0.5, 3.5, 0.5]
    """
    natural = timing.spans[first:last]
    missing = duration - sum(natural)
    if abs(missing) <= TOLERANCE * 1e-3:
        return list(natural)
    limits = (timing.longest if missing > 0.0 else timing.shortest)[first:last]
    endless = limits.count(math.inf)
    if endless:
        return [
            span + (missing / endless if limit == math.inf else 0.0)
            for span, limit in zip(natural, limits, strict=True)
        ]
    slack = sum(limits) - sum(natural)
    if abs(slack) >= abs(missing):
        part = missing / slack
        return [n + part * (limit - n) for n, limit in zip(natural, limits, strict=True)]
    return _in_proportion(natural, max(duration, 0.0))


def _in_proportion(natural: tuple[float, ...], duration: float) -> list[float]:
    total = sum(natural)
    if total <= 0.0:
        return [duration / len(natural)] * len(natural)
    return [duration * span / total for span in natural]


def stretch(timing: Timing, fixed: dict[int, float]) -> list[float]:
    """Return the times of all sync points if those of some, at least one, are given [s].

    Spans before the first and after the last keep their natural length; a persistent behaviour
    whose release is not given lasts for ever.
    """
    known = sorted(fixed)
    times = [0.0] * len(timing.syncs)
    first, last = known[0], known[-1]
    times[first] = fixed[first]
    for index in range(first, 0, -1):
        times[index - 1] = times[index] - timing.spans[index - 1]
    for left, right in pairwise(known):
        time = fixed[left]
        for index, span in enumerate(
            share_duration(timing, left, right, fixed[right] - time), left + 1
        ):
            time += span
            times[index] = min(time, fixed[right])
        times[right] = fixed[right]
    for index in range(last, len(times) - 1):
        times[index + 1] = times[index] + timing.spans[index]
    if timing.persistent and last < timing.release:
        times[timing.release :] = [math.inf] * (len(times) - timing.release)
    return times
