"""Planning a transition: the legs first, then every other part in windows around them.

Source: Fernández-Baena 2015, chapter 3.3 (M2.4).
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from characters.errors import CharacterError
from characters.synthesis.graphs.edges import Edges, Nodes
from characters.synthesis.graphs.graph import MotionGraph
from characters.synthesis.graphs.parts import PartGraphs
from characters.synthesis.graphs.search import HopCosts
from characters.synthesis.transitions.transition import PartMove, Transition

Goals = NDArray[np.bool_]
"""Which frames meet a request, (frames,)."""


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

    arrivals: int = 25
    """Arrivals of the legs that are tried before the window is widened."""

    wide_window: int = 20
    """The widened window."""

    horizon: int = 120
    """Frames within which other arrivals of the legs are looked for."""

    direct_edges: int = 20_000
    """In a part's graph with more edges, ways through third clips are looked for only where there
    is none between the two clips: the search takes a time in proportion to its edges."""


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
        self._between: dict[tuple[int, int, int], tuple[Edges, Nodes]] = {}

    def plan(self, request: int, goals: Goals) -> Transition:
        """Return the transition from a frame to any of the goals (frames,).

        Raises
        ------
        CharacterError
            If the frame is not in all graphs, or no goal is.
        """
        goals = goals & self.graphs.kept
        if not self.graphs.kept[request]:
            raise CharacterError(f"frame {request} is not in the graphs of all parts")
        if not goals.any():
            raise CharacterError(
                "what is asked for is not in the graphs of all parts: its frames were pruned; "
                "raise the threshold or add clips"
            )
        window = self.settings.window
        first = self._complete(request, self._first(request, goals), window)
        if first is not None:
            return first
        for prior in self._others(request, goals):
            found = self._complete(request, prior, window)
            if found is not None:
                return replace(found, fallback="arrival")
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
        find = self._bounded if self.settings.search == "bounded" else self._shortest
        moves = [prior]
        for part in range(1, len(self.graphs.parts)):
            move = find(part, request, prior, window)
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

    def _fits(self, length: int, departure: int, arrival: int) -> bool:
        """Return whether a path can be scaled to its time: |l − l'| / l' ≤ 20 %."""
        required = arrival - departure
        return required > 0 and abs(length - required) <= self.settings.tolerance * required + 1e-9

    def _bounded(self, part: int, request: int, prior: PartMove, window: int) -> PartMove | None:
        """Return the cheapest path whose length fits."""
        starts, arrivals = self._windows(request, prior, window)
        first = next((time for time, start in enumerate(starts) if start >= 0), None)
        if first is None:  # the clip ends before
            return None
        times, frames = np.array([*arrivals]), np.array([*arrivals.values()])
        near = np.floor(self.settings.tolerance * (times - first) + 1e-9).astype(int)
        ends = times[:, None] + np.arange(-near.max(), near.max() + 1)
        fits = (np.abs(ends - times[:, None]) <= near[:, None]) & (ends > first)
        ends = np.where(fits, ends, first) - first
        for edges, nodes in self._searched(part, request, int(prior.frames[-1])):
            number = np.full(len(self.graphs.library) + 1, -1)  # the last is for no frame
            number[nodes] = np.arange(len(nodes))
            places = tuple(number[starts[first:]].tolist())
            table = HopCosts.of(edges, places, int(ends.max()))
            costs = np.where(fits, table.costs[ends, number[frames][:, None]], np.inf)
            for option in np.argsort(costs, axis=None).tolist():
                row, column = divmod(option, costs.shape[1])
                if not np.isfinite(costs[row, column]):
                    break
                end, arrival = int(ends[row, column]), int(times[row])
                path = table.path(int(number[frames[row]]), end)
                departure = first + end - (len(path) - 1)
                if len(path) > 1 and self._fits(len(path) - 1, departure, arrival):
                    return PartMove(departure, arrival, nodes[path], float(costs[row, column]))
        return None

    def _searched(self, part: int, request: int, landing: int) -> Iterator[tuple[Edges, Nodes]]:
        """Yield the edges to search, one after the other, and the frames that are their nodes."""
        graph = self.graphs.graphs[part]
        if len(graph.edges) > self.settings.direct_edges:
            clip_of = graph.library.clip_of
            one, other = sorted((int(clip_of[request]), int(clip_of[landing])))
            if (part, one, other) not in self._between:
                nodes = np.flatnonzero((clip_of == one) | (clip_of == other))
                self._between[part, one, other] = graph.edges.among(nodes), nodes
            yield self._between[part, one, other]
        yield graph.edges, np.arange(len(graph.library))

    def _shortest(self, part: int, request: int, prior: PartMove, window: int) -> PartMove | None:
        """Return the cheapest of the cheapest paths between both windows whose lengths fit."""
        graph = self.graphs.graphs[part]
        starts, arrivals = self._windows(request, prior, window)
        best: PartMove | None = None
        for arrival, frame in arrivals.items():
            goal = np.zeros(len(graph.library), bool)
            goal[frame] = True
            to_go = graph.to_go(goal)
            for departure, start in enumerate(starts):
                if start < 0 or to_go.following[start] < 0:
                    continue
                cost = to_go.costs[start]
                if best is not None and cost >= best.cost:
                    continue
                frames = np.array(to_go.path(start))
                if self._fits(len(frames) - 1, departure, arrival):
                    best = PartMove(departure, arrival, frames, cost)
        return best


def _move(graph: MotionGraph, frames: list[int]) -> PartMove:
    """Return a path from the request as a move: it leaves at the end of its natural prefix."""
    following = graph.library.successors
    jumps = (n for n, frame in enumerate(frames[:-1]) if following[frame] != frames[n + 1])
    departure = next(jumps, len(frames) - 2)
    cost = sum(graph.edges.weight(a, b) for a, b in pairwise(frames))
    return PartMove(departure, len(frames) - 1, np.array(frames[departure:]), cost)
