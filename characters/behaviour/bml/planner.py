"""Find the times of all sync points of a block.

Behaviours are placed one after the other, those that others refer to first. One is stretched
between the sync points that placed ones fix; behaviours that no time fixes form clusters that are
moved as a whole, to start as early as they can. A placement that breaks a constraint blames its
owner, who is then left out: it is what the standard asks for, and no search is needed.
"""

import math
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass

from cubeling.characters.behaviour.bml.constraints import Contradictory, Link, Moment, Order, Unmet
from cubeling.characters.behaviour.bml.problem import TimingProblem, check, sequence
from cubeling.characters.behaviour.bml.shifts import Shifts
from cubeling.characters.behaviour.bml.spans import TOLERANCE, fits, stretch

MAX_LATENESS_S = 0.1
"""A sync point that should have been so many seconds ago may be now: the standard's tolerance."""


@dataclass(eq=False)
class _Cluster:
    """Behaviours whose times are known but for a common offset."""

    members: list[str]
    grounded: bool
    """Whether that offset is known: times are absolute."""


@dataclass(frozen=True)
class _Anchor:
    """A sync point of a behaviour that is to be at the time of one that is placed."""

    index: int
    moment: Moment | None
    """The placed one; None for an absolute time."""

    offset: float
    owner: str


def plan(problem: TimingProblem) -> dict[str, list[float]]:
    """Return the times of the sync points of every behaviour [s], inf for those that never come.

    Raises
    ------
    Contradictory
        If constraints cannot be met, and `problem.strict`.
    """
    return _Planner(problem).plan()


class _Planner:
    def __init__(self, problem: TimingProblem) -> None:
        self._problem = problem
        self._ground = _Cluster([], grounded=True)
        self._clusters: dict[str, _Cluster] = {}
        self._times: dict[str, list[float]] = {}
        self._known: dict[str, dict[int, float]] = {}
        self._links: dict[str, list[Link]] = {name: [] for name in problem.timings}
        self._orders: dict[str, list[Order]] = {}
        self._unmets: list[Unmet] = []
        self._certain = True  # whether what fails now has moved nothing else
        self._rules_of = Counter(link.owner for link in problem.links)
        self._rules_of.update(order.owner for order in problem.orders)
        for link in problem.links:
            self._links[link.a[0]].append(link)
            if link.b is not None and link.b[0] != link.a[0]:
                self._links[link.b[0]].append(link)
        for order in problem.orders:
            for end in (order.earlier, order.later):
                if end is not None:
                    self._orders.setdefault(end[0], []).append(order)

    def plan(self) -> dict[str, list[float]]:
        self._place_all()
        if not self._unmets:
            try:
                self._ground_all()
                if self._problem.strict and not self._unmets:
                    check(self._problem, self._times)
            except Unmet as error:
                self._unmets.append(error)
        if self._unmets:
            raise Contradictory(self._unmets)
        start = self._problem.start
        return {name: [max(t, start) for t in times] for name, times in self._times.items()}

    def _place_all(self) -> None:
        """Place all behaviours, and note what cannot be met, as far as it is certain.

        What fails after it has moved others may have moved them wrongly: then it is the last that
        is looked at.
        """
        for name in sequence(self._problem):
            clusters = {id(self._cluster(anchor)) for anchor in self._anchors(name)}
            self._certain = len(clusters) <= 1
            try:
                self._place(name)
            except Unmet as unmet:
                self._unmets.append(unmet)
                if not self._certain or unmet.owner != name:
                    return

    def _pass_over(self, unmet: Unmet) -> None:
        """Note a constraint that is not met and has moved nothing; raise for anything else."""
        if not self._certain or self._rules_of[unmet.owner] > 1:
            raise unmet
        if unmet.owner in self._problem.timings:
            raise unmet
        self._unmets.append(unmet)

    def _unmet(self, owner: str, reason: str) -> None:
        if self._problem.strict:
            raise Unmet(owner, reason)

    # One behaviour

    def _place(self, name: str) -> None:
        anchors = self._anchors(name)
        facts = self._problem.facts.get(name, {})
        cluster = self._join(name, anchors, grounded=bool(facts))
        fixed = self._fixed_times(name, anchors, facts)
        for link in self._links[name]:
            if link.b is not None and link.b[0] == link.a[0] and (fixed or not cluster.grounded):
                try:
                    self._fix_distance(name, link, fixed)
                except Unmet as unmet:
                    self._pass_over(unmet)
        timing = self._problem.timings[name]
        if fixed:
            times = self._stretch(name, fixed, cluster)
        elif cluster.grounded:
            times = [math.inf] * len(timing.syncs)
        else:
            times = stretch(timing, {0: 0.0})
        self._clusters[name], self._times[name], self._known[name] = cluster, times, fixed
        cluster.members.append(name)
        for order in self._orders.get(name, ()):
            try:
                self._obey(name, order)
            except Unmet as unmet:
                self._pass_over(unmet)

    def _anchors(self, name: str) -> list[_Anchor]:
        anchors = []
        for link in self._links[name]:
            if link.a[0] == name:
                own, other, offset = link.a, link.b, link.offset
            else:
                assert link.b is not None
                own, other, offset = link.b, link.a, -link.offset
            if other is None or (other[0] in self._times and other[0] != name):
                anchors.append(_Anchor(own[1], other, offset, link.owner))
        anchors.sort(key=lambda anchor: anchor.index)
        return anchors

    def _time(self, anchor: _Anchor) -> float:
        if anchor.moment is None:
            return anchor.offset
        return self._times[anchor.moment[0]][anchor.moment[1]] + anchor.offset

    def _join(self, name: str, anchors: list[_Anchor], *, grounded: bool) -> _Cluster:
        """Return the cluster of a behaviour: clusters that it links become one."""
        found = [self._cluster(anchor) for anchor in anchors]
        if grounded or self._ground in found:
            base = self._ground
        else:
            base = found[0] if found else _Cluster([], grounded=False)
        timing = self._problem.timings[name]
        known = dict(self._problem.facts.get(name, {}))
        known |= {a.index: self._time(a) for a in anchors if self._cluster(a) is base}
        for anchor in anchors:
            if self._cluster(anchor) is base:
                continue
            nearest = min(known, key=lambda index: abs(index - anchor.index))
            low, high = sorted((nearest, anchor.index))
            distance = math.copysign(sum(timing.spans[low:high]), anchor.index - nearest)
            self._shift(self._cluster(anchor), base, known[nearest] + distance - self._time(anchor))
            known[anchor.index] = self._time(anchor)
        return base

    def _cluster(self, anchor: _Anchor) -> _Cluster:
        return self._clusters[anchor.moment[0]] if anchor.moment else self._ground

    def _shift(self, cluster: _Cluster, base: _Cluster, by: float) -> None:
        """Move a cluster into another one; not before the start of the block."""
        if base.grounded:
            by = max(by, self._problem.start - self._begin(cluster))
        for member in cluster.members:
            self._move(member, by, grounded=base.grounded)
            self._clusters[member] = base
        base.members += cluster.members
        cluster.members = []

    def _move(self, name: str, by: float, *, grounded: bool) -> None:
        self._known[name] = {index: time + by for index, time in self._known[name].items()}
        times = [time + by for time in self._times[name]]
        if grounded and not self._problem.strict:
            times = self._not_in_the_past(name, times)
        self._times[name] = times

    def _begin(self, cluster: _Cluster) -> float:
        return min(self._times[member][0] for member in cluster.members)

    def _fixed_times(
        self, name: str, anchors: list[_Anchor], facts: Mapping[int, float]
    ) -> dict[int, float]:
        """Return the times that anchors and facts give to a behaviour's sync points."""
        fixed = dict(facts)
        for anchor in anchors:
            time = self._in_time(anchor, self._time(anchor))
            try:
                self._fix(name, fixed, anchor.index, time, anchor.owner)
            except Unmet as unmet:
                self._pass_over(unmet)
        return fixed

    def _fix(self, name: str, fixed: dict[int, float], index: int, time: float, owner: str) -> None:
        """Fix the time of a sync point, if the others that are fixed allow it."""
        if not time < math.inf:
            self._unmet(owner, "it waits for something that never comes")
            return
        low = max((i for i in fixed if i <= index), default=None)
        high = min((i for i in fixed if i > index), default=None)
        earliest = -math.inf if low is None else fixed[low]
        latest = math.inf if high is None else fixed[high]
        if low == index:
            if abs(earliest - time) > TOLERANCE:
                self._unmet(owner, f"{self._point(name, index)} cannot be at two times")
            return
        if not earliest <= time <= latest:
            self._unmet(owner, f"{self._point(name, index)} is out of order")
        time = min(max(time, earliest), latest)
        if low is not None:
            self._check_span(name, (low, index), time - earliest, owner)
        if high is not None:
            self._check_span(name, (index, high), latest - time, owner)
        fixed[index] = time

    def _fix_distance(self, name: str, link: Link, fixed: dict[int, float]) -> None:
        """Fix how far two sync points of one behaviour are from each other."""
        assert link.b is not None
        one, other = link.a[1], link.b[1]
        if one in fixed and other not in fixed:
            self._fix(name, fixed, other, fixed[one] - link.offset, link.owner)
            return
        times = fixed
        if other not in fixed:
            natural = stretch(self._problem.timings[name], fixed or {0: 0.0})
            times = {**fixed, other: natural[other]}
        self._fix(name, times, one, times[other] + link.offset, link.owner)
        fixed |= times

    def _in_time(self, anchor: _Anchor, time: float) -> float:
        """Return a time that is not in the past, if it is only a little."""
        start = self._problem.start
        if anchor.moment is None and start - MAX_LATENESS_S <= time < start:
            time = start
        if not self._problem.strict and self._cluster(anchor).grounded:
            time = max(time, self._problem.now)
        return time

    def _check_span(self, name: str, span: tuple[int, int], duration: float, owner: str) -> None:
        if self._problem.strict and not fits(self._problem.timings[name], *span, duration):
            a, b = (self._point(name, index) for index in span)
            raise Unmet(owner, f"{a} and {b} cannot be {duration:.3g} s apart")

    def _stretch(self, name: str, fixed: dict[int, float], cluster: _Cluster) -> list[float]:
        """Return the times of a behaviour; one that would start too early is compressed."""
        timing = self._problem.timings[name]
        times = stretch(timing, fixed)
        start = self._problem.start
        if cluster.grounded and times[0] < start - TOLERANCE:
            first = min(fixed)
            if first == 0 or not fits(timing, 0, first, fixed[first] - start):
                self._unmet(self._blame(name), f"it would start {start - times[0]:.3g} s too early")
            if first > 0:
                times = stretch(timing, {**fixed, 0: min(start, fixed[first])})
        if not self._problem.strict and cluster.grounded:
            times = self._not_in_the_past(name, times)
        return times

    def _not_in_the_past(self, name: str, times: list[float]) -> list[float]:
        facts = self._problem.facts.get(name, {})
        latest = self._problem.start
        for index, time in enumerate(times):
            latest = max(latest, time if index in facts else max(time, self._problem.now))
            times[index] = latest
        return times

    def _blame(self, name: str) -> str:
        """Return who wants a behaviour where it cannot be: a constraint, or itself."""
        owners = [link.owner for link in self._links[name]]
        return next((owner for owner in owners if owner not in self._problem.timings), name)

    def _point(self, name: str, index: int) -> str:
        return f"{name}:{self._problem.timings[name].syncs[index]}"

    # Orders

    def _of(self, moment: Moment | None) -> tuple[_Cluster, float] | None:
        """Return the cluster and the time of a moment, None if it is not placed."""
        if moment is None:
            return self._ground, 0.0
        if moment[0] not in self._times:
            return None
        return self._clusters[moment[0]], self._times[moment[0]][moment[1]]

    def _lateness(self, order: Order) -> float:
        """Return how far an order within a cluster is missed [s]; not positive if it is met."""
        earlier, later = self._of(order.earlier), self._of(order.later)
        if earlier is None or later is None or earlier[0] is not later[0]:
            return 0.0
        return earlier[1] - later[1] - order.offset

    def _obey(self, name: str, order: Order) -> None:
        """Move the sync point of a behaviour to where an order allows it."""
        late = self._lateness(order)
        if late <= TOLERANCE:
            return
        if order.later is not None and order.later[0] == name:
            index, by = order.later[1], late
        else:
            assert order.earlier is not None
            index, by = order.earlier[1], -late
        fixed = self._known[name]
        if index in fixed:
            self._unmet(order.owner, f"{self._point(name, index)} would be {late:.3g} s too late")
            return
        self._fix(name, fixed, index, self._times[name][index] + by, order.owner)
        if fixed:
            self._times[name] = self._stretch(name, fixed, self._clusters[name])

    # All behaviours

    def _ground_all(self) -> None:
        """Give every cluster the earliest time that the orders between clusters allow."""
        self._certain = True
        clusters = {id(c): c for c in self._clusters.values() if not c.grounded}
        shifts = Shifts({key: self._problem.start - self._begin(c) for key, c in clusters.items()})
        for order in self._problem.orders:
            if not self._keep_apart(order, shifts):
                self._pass_over(Unmet(order.owner, "its order goes round in a circle"))
        for key, cluster in clusters.items():
            for member in cluster.members:
                self._move(member, shifts.of(key), grounded=True)
                self._clusters[member] = self._ground
        for order in self._problem.orders:
            moment = order.later or order.earlier
            try:
                if moment is not None:
                    self._obey(moment[0], order)
            except Unmet as unmet:
                self._pass_over(unmet)

    def _keep_apart(self, order: Order, shifts: Shifts) -> bool:
        """Let an order between two clusters hold; return False if it cannot."""
        earlier, later = self._of(order.earlier), self._of(order.later)
        assert earlier is not None
        assert later is not None
        distance = earlier[1] - later[1] - order.offset
        if earlier[0] is later[0] or later[0].grounded or not math.isfinite(distance):
            return True
        kept = shifts.keep_after(id(later[0]), id(earlier[0]), distance)
        return kept or not self._problem.strict
