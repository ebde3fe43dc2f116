"""Directed weighted edges between numbered nodes, as arrays."""

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.skeleton.pose import Array

_FOLD = 16
"""Edges to a node whose costs are compared together; from 8 to 16 the search is fastest."""

Nodes = NDArray[np.intp]
"""Indices of nodes, (n,)."""


@dataclass(frozen=True)
class Edges:
    """The edges of a graph, sorted by their first nodes. What is not there costs ∞ (erratum 3)."""

    count: int
    """Number of nodes, with and without edges."""

    sources: Nodes
    """First node of each edge, ascending, (edges,)."""

    targets: Nodes
    """Second node of each edge, (edges,)."""

    weights: Array
    """Cost of each edge, not negative, (edges,)."""

    @staticmethod
    def of(count: int, sources: Nodes, targets: Nodes, weights: Array) -> "Edges":
        """Return edges in order; of two between the same nodes, the cheaper."""
        order = np.lexsort((weights, targets, sources))
        sources, targets, weights = sources[order], targets[order], weights[order]
        new = np.ones(len(sources), bool)
        new[1:] = (np.diff(sources) != 0) | (np.diff(targets) != 0)
        return Edges(count, sources[new], targets[new], weights[new])

    def __len__(self) -> int:
        return len(self.sources)

    def within(self, nodes: NDArray[np.bool_]) -> "Edges":
        """Return the edges between some of the nodes, (nodes,); the nodes keep their numbers."""
        keep = nodes[self.sources] & nodes[self.targets]
        return Edges(self.count, self.sources[keep], self.targets[keep], self.weights[keep])

    def prepare(self) -> None:
        """Sort the edges as searches of few jumps need them, which takes 10 ms for 10⁵ edges."""
        _ = self.firsts, self.onward, self.by_target

    @cached_property
    def firsts(self) -> Nodes:
        """Number of the first edge of each node, and the number of edges, (nodes + 1,)."""
        return np.searchsorted(self.sources, np.arange(self.count + 1))

    def edges_from(self, node: int) -> slice:
        """Return the edges that leave a node."""
        return slice(int(self.firsts[node]), int(self.firsts[node + 1]))

    def weight(self, source: int, target: int) -> float:
        """Return the cost of the edge between two nodes; there is one."""
        own = self.edges_from(source)
        return float(self.weights[own][np.searchsorted(self.targets[own], target)])

    @cached_property
    def onward(self) -> Array:
        """Cost of the edge from each node to the next number, or ∞, (nodes − 1,)."""
        found = np.full(self.count - 1, np.inf)
        own = self.targets == self.sources + 1
        found[self.sources[own]] = self.weights[own]
        return found

    @cached_property
    def successors(self) -> list[list[int]]:
        """The nodes that each node leads to."""
        targets = self.targets.tolist()
        firsts = self.firsts.tolist()
        return [targets[a:b] for a, b in pairwise(firsts)]

    @cached_property
    def incoming(self) -> list[list[tuple[int, float]]]:
        """The nodes that lead to each node, and what that costs."""
        found: list[list[tuple[int, float]]] = [[] for _ in range(self.count)]
        rows = zip(self.sources.tolist(), self.targets.tolist(), self.weights.tolist(), strict=True)
        for source, target, weight in rows:
            found[target].append((source, weight))
        return found

    @cached_property
    def by_target(self) -> tuple[Nodes, Array, Nodes, Nodes]:
        """The edges in the order of their second nodes: first nodes, costs, (edges,).

        Then the second nodes themselves, and the place of the first edge to each.
        """
        order = np.argsort(self.targets, kind="stable")
        reached, firsts = np.unique(self.targets[order], return_index=True)
        return self.sources[order], self.weights[order], reached, firsts

    @cached_property
    def folded(self) -> tuple[Nodes, NDArray[np.float32], Nodes, Nodes]:
        """The edges to each node in columns of 16: first nodes, and costs, (16, columns).

        The places left over cost ∞. Then the second nodes, and the first column of each. With it
        all nodes are reached 3 times as fast as with `by_target`: the least of many short rows is
        slow, and so is an array that is too large for a cache.
        """
        sources, weights, reached, firsts = self.by_target
        counts = np.diff(np.append(firsts, len(sources)))
        columns = np.append(0, np.cumsum(-(-counts // _FOLD)))
        place = np.arange(len(sources)) - np.repeat(firsts, counts)
        at = place % _FOLD, np.repeat(columns[:-1], counts) + place // _FOLD
        nodes = np.zeros((_FOLD, columns[-1]), np.intp)
        costs = np.full(nodes.shape, np.inf, np.float32)
        nodes[at], costs[at] = sources, weights
        return nodes, costs, reached, columns[:-1]
