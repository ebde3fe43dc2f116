"""The beam search for a way through a gesture graph; of width 1, the greedy search of the thesis.

A state is a gesture and when it ends. For each accent all successors of all states are weighed at
once, and the cheapest go on (M7, with erratum 9).
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from characters.skeleton.pose import Array
from characters.synthesis.gestures.alignment import Timings, warp_cost
from characters.synthesis.gestures.graph import GestureGraph

MIN_REST_S = 0.25
"""Shortest stay in rest between two gestures [s]."""

REMEMBERED = 4
"""Number of gestures whose repetition costs something."""


@dataclass(frozen=True)
class SearchWeights:
    """What counts how much, and how long hands may be held."""

    smooth: float
    """Of transitions."""

    time: float
    """Of warps and holds."""

    variety: float
    """Of the phrase before once more."""

    longest_hold: float
    """How long hands may be held between gestures [s]."""


@dataclass(frozen=True, eq=False)
class Ways:
    """How gestures follow states; arrays (states, nodes), or of some of them (n,)."""

    warp: Array
    """New length over recorded one."""

    hold: Array
    """How long hands are held before, besides the blend [s]."""

    by_rest: NDArray[np.bool_]
    """Whether hands go to rest first."""

    smooth: Array
    """Cost of the transition, 0…1; infinite if there is none in time."""

    time: Array
    """Cost of warp or hold, 0…1; infinite if there is none in time."""

    def at(self, rows: tuple[NDArray[np.intp], NDArray[np.intp]]) -> "Ways":
        """Return some of them, by state and node."""
        warp, hold, smooth, time = (
            part[rows] for part in (self.warp, self.hold, self.smooth, self.time)
        )
        return Ways(warp, hold, self.by_rest[rows], smooth, time)


@dataclass(frozen=True, eq=False)
class Step:
    """What each state that goes on has chosen for an accent, (states,)."""

    parent: NDArray[np.intp]
    """The state before."""

    node: NDArray[np.intp]
    """The gesture; −1 if the accent is skipped."""

    ways: Ways
    """How it follows."""

    strength: Array
    """Cost of its strength."""

    repetition: Array
    """Cost of its repetition."""


class BeamSearch:
    """One search: a `step` for each accent, then `path`.

    Parameters
    ----------
    graph, timings, weights
        What is searched.
    width
        Number of states that go on.
    """

    def __init__(
        self, graph: GestureGraph, timings: Timings, weights: SearchWeights, width: int
    ) -> None:
        self._graph, self._timings, self._weights, self._width = graph, timings, weights, width
        self._phrases = np.array([node.number for node in graph.nodes])
        self._node = np.array([graph.rest])
        self._end, self._cost = np.zeros(1), np.zeros(1)
        self._used = np.full((1, len(graph.library.phrases)), -np.inf)  # when, by phrase
        self._steps: list[Step] = []

    @property
    def cost(self) -> float:
        """Cost of the cheapest state."""
        return float(self._cost.min())

    def ways(self, apex: float) -> Ways:
        """Return how all gestures may follow all states with their apex at a time [s]."""
        graph, timings, node = self._graph, self._timings, self._node
        rest, longest = graph.rest, self._weights.longest_hold
        resting = (node == rest)[:, None]
        ends = self._end[:, None]
        edges, blends = graph.costs[node, :-1], graph.blends[node, :-1]
        available = apex - ends - blends
        warp = timings.warp(available)
        stretch = warp_cost(warp, timings.low, timings.high)
        hold = available - timings.natural
        waiting = np.where(resting, 0.0, hold / longest if longest > 0 else np.inf)
        waiting = np.where((hold >= 0.0) & (waiting <= 1.0), waiting, np.inf)
        held = waiting < stretch
        time = np.where(held, waiting, stretch)
        left = apex - timings.natural - graph.blends[rest, :-1]
        in_time = ~resting & (left >= ends + graph.blends[node, rest][:, None] + MIN_REST_S)
        detour = (graph.costs[node, rest][:, None] + graph.costs[rest, :-1]) / 2.0
        by_rest = in_time & (self._weights.smooth * detour < self._total(edges, time))
        return Ways(
            np.where(held | by_rest, 1.0, warp),
            np.where(held & ~by_rest & ~resting, hold, 0.0),
            by_rest | resting,
            np.where(by_rest, detour, edges),
            np.where(by_rest, 0.0, time),
        )

    def step(
        self, apex: float, ways: Ways, strength: Array, skip_cost: float, favour: Array
    ) -> None:
        """Go on to an accent.

        Parameters
        ----------
        apex
            When the apex is to be [s].
        ways
            Those of `ways` at this time.
        strength
            Weighted cost of the strength of each gesture, (states, nodes).
        skip_cost
            Cost of no gesture.
        favour
            Added to the cost of each node, (nodes,): decides between equals.
        """
        number = len(self._steps)
        ago = number - self._used[:, self._phrases]
        repetition = np.where(ago <= REMEMBERED, self._weights.variety / ago, 0.0)
        added = self._total(ways.smooth, ways.time) + strength + repetition + favour
        skipped = np.full((len(added), 1), skip_cost)
        totals = self._cost[:, None] + np.concatenate([added, skipped], axis=1)
        count = min(self._width, totals.size)
        kept = np.argpartition(totals, count - 1, axis=None)[:count]
        kept = kept[np.isfinite(totals.flat[kept])]
        parent, node = np.divmod(kept, totals.shape[1])
        chosen = node < totals.shape[1] - 1
        rows = parent, np.where(chosen, node, 0)
        taken = ways.at(rows)
        self._steps.append(
            Step(parent, np.where(chosen, node, -1), taken, strength[rows], repetition[rows])
        )
        ends = apex + self._timings.after_apex(ways.warp)[rows]
        self._end = np.where(chosen, ends, self._end[parent])
        self._node = np.where(chosen, node, self._node[parent])
        self._cost, self._used = totals.flat[kept], self._used[parent]
        self._used[chosen, self._phrases[node[chosen]]] = number

    def path(self) -> list[tuple[Step, int]]:
        """Return the steps of the cheapest way, and its state in each."""
        state, found = int(self._cost.argmin()), []
        for step in reversed(self._steps):
            found.append((step, state))
            state = int(step.parent[state])
        return found[::-1]

    def _total(self, smooth: Array, time: Array) -> Array:
        total: Array = self._weights.smooth * smooth + self._weights.time * time
        return total
