"""The beam search for a way through a gesture graph; of width 1, the greedy search of the thesis.

A state is a gesture and when it ends. For each accent all successors of all states are weighed at
once, and the cheapest go on (M7, with erratum 9).
"""

from dataclasses import dataclass
from typing import get_args

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.skeleton.pose import Array
from cubeling.characters.synthesis.gestures.alignment import Timings, warp_cost
from cubeling.characters.synthesis.gestures.graph import GestureGraph
from cubeling.characters.synthesis.gestures.library import Hand

MIN_REST_S = 0.25
"""Shortest stay in rest between two gestures [s]."""

REMEMBERED_GESTURES = 12
"""Number of gestures whose repetition costs something."""

SAME_HAND = 3
"""So many gestures in a row by the same hands cost nothing; each further one costs a fifth of a
repetition more, up to a whole one."""


@dataclass(frozen=True)
class SearchWeights:
    """What counts how much, and how long hands may be held."""

    smooth: float
    """Of transitions; more than 0."""

    time: float
    """Of warps and holds; more than 0."""

    variety: float
    """Of the phrase before once more; and of the same hands many times."""

    longest_hold: float
    """How long hands may be held between gestures [s]."""


@dataclass(frozen=True, eq=False)
class GestureConnections:
    """How gestures follow states; arrays (states, apices, nodes), or of some of them (n,)."""

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

    def at(self, rows: tuple[NDArray[np.intp], ...]) -> "GestureConnections":
        """Return some of them, by state, apex and node."""
        warp, hold, smooth, time = (
            part[rows] for part in (self.warp, self.hold, self.smooth, self.time)
        )
        return GestureConnections(warp, hold, self.by_rest[rows], smooth, time)


@dataclass(frozen=True, eq=False)
class SearchStep:
    """What each state that goes on has chosen for an accent, (states,)."""

    parent: NDArray[np.intp]
    """Index of each one's best predecessor in the step before."""

    node: NDArray[np.intp]
    """The gesture; −1 if the accent is skipped."""

    apex: Array
    """When its apex is [s]."""

    ways: GestureConnections

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
        before = graph.blends[:, :-1] + timings.before_fixed + timings.low * timings.before
        possible = np.isfinite(graph.costs[:, :-1])
        self._least = np.where(possible, before, np.inf).min(1)  # from an end to the next apex [s]
        self._node = np.array([graph.rest])
        self._end, self._cost = np.zeros(1), np.zeros(1)
        self._used = np.full((1, len(graph.library.phrases)), -np.inf)  # when, by phrase
        hands = [get_args(Hand).index(node.phrase.hand) for node in graph.nodes]
        self._hands, self._hand = np.array(hands), np.array([-1])
        self._row = np.zeros(1, np.intp)  # gestures in a row by the same hands
        self._steps: list[SearchStep] = []

    @property
    def cost(self) -> float:
        """Cost of the cheapest state."""
        return float(self._cost.min())

    def ways(self, apices: Array) -> GestureConnections:
        """Return how gestures may follow states, by possible times of their apices (n,) [s]."""
        graph, timings, node = self._graph, self._timings, self._node
        rest, longest = graph.rest, self._weights.longest_hold
        apex = apices[:, None]
        resting, ends = (node == rest)[:, None, None], self._end[:, None, None]
        edges, blends = (table[node, None, :-1] for table in (graph.costs, graph.blends))
        available = apex - ends - blends
        warp = timings.warp(available)
        stretch = warp_cost(warp, timings.low, timings.high)
        hold = available - timings.natural
        waiting = np.where(resting, 0.0, hold / longest if longest > 0 else np.inf)
        waiting = np.where((hold >= 0.0) & (waiting <= 1.0), waiting, np.inf)
        held = waiting < stretch
        time = np.where(held, waiting, stretch)
        left = apex - timings.natural - graph.blends[rest, :-1]
        in_time = ~resting & (left >= ends + graph.blends[node, rest, None, None] + MIN_REST_S)
        detour = (graph.costs[node, rest, None, None] + graph.costs[rest, :-1]) / 2.0
        by_rest = in_time & (self._weights.smooth * detour < self._total(edges, time))
        return GestureConnections(
            np.where(held | by_rest, 1.0, warp),
            np.where(held & ~by_rest & ~resting, hold, 0.0),
            by_rest | resting,
            np.where(by_rest, detour, np.broadcast_to(edges, time.shape)),
            np.where(by_rest, 0.0, time),
        )

    def step(
        self,
        apices: Array,
        ways: GestureConnections,
        strength: Array,
        skip_cost: float,
        favour: Array,
        following: tuple[float, float] | None = None,
    ) -> None:
        """Go on to an accent.

        Parameters
        ----------
        apices
            When the apex may be, (n,) [s].
        ways
            Those of `ways` at these times.
        strength
            Weighted cost of the strength of each gesture, (states, apices, nodes).
        skip_cost
            Cost of no gesture.
        favour
            Added to costs, (apices, nodes): decides between equals.
        following
            The latest apex of the next accent [s], and the cost of skipping it; a state that is
            too late for it is worth that much less. None looks no further.
        """
        repetition = self._repetition()
        costs = self._total(ways.smooth, ways.time) + strength + repetition[:, None] + favour
        costs += self._cost[:, None, None]
        ends = apices[:, None] + self._timings.after_apex(ways.warp)
        late, late_skipped = self._late(ends, following)
        nodes = costs.shape[2]
        ranks = (costs + late).reshape(-1, nodes)
        best = ranks.argmin(0)  # of each node one state goes on, so that they differ
        skipped = self._cost + skip_cost
        rank = np.concatenate([ranks[best, np.arange(nodes)], skipped + late_skipped])
        kept = np.argpartition(rank, min(self._width, len(rank)) - 1)[: self._width]
        kept = kept[np.isfinite(rank[kept])]
        chosen = kept < nodes
        node = np.where(chosen, kept, 0)
        parent, pick = np.divmod(best[node], len(apices))
        parent = np.where(chosen, parent, kept - nodes)
        rows = parent, pick, node
        self._steps.append(
            SearchStep(
                parent,
                np.where(chosen, node, -1),
                apices[pick],
                ways.at(rows),
                strength[rows],
                repetition[parent, node],
            )
        )
        self._end = np.where(chosen, ends[rows], self._end[parent])
        self._node = np.where(chosen, node, self._node[parent])
        self._cost = np.where(chosen, costs[rows], skipped[parent])
        self._remember(parent, node, chosen)

    def _repetition(self) -> Array:
        """Return what it costs that gestures repeat what was played lately, (states, nodes)."""
        ago = len(self._steps) - self._used[:, self._phrases]
        again = np.maximum(1.0 - (ago - 1.0) / REMEMBERED_GESTURES, 0.0)
        more = np.clip((self._row - SAME_HAND + 1) / 5.0, 0.0, 1.0)[:, None]
        again += np.where(self._hands == self._hand[:, None], more, 0.0)
        return self._weights.variety * again

    def _remember(
        self, parent: NDArray[np.intp], node: NDArray[np.intp], chosen: NDArray[np.bool_]
    ) -> None:
        """Keep which phrases and hands the states, (states,) each, have used."""
        self._used = self._used[parent]
        self._used[chosen, self._phrases[node[chosen]]] = len(self._steps) - 1
        same = self._hands[node] == self._hand[parent]
        row = np.where(same, self._row[parent] + 1, 1)
        self._row = np.where(chosen, row, self._row[parent])
        self._hand = np.where(chosen, self._hands[node], self._hand[parent])

    def _late(self, ends: Array, following: tuple[float, float] | None) -> tuple[Array, Array]:
        """Return what it costs that gestures (…, nodes), and states, end too late for the next."""
        if following is None:
            return np.zeros(1), np.zeros(1)
        apex, cost = following
        own = self._end + self._least[self._node]
        return np.where(ends + self._least[:-1] > apex, cost, 0.0), np.where(own > apex, cost, 0.0)

    def path(self) -> list[tuple[SearchStep, int]]:
        """Return the steps of the cheapest way, and its state in each."""
        state, found = int(self._cost.argmin()), []
        for step in reversed(self._steps):
            found.append((step, state))
            state = int(step.parent[state])
        return found[::-1]

    def _total(self, smooth: Array, time: Array) -> Array:
        total: Array = self._weights.smooth * smooth + self._weights.time * time
        return total
