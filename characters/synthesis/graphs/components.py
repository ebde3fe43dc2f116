"""Strongly connected components of a directed graph."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray


def strong_components(successors: Sequence[Sequence[int]]) -> NDArray[np.intp]:
    """Return the number of each node's strongly connected component, (nodes,).

    R. Tarjan, "Depth-first search and linear graph algorithms", 1972; without recursion, because a
    clip is a path of thousands of nodes. A component has a lower number than those that lead to it.

    >>> strong_components([[1], [2], [1, 3], []]).tolist()
    [2, 1, 1, 0]
    """
    count = len(successors)
    order = [0] * count  # when a node was reached, from 1; 0 is not yet
    low = [0] * count  # the earliest node on the stack that it leads back to
    component = [-1] * count
    stack: list[int] = []
    reached = found = 0
    for start in range(count):
        if order[start]:
            continue
        work = [(start, iter(successors[start]))]
        reached += 1
        order[start] = low[start] = reached
        stack.append(start)
        while work:
            node, rest = work[-1]
            for other in rest:
                if not order[other]:
                    reached += 1
                    order[other] = low[other] = reached
                    stack.append(other)
                    work.append((other, iter(successors[other])))
                    break
                if component[other] < 0:
                    low[node] = min(low[node], order[other])
            else:
                work.pop()
                if work:
                    parent = work[-1][0]
                    low[parent] = min(low[parent], low[node])
                if low[node] == order[node]:
                    while component[node] < 0:
                        component[stack.pop()] = found
                    found += 1
    return np.array(component, np.intp)


def largest_component(successors: Sequence[Sequence[int]]) -> NDArray[np.bool_]:
    """Return which nodes are in the largest component, (nodes,); of equals, in the first."""
    component = strong_components(successors)
    sizes = np.bincount(component)
    first = component[np.argmax(sizes[component] == sizes.max())]
    largest: NDArray[np.bool_] = component == first
    return largest
