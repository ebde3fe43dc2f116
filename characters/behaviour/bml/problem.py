"""What is to be planned, in which order, and whether times are a plan for it."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from cubeling.characters.behaviour.bml.constraints import Link, Moment, Order, Unmet
from cubeling.characters.behaviour.bml.spans import TOLERANCE
from cubeling.characters.behaviour.bml.timing import Timing

SUM_TOLERANCE = 10 * TOLERANCE
"""Seconds by which constraints may be missed at the end: every placement may add its rounding."""


@dataclass(frozen=True)
class TimingProblem:
    """What is to be planned."""

    timings: Mapping[str, Timing]
    """Natural times by behaviour, in the document's order."""

    links: Sequence[Link]
    """Sync points at a fixed distance."""

    orders: Sequence[Order]
    """Sync points in an order."""

    start: float
    """When the block starts: nothing is before [s]."""

    now: float = -math.inf
    """What has not happened is not before this [s]."""

    facts: Mapping[str, Mapping[int, float]] = field(default_factory=dict)
    """Times of sync points that have happened or are otherwise known, by behaviour [s]."""

    moved: frozenset[str] = frozenset()
    """Behaviours whose `facts` the others follow."""

    strict: bool = True
    """Whether contradictions are raised; otherwise what runs goes on as well as it can."""


def sequence(problem: TimingProblem) -> list[str]:
    """Return behaviours in an order in which those that others refer to come first.

    Those that were moved come before all; a circle is entered at its first in the document.
    """
    waits: dict[str, list[str]] = {name: [] for name in problem.timings}
    for link in problem.links:
        if link.b is not None and link.owner in (link.a[0], link.b[0]):
            waits[link.owner].append(link.b[0] if link.owner == link.a[0] else link.a[0])
    order = [name for name in problem.timings if name in problem.moved]
    seen = set(order)
    for first in problem.timings:
        stack = [] if first in seen else [(first, iter(waits[first]))]
        seen.add(first)
        while stack:
            name, others = stack[-1]
            other = next((other for other in others if other not in seen), None)
            if other is None:
                order.append(name)
                stack.pop()
            else:
                seen.add(other)
                stack.append((other, iter(waits[other])))
    return order


def check(problem: TimingProblem, times: Mapping[str, Sequence[float]]) -> None:
    """Check all constraints: none is broken unseen.

    Raises
    ------
    Unmet
        If one is broken.
    """

    def time(moment: Moment | None) -> float:
        return 0.0 if moment is None else times[moment[0]][moment[1]]

    for link in problem.links:
        wanted = time(link.b) + link.offset
        late = link.b is None and time(link.a) == problem.start > wanted
        if not (abs(time(link.a) - wanted) <= SUM_TOLERANCE or late):
            raise Unmet(link.owner, "it contradicts another constraint")
    for order in problem.orders:
        if not time(order.earlier) <= time(order.later) + order.offset + SUM_TOLERANCE:
            raise Unmet(order.owner, "it contradicts another constraint")
    for name, moments in times.items():
        if moments[0] < problem.start - SUM_TOLERANCE:
            raise Unmet(name, "it would start too early")
