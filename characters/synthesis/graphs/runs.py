"""Ways through a motion graph on which each jump is followed by a run of its clip.

A search for the least cost may jump from one half step back into itself, again and again: the legs
stay in mid-stride while the body goes on, and the feet slide. Where a run is part of every jump, a
way takes whole steps.
"""

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.synthesis.graphs.edges import Edges
from cubeling.characters.synthesis.graphs.graph import MotionGraph
from cubeling.characters.synthesis.graphs.search import CostToGo, cost_to_go


class RunningWays:
    """The cheapest ways through a graph that run for some frames after each jump.

    Parameters
    ----------
    graph
        The graph.
    frames
        How long; less where the clip or what is kept of it ends.
    """

    def __init__(self, graph: MotionGraph, frames: int) -> None:
        self.graph = graph
        self.frames = frames
        edges, successors = graph.edges, graph.library.successors
        runs_on = successors[edges.sources] == edges.targets
        onward = np.full(len(graph.library), -1, np.intp)
        costs = np.zeros(len(graph.library))
        onward[edges.sources[runs_on]] = edges.targets[runs_on]
        costs[edges.sources[runs_on]] = edges.weights[runs_on]
        ends, spent = np.arange(len(onward)), np.zeros(len(onward))
        for _ in range(frames):
            going = onward[ends] >= 0
            spent[going] += costs[ends[going]]
            ends[going] = onward[ends[going]]
        # Where each edge of the graph leads when the run is over, and what both cost.
        self._reached = np.where(runs_on, edges.targets, ends[edges.targets])
        self._weights = edges.weights + np.where(runs_on, 0.0, spent[edges.targets])
        self._edges = Edges.of(edges.count, edges.sources, self._reached, self._weights)
        self._onward = onward
        self._to_go: dict[bytes, CostToGo] = {}

    def prepare(self, goals: NDArray[np.bool_]) -> CostToGo:
        """Return the ways from all frames to goals (frames,); the result is kept."""
        key = np.packbits(goals).tobytes()
        if key not in self._to_go:
            self._to_go[key] = cost_to_go(self._edges, goals & self.graph.kept)
        return self._to_go[key]

    def next(self, frame: int, run: int, goals: NDArray[np.bool_]) -> int:
        """Return the frame after a kept frame that has run so long since a jump, towards goals.

        Where no way to a goal runs long enough after each jump, the cheapest of all is taken.
        """
        costs, onward = self.prepare(goals).costs, int(self._onward[frame])
        if run < self.frames and onward >= 0 and np.isfinite(costs[onward]):
            return onward
        own = self.graph.edges.edges_from(frame)
        totals = self._weights[own] + [costs[node] for node in self._reached[own].tolist()]
        best = int(np.argmin(totals))
        if not np.isfinite(totals[best]):
            return self.graph.next(frame, goals)
        return int(self.graph.edges.targets[own][best])
