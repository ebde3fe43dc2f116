"""The gesture graph: which gesture may follow which, and how long the blend between them is.

Source: Fernández-Baena 2015, sections 4.4.4 and 4.5 (M7, M9).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.skeleton.pose import Array
from cubeling.characters.synthesis.gestures.library import GestureLibrary
from cubeling.characters.synthesis.gestures.nodes import (
    JOINT_WEIGHTS,
    GestureNode,
    NodeMeasures,
    phrase_nodes,
)
from cubeling.characters.synthesis.graphs.components import largest_component

BRANCHING_SHARE = 0.5
"""Share of the phrases that may follow a phrase, on average, at the threshold that is chosen."""

THRESHOLDS = tuple(round(0.1 * step, 1) for step in range(1, 41))
"""Similarity thresholds of which the smallest that will do is chosen (Table 4.2)."""


@dataclass(frozen=True)
class Connectivity:
    """How well a graph is connected at one threshold: a row of Table 4.2."""

    threshold: float
    """Similarity threshold st, one of `THRESHOLDS`."""

    branching: float
    """Edges per node: the branching factor BF."""

    component: int
    """Nodes of the largest strongly connected component."""

    component_branching: float
    """Edges per node in that component."""


@dataclass(frozen=True, eq=False)
class GestureGraph:
    """Gestures, and rest, and what may follow each; the last node is rest."""

    library: GestureLibrary

    threshold: float
    """Below which distance gestures are joined."""

    nodes: tuple[GestureNode, ...]
    """All but rest: the phrases that are kept, then their strokes alone."""

    costs: Array
    """Smoothness cost of each edge, (nodes + 1, nodes + 1): distance ÷ threshold, 0 for what
    follows in its recording, infinite without an edge; between a gesture and rest at most 1."""

    blends: Array
    """Length of the blend of each edge, (nodes + 1, nodes + 1) [s]; 0 in a recording."""

    @staticmethod
    def of(
        library: GestureLibrary,
        threshold: float | None = None,
        weights: Mapping[str, float] = JOINT_WEIGHTS,
        strokes_alone: bool = True,
    ) -> "GestureGraph":
        """Return the graph of a library.

        Parameters
        ----------
        threshold
            Similarity threshold; None takes the smallest of `THRESHOLDS` that keeps every phrase
            and has branches enough.
        weights
            Weight of each body part in the distance.
        strokes_alone
            Whether strokes alone are gestures, too (M9).
        """
        phrases = phrase_nodes(library)
        alone = [GestureNode(each.phrase, each.number, True) for each in phrases]
        nodes = [*phrases, *alone] if strokes_alone else phrases
        measured = NodeMeasures.of(library, nodes, weights)
        count = len(phrases)
        distances, following = measured.distances[:count, :count], _successors(library)
        threshold = threshold or _sufficient_threshold(distances, following)
        joined = (distances < threshold) | following
        inside = largest_component([np.flatnonzero(row).tolist() for row in joined])
        kept = np.flatnonzero(inside[[node.number for node in nodes]])
        all_and_rest = np.append(kept, len(nodes))
        between = np.ix_(all_and_rest, all_and_rest)
        costs = measured.distances[between] / threshold
        costs[costs >= 1.0] = np.inf
        blends = measured.blends()[between]
        natural = np.zeros_like(costs, bool)
        own = int(inside.sum())
        natural[:own, :own] = following[np.ix_(inside, inside)]
        costs[natural] = blends[natural] = 0.0
        for edges in (costs[-1, :], costs[:, -1]):  # from rest, and to it
            np.minimum(edges, 1.0, out=edges)
        return GestureGraph(library, threshold, tuple(nodes[n] for n in kept), costs, blends)

    @property
    def rest(self) -> int:
        """Number of the node of rest."""
        return len(self.nodes)

    @cached_property
    def strengths(self) -> Array:
        """GSI of each node but rest, (nodes,)."""
        return np.array([node.phrase.strength for node in self.nodes])

    @property
    def branching(self) -> float:
        """Edges per node, rest and strokes alone with them."""
        return float(np.isfinite(self.costs).sum() / len(self.costs))


def connectivity(distances: Array, following: NDArray[np.bool_], threshold: float) -> Connectivity:
    """Return how well phrases (n, n) are connected at a threshold; rest is left out."""
    edges = (distances < threshold) | following
    inside = largest_component([np.flatnonzero(row).tolist() for row in edges])
    size = int(inside.sum())
    within = float(edges[np.ix_(inside, inside)].sum())
    return Connectivity(threshold, float(edges.sum()) / len(edges), size, within / size)


def sweep(
    library: GestureLibrary,
    thresholds: Sequence[float] = THRESHOLDS,
    weights: Mapping[str, float] = JOINT_WEIGHTS,
) -> list[Connectivity]:
    """Return how well the phrases of a library are connected at thresholds: Table 4.2."""
    distances = NodeMeasures.of(library, phrase_nodes(library), weights).distances[:-1, :-1]
    return [connectivity(distances, _successors(library), each) for each in thresholds]


def _successors(library: GestureLibrary) -> NDArray[np.bool_]:
    """Return which phrase follows which in a recording, (phrases, phrases): E1."""
    return np.diag(np.array(library.consecutive[1:], bool), 1)


def _sufficient_threshold(distances: Array, following: NDArray[np.bool_]) -> float:
    """Return the smallest threshold that keeps every phrase and has branches enough."""
    count = len(distances)
    for threshold in THRESHOLDS:
        row = connectivity(distances, following, threshold)
        if row.component == count and row.branching >= BRANCHING_SHARE * count:
            return threshold
    return THRESHOLDS[-1]
