"""Shortest paths: to any of several nodes, and with a bounded number of edges."""

from array import array
from dataclasses import dataclass
from functools import cached_property
from heapq import heappop, heappush
from math import inf

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.synthesis.graphs.edges import Edges, Nodes


@dataclass(frozen=True)
class CostToGo:
    """The shortest paths from every node to the nearest of some goals."""

    costs: "array[float]"
    """Cost of the path from each node; 0 at a goal, ∞ where there is none."""

    following: "array[int]"
    """The next node on that path; −1 at a goal, and where there is no path."""

    @cached_property
    def lengths(self) -> Nodes:
        """Number of edges of the path from each node; 0 at a goal, and where there is no path."""
        onward = np.append(np.array(self.following), -1)  # −1 leads to the last, which stays
        lengths = (onward >= 0).astype(np.intp)
        while (onward >= 0).any():  # each round, every node sees twice as far
            lengths += lengths[onward]
            onward = onward[onward]
        return lengths[:-1]

    def path(self, start: int) -> list[int]:
        """Return the nodes from a start to its goal, both included; [start] without a path."""
        nodes = [start]
        while (node := self.following[nodes[-1]]) >= 0:
            nodes.append(node)
        return nodes


def cost_to_go(edges: Edges, goals: NDArray[np.bool_]) -> CostToGo:
    """Return the shortest paths to goals (nodes,): Dijkstra 1959, from the goals backward (M1.5).

    One search serves the requests from every frame, so a request in play is a walk along a list.
    """
    costs = [inf] * edges.count
    following = [-1] * edges.count
    heap = [(0.0, int(goal)) for goal in np.flatnonzero(goals)]
    for _, goal in heap:
        costs[goal] = 0.0
    incoming = edges.incoming
    while heap:
        cost, node = heappop(heap)
        if cost > costs[node]:
            continue
        for source, weight in incoming[node]:
            total = cost + weight
            if total < costs[source]:
                costs[source] = total
                following[source] = node
                heappush(heap, (total, source))
    return CostToGo(array("d", costs), array("q", following))


@dataclass(frozen=True)
class HopCosts:
    """The least costs of reaching each node at each time, from starts at several times."""

    edges: Edges

    starts: tuple[int, ...]
    """Node at which a path may start, for each time from 0; −1 for none."""

    costs: NDArray[np.float32]
    """(times, nodes); ∞ where a node cannot be reached at that time."""

    @staticmethod
    def of(edges: Edges, starts: tuple[int, ...], hops: int) -> "HopCosts":
        """Return the costs up to a time, counted in edges.

        A dynamic programme over the number of edges: cost at time t + 1 is the least of the cost
        at t of a node and an edge from there. A path that starts at time t costs 0 then.
        """
        sources, weights, reached, firsts = edges.folded
        costs = np.full((hops + 1, edges.count), inf, np.float32)
        totals = np.empty(weights.shape, np.float32)
        for time in range(hops + 1):
            if time and len(edges):
                costs[time - 1].take(sources, out=totals, mode="clip")  # "raise" makes copies
                np.add(totals, weights, out=totals)
                costs[time, reached] = np.minimum.reduceat(totals.min(axis=0), firsts)
            if time < len(starts) and starts[time] >= 0:
                costs[time, starts[time]] = 0.0
        return HopCosts(edges, starts, costs)

    @staticmethod
    def of_few_jumps(
        edges: Edges,
        starts: tuple[int, ...],
        hops: int,
        target: int,
        slack: int,
        between: bool = False,
    ) -> "HopCosts":
        """Return the costs of paths with one jump that leaves a start and one that lands.

        They are the same one, or a third clip is between them; or, with a jump `between` them, a
        fourth. A landing is at most `slack` frames off the target, which is what plays at time 0 in
        the clip to reach. A time takes an effort in proportion to the nodes, instead of the edges.
        """
        sources, weights, reached, firsts = edges.by_target
        ends = np.append(firsts, len(sources))
        times = np.arange(hops + 1)[:, None]
        bounds = np.searchsorted(reached, target + times + [-slack, slack + 1])
        landings = [slice(int(ends[a]), int(ends[b])) for a, b in bounds.tolist()]
        lands = _lands(edges, [sources[own] for own in landings]) if between else None
        costs = np.full((hops + 1, edges.count), inf, np.float32)
        once = np.full(edges.count, inf, np.float32)  # with one jump until now
        for time in range(hops + 1):
            now = costs[time]
            if time:
                before = costs[time - 1]
                np.add(before[:-1], edges.onward, out=now[1:])
                if lands is not None:
                    _jump_between(edges, once, now, lands[time])
                    once[1:], once[0] = once[:-1] + edges.onward, inf
                start = starts[time - 1] if time <= len(starts) else -1
                if start >= 0:
                    own = edges.edges_from(start)
                    for reaching in (now, once):
                        landing = edges.targets[own]
                        reaching[landing] = np.minimum(reaching[landing], edges.weights[own])
                a, b = bounds[time]
                if a < b:
                    own = landings[time]
                    totals = before.take(sources[own]) + weights[own]
                    least = np.minimum.reduceat(totals, firsts[a:b] - firsts[a])
                    now[reached[a:b]] = np.minimum(now[reached[a:b]], least)
            if time < len(starts) and starts[time] >= 0:
                now[starts[time]] = 0.0
        return HopCosts(edges, starts, costs)

    def path(self, node: int, time: int) -> Nodes:
        """Return the nodes of a cheapest path that ends at a node at a time.

        It begins where it starts, so its length tells when it did.
        """
        sources, weights, reached, firsts = self.edges.by_target
        nodes: list[int] = []
        while True:
            played, begins = self._played(node, time)
            nodes += range(node, node - played, -1)
            node, time = node - played, time - played
            if begins:
                return np.array([*nodes, node][::-1])
            nodes.append(node)
            place = int(np.searchsorted(reached, node))
            stop = firsts[place + 1] if place + 1 < len(firsts) else len(sources)
            own = sources[firsts[place] : stop]
            totals = self.costs[time - 1].take(own) + weights[firsts[place] : stop]
            node, time = int(own[np.argmin(totals)]), time - 1

    def _played(self, node: int, time: int) -> tuple[int, bool]:
        """Return how many frames a cheapest path plays of a clip before a node.

        And whether it begins there, instead of jumping.
        """
        back = np.arange(min(node, time) + 1)
        costs = self.costs[time - back, node - back]
        played = (costs[1:] + self.edges.onward[node - back[1:]]).astype(costs.dtype)
        plays = np.append(costs[:-1] == played, False)
        starts = np.full(len(self.costs), -1)
        starts[: len(self.starts)] = self.starts[: len(self.costs)]
        begins = starts[time - back] == node - back
        last = int((begins | ~plays).argmax())
        return last, bool(begins[last])


def _lands(edges: Edges, sources: list[Nodes]) -> NDArray[np.bool_]:
    """Return from which node, left alone, a jump lands at the end, (times, nodes).

    `sources` are the nodes from which there is one that lands at each time.
    """
    lands = np.zeros((len(sources), edges.count), bool)
    goes_on = np.isfinite(edges.onward)
    for time in range(len(sources) - 2, -1, -1):
        lands[time, :-1] = lands[time + 1, 1:] & goes_on
        lands[time, sources[time + 1]] = True
    return lands


def _jump_between(
    edges: Edges, once: NDArray[np.float32], now: NDArray[np.float32], lands: NDArray[np.bool_]
) -> None:
    """Let costs now include those of a jump from nodes that one jump has reached."""
    nodes = np.flatnonzero(np.isfinite(once))
    counts = edges.firsts[nodes + 1] - edges.firsts[nodes]
    begins = np.cumsum(counts) - counts
    own = np.repeat(edges.firsts[nodes] - begins, counts) + np.arange(counts.sum())
    totals = np.repeat(once[nodes], counts)
    keep = lands[edges.targets[own]]
    own = own[keep]
    np.minimum.at(now, edges.targets[own], totals[keep] + edges.weights[own].astype(np.float32))
