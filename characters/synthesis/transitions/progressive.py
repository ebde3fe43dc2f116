"""Planning a transition: the legs first, then every other part in windows around them.

Source: Fernández-Baena 2015, chapter 3.3 (M2.4).
"""

from collections.abc import Callable, Generator, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import chain, islice, pairwise
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.errors import CharacterError
from cubeling.characters.synthesis.graphs.edges import Nodes
from cubeling.characters.synthesis.graphs.graph import MotionGraph
from cubeling.characters.synthesis.graphs.parts import PartGraphs
from cubeling.characters.synthesis.graphs.search import HopCosts
from cubeling.characters.synthesis.transitions.stitching import played_cost
from cubeling.characters.synthesis.transitions.transition import PartMove, Transition

Goals = NDArray[np.bool_]
"""Which frames meet a request, (frames,)."""

Search = Generator[None, bool | None, PartMove | None]
"""The search for a part's way, which yields before what is costly; where True is sent, it ends
there without a way."""


@dataclass(frozen=True)
class SearchSettings:
    """How the parts other than the legs find their ways."""

    search: Literal["bounded", "shortest"] = "bounded"
    """"bounded": the cheapest path whose length fits; "shortest", as printed: the cheapest path,
    rejected if its length does not fit, which fails often (M2.4)."""

    window: int = 10
    """Frames by which a part may leave and arrive after the legs (0.16 s of the thesis)."""

    symmetric: bool = True
    """Whether it may do so before them too; as printed, it may not."""

    tolerance: float = 0.2
    """Largest change of a path's time scale: 20 %."""

    min_run: int = 1
    """Frames that a part plays of a clip between two jumps, at least."""

    choices: int = 1
    """Transitions of which the one that plays cheapest is taken; each is planned whole, so several
    are for the making of motions rather than for play."""

    arrivals: int = 25
    """Arrivals of the legs that are tried before the window is widened."""

    wide_window: int = 20
    """Window after `arrivals` have been tried in vain [frames]."""

    horizon: int = 120
    """Frames within which other arrivals of the legs are looked for."""

    many_edges: int = 20_000
    """In a part's graph with more edges, paths of many jumps are looked for only where there is
    none of two or three: their search takes a time in proportion to the edges."""


PRINTED_SEARCH = SearchSettings(search="shortest", symmetric=False, wide_window=10)
"""The search as the thesis prints it: no part leaves or arrives before the legs, and only the
cheapest path between two frames is looked at. Where no such paths fit, it has no answer."""


class TransitionPlanner:
    """Plans transitions of a body by its part graphs.

    Where the parts find no way, it tries other arrivals of the legs, then a wider window, then the
    graph of the whole body (M2.4, [M]). Where that has no way either, all parts follow the legs.
    """

    def __init__(
        self,
        graphs: PartGraphs,
        standard: MotionGraph | None = None,
        settings: SearchSettings | None = None,
    ) -> None:
        self.graphs = graphs
        self.standard = standard
        self.settings = settings or SearchSettings()

    def prepare(self) -> None:
        """Sort the edges for searches, so that no frame of play has to."""
        for graph in self.graphs.graphs:
            graph.edges.prepare()

    def plan(self, request: int, goals: Goals) -> Transition:
        """Return the transition from a frame to any of the goals (frames,).

        Raises
        ------
        CharacterError
            If the frame is not in all graphs, or no goal is.
        """
        goals = self._reachable(request, goals)
        found = self._narrow(request, goals)
        if found is not None:
            return found
        if self.settings.wide_window > self.settings.window:
            wide = self._complete(request, self._first(request, goals), self.settings.wide_window)
            if wide is not None:
                return replace(wide, fallback="window")
        whole, fallback = self.graphs.graphs[0], "legs"
        standard = self.standard
        if standard is not None and standard.kept[request] and (goals & standard.kept).any():
            whole, fallback = standard, "standard"
        move = _move(whole, whole.path(request, goals))
        others = (replace(move, cost=0.0),) * (len(self.graphs.parts) - 1)
        return Transition(request, (move, *others), fallback)

    def plan_to(self, request: int, frame: int) -> Transition | None:
        """Return the transition in which the legs arrive at one frame; None if a part has no way.

        The legs take their cheapest way there, and nothing else is tried.
        """
        path = self.graphs.graphs[0].to_frame(frame).path(request)
        if path[-1] != frame or frame == request:
            return None
        prior = _move(self.graphs.graphs[0], path)
        return self._complete(request, prior, self.settings.window)

    def plan_in_steps(self, request: int, goals: Goals) -> Generator[None, bool | None, Transition]:
        """Plan a transition for play, and return it; one costly search lies between two yields.

        There are as many steps as parts, at most. Where True is sent, the costly search is left
        out, and the part follows the legs. So it does where it has no way of at most three jumps:
        in the windows, more are ten in a quarter of a second, which shake, and to look for them
        takes longer than a frame lasts.

        Raises
        ------
        CharacterError
            As for `plan`.
        """
        goals = self._reachable(request, goals)
        prior = self._first(request, goals)
        moves, fallback = [prior], ""
        for part in range(1, len(self.graphs.parts)):
            move = yield from self._bound(part, request, prior, self.settings.window, few=True)
            if move is None:
                move, fallback = replace(prior, cost=0.0), "legs"
            moves.append(move)
        return Transition(request, tuple(moves), fallback)

    def _reachable(self, request: int, goals: Goals) -> Goals:
        """Return the goals that are in the graphs of all parts; there are some."""
        goals = goals & self.graphs.kept
        if not self.graphs.kept[request]:
            raise CharacterError(f"frame {request} is not in the graphs of all parts")
        if not goals.any():
            raise CharacterError(
                "what is asked for is not in the graphs of all parts: its frames were pruned; "
                "raise the threshold or add clips"
            )
        return goals

    def _narrow(self, request: int, goals: Goals) -> Transition | None:
        """Return the transition that plays cheapest of the first few in the usual window."""
        window = self.settings.window
        first = self._complete(request, self._first(request, goals), window)
        others = (self._complete(request, way, window) for way in self._others(request, goals))
        whole = ((self.graphs, each) for each in chain([first], others) if each is not None)
        found = list(islice(whole, self.settings.choices))
        if not found:
            return None
        best = _cheapest(found)[1]
        return best if first is not None else replace(best, fallback="arrival")

    def _first(self, request: int, goals: Goals) -> PartMove:
        """Return the cheapest way of the legs."""
        legs = self.graphs.graphs[0]
        return _move(legs, legs.path(request, goals))

    def _others(self, request: int, goals: Goals) -> Iterator[PartMove]:
        """Yield ways of the legs to other arrivals, the cheapest first."""
        legs, horizon = self.graphs.graphs[0], self.settings.horizon
        table = HopCosts.of(legs.edges, (request,), horizon)
        arrivals = np.flatnonzero(goals)
        costs = table.costs[:, arrivals].copy()
        costs[0] = np.inf
        for _ in range(self.settings.arrivals):
            time, place = np.unravel_index(int(costs.argmin()), costs.shape)
            if not np.isfinite(costs[time, place]):
                return
            frames = table.path(int(arrivals[place]), int(time)).tolist()
            costs[:, place] = np.inf
            if not goals[frames[1:-1]].any():
                yield _move(legs, frames)

    def _complete(self, request: int, prior: PartMove, window: int) -> Transition | None:
        """Return the transition in which all other parts follow the legs, or None."""
        bounded, moves = self.settings.search == "bounded", [prior]
        for part in range(1, len(self.graphs.parts)):
            if bounded:
                move = _all_steps(self._bound(part, request, prior, window))
            else:
                move = self._shortest(part, request, prior, window)
            if move is None:
                return None
            moves.append(move)
        return Transition(request, tuple(moves))

    def _windows(
        self, request: int, prior: PartMove, window: int
    ) -> tuple[list[int], dict[int, int]]:
        """Return where a part may leave, by time (−1 for nowhere), and when it may arrive where."""
        library, back = self.graphs.library, window if self.settings.symmetric else 0
        starts, frame = [], request
        for time in range(prior.departure + window + 1):
            starts.append(frame if time >= prior.departure - back else -1)
            frame = int(library.successors[frame]) if frame >= 0 else -1
        arrivals = {prior.arrival: int(prior.frames[-1])}
        ahead = range(prior.arrival + 1, prior.arrival + window + 1)
        behind = range(prior.arrival - 1, max(prior.arrival - back, 1) - 1, -1)
        for times, neighbours in ((ahead, library.successors), (behind, library.predecessors)):
            frame = int(prior.frames[-1])
            for time in times:
                frame = int(neighbours[frame])
                if frame < 0 or not self.graphs.kept[frame]:
                    break
                arrivals[time] = frame
        return starts, arrivals

    def _fits(self, path: Nodes, departure: int, arrival: int) -> bool:
        """Return whether a path stays in each clip, and can be scaled to its time."""
        jumps = np.flatnonzero(self.graphs.library.successors[path[:-1]] != path[1:])
        if (np.diff(jumps) < self.settings.min_run).any():
            return False
        return bool(self._scales(np.array(len(path) - 1), np.array(arrival - departure)))

    def _scales(self, lengths: Nodes, required: Nodes) -> NDArray[np.bool_]:
        """Return which lengths can be scaled to their times: |l − l'| / l' ≤ 20 % (M2.4)."""
        near = np.abs(lengths - required) <= self.settings.tolerance * required + 1e-9
        return np.asarray((required > 0) & near)

    def _bound(
        self, part: int, request: int, prior: PartMove, window: int, few: bool = False
    ) -> Search:
        """Return the cheapest path whose length fits; of `few` jumps, if so.

        Of the tables of costs, the first is quickly made.
        """
        starts, arrivals = self._windows(request, prior, window)
        first = next((time for time, start in enumerate(starts) if start >= 0), None)
        if first is None:  # the clip ends before
            return None
        times, frames = np.array([*arrivals]), np.array([*arrivals.values()])
        near = np.floor(self.settings.tolerance * (times - first) + 1e-9).astype(int)
        ends = times[:, None] + np.arange(-near.max(), near.max() + 1)
        fits = (np.abs(ends - times[:, None]) <= near[:, None]) & (ends > first)
        ends = np.where(fits, ends, first) - first
        target = int(prior.frames[-1]) - (prior.arrival - first)
        tables = self._tables(
            part, tuple(starts[first:]), int(ends.max()), target, int(near.max()), few
        )
        for number, make in enumerate(tables):
            if number and (yield):
                return None
            table = make()
            costs = np.where(fits, table.costs[ends, frames[:, None]], np.inf)
            for option in np.argsort(costs, axis=None).tolist():
                row, column = divmod(option, costs.shape[1])
                if not np.isfinite(costs[row, column]):
                    break
                end, arrival = int(ends[row, column]), int(times[row])
                path = table.path(int(frames[row]), end)
                departure = first + end - (len(path) - 1)
                if len(path) > 1 and self._fits(path, departure, arrival):
                    return PartMove(departure, arrival, path, float(costs[row, column]))
        return None

    def _tables(
        self, part: int, starts: tuple[int, ...], hops: int, target: int, slack: int, few: bool
    ) -> list[Callable[[], HopCosts]]:
        """Return what makes tables of a part's paths: in a large graph first of few jumps."""
        edges = self.graphs.graphs[part].edges
        jumps = partial(HopCosts.of_few_jumps, edges, starts, hops, target, slack)
        every = partial(HopCosts.of, edges, starts, hops)
        if few:
            return [jumps, partial(jumps, between=True)]
        if len(edges) > self.settings.many_edges:
            return [jumps, partial(jumps, between=True), every]
        return [every]

    def _shortest(self, part: int, request: int, prior: PartMove, window: int) -> PartMove | None:
        """Return the cheapest of the cheapest paths between both windows whose lengths fit."""
        graph = self.graphs.graphs[part]
        starts, arrivals = self._windows(request, prior, window)
        times = [time for time, start in enumerate(starts) if start >= 0]
        nodes = [starts[time] for time in times]
        if not nodes:  # the clip ends before
            return None
        ways = [graph.to_frame(frame) for frame in arrivals.values()]
        lengths = np.array([way.lengths[nodes] for way in ways])
        required = np.array([*arrivals])[:, None] - np.array(times)
        fits = self._scales(lengths, required) & (lengths > 0)
        costs = np.array([[way.costs[node] for node in nodes] for way in ways])
        costs[~fits] = np.inf
        for option in np.argsort(costs, axis=None, kind="stable").tolist():
            row, column = divmod(option, len(nodes))
            if not np.isfinite(costs[row, column]):
                break
            path, arrival = np.array(ways[row].path(nodes[column])), [*arrivals][row]
            if self._fits(path, times[column], arrival):
                return PartMove(times[column], arrival, path, float(costs[row, column]))
        return None


def whole_body_transition(graph: MotionGraph, request: int, goals: Goals) -> Transition:
    """Return the transition from a frame to any of the goals (frames,) by one graph.

    Raises
    ------
    CharacterError
        If the frame is not in the graph, or no goal is.
    """
    return Transition(request, (_move(graph, graph.path(request, goals)),))


def cheapest_plan(
    planners: Sequence[TransitionPlanner], request: int, goals: Goals
) -> tuple[PartGraphs, Transition]:
    """Return the transition that plays cheapest of those of several split profiles, and its graphs.

    This chooses the best profile for each request (M2 and M3, go beyond).

    Raises
    ------
    CharacterError
        If the frame is not in all graphs of any profile, or no goal is.
    """
    able = [each for each in planners if each.graphs.kept[request]] or planners
    plans = [(each.graphs, each.plan(request, goals)) for each in able]
    return _cheapest(plans)


def _all_steps(search: Search) -> PartMove | None:
    """Take all steps of a search and return what it found."""
    while True:
        try:
            next(search)
        except StopIteration as end:
            found: PartMove | None = end.value
            return found


def _cheapest(plans: Sequence[tuple[PartGraphs, Transition]]) -> tuple[PartGraphs, Transition]:
    """Return the plan that plays cheapest; a single one is not played to find out."""
    return plans[0] if len(plans) == 1 else min(plans, key=lambda plan: played_cost(*plan))


def _move(graph: MotionGraph, frames: list[int]) -> PartMove:
    """Return a path from the request as a move: it leaves at the end of its natural prefix."""
    following = graph.library.successors
    jumps = (n for n, frame in enumerate(frames[:-1]) if following[frame] != frames[n + 1])
    departure = next(jumps, len(frames) - 2)
    cost = sum(graph.edges.weight(a, b) for a, b in pairwise(frames))
    return PartMove(departure, len(frames) - 1, np.array(frames[departure:]), cost)
