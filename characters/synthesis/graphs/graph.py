"""Motion graphs: frames as nodes, continuations and jumps as edges.

Source: Fernández-Baena 2015, chapters 2.3 and 3.3 (M1, M2.3); after Kovar, Gleicher and Pighin
2002, and Lee et al. 2002.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.errors import CharacterError
from cubeling.characters.skeleton.pose import Array
from cubeling.characters.synthesis.balance import unsupported_lean, velocity_lean
from cubeling.characters.synthesis.distances.distance import FrameDistance
from cubeling.characters.synthesis.graphs.candidates import Candidates
from cubeling.characters.synthesis.graphs.components import largest_component
from cubeling.characters.synthesis.graphs.edges import Edges, Nodes
from cubeling.characters.synthesis.graphs.search import CostToGo, cost_to_go
from cubeling.characters.synthesis.library import MotionLibrary

EdgeRule = Literal["successor", "same"]


@dataclass(frozen=True)
class EdgeCosts:
    """Which jumps there are, and what edges cost in a search."""

    rule: EdgeRule = "successor"
    """Whether frames i + 1 and j look alike at a jump from i to j, or, as the thesis prints it,
    i and j; then a look-alike is seen twice (M1.2, [R])."""

    natural_weight: float = 1.0
    """Factor of the distance of consecutive frames; at 0 a search waits for the best jump."""

    per_frame: float = 0.0
    """Added to every edge: the price of time."""

    jump: float = 0.0
    """Added to every jump; distances are squared, so small jumps are cheap (M2.4)."""

    balance: float = 0.0
    """Factor of the squared lean [rad²] that an edge would take to stay on one's feet: of a jump to
    another velocity within a blend, and of every frame whose hips are beyond the feet."""

    most_jumps: int = 0
    """Largest number of jumps from a frame into one clip, the cheapest ones; 0 for all. Small parts
    of the body have hundreds, which a search in play has no time for."""

    root: bool = False
    """Whether a jump costs the square root of its distance, which makes many small ones dear."""


PRINTED_COSTS = EdgeCosts(rule="same")
"""Edges as the thesis prints them (M1.2)."""


@dataclass(frozen=True)
class MotionGraph:
    """A pruned graph: from every kept frame, every other kept frame can be reached."""

    library: MotionLibrary

    edges: Edges
    """Continuations and jumps between kept frames."""

    kept: NDArray[np.bool_]
    """Which frames are in the largest strongly connected component, (frames,)."""

    threshold: float
    """Jumps have a smaller distance than this."""

    barred_jumps: int
    """Number of jumps that were left out because the feet stand otherwise on the other side."""

    dropped_jumps: int
    """Number of jumps that were left out because they lead nowhere, or from nowhere."""

    _to_go: dict[bytes, CostToGo] = field(default_factory=dict, repr=False, compare=False)

    @property
    def connectivity(self) -> float:
        """Share of the frames in the largest strongly connected component, 0…1 (M3)."""
        return float(self.kept.mean())

    @property
    def jumps(self) -> int:
        """Number of edges that are not continuations."""
        natural = self.library.successors[self.edges.sources] == self.edges.targets
        return int(len(natural) - natural.sum())

    @property
    def joined_clips(self) -> tuple[str, ...]:
        """Names of the clips that have kept frames."""
        numbers = np.unique(self.library.clip_of[self.kept])
        return tuple(self.library.names[number] for number in numbers)

    def to_go(self, goals: NDArray[np.bool_]) -> CostToGo:
        """Return the shortest paths from all frames to goals (frames,); the result is kept."""
        key = np.packbits(goals).tobytes()
        if key not in self._to_go:
            self._to_go[key] = cost_to_go(self.edges, goals & self.kept)
        return self._to_go[key]

    def to_frame(self, frame: int) -> CostToGo:
        """Return the shortest paths from all frames to one; the result is kept."""
        return self.to_go(np.arange(len(self.library)) == frame)

    def next(self, node: int, goals: NDArray[np.bool_]) -> int:
        """Return the frame after a kept frame on the cheapest path to any of the goals (frames,).

        A frame that is a goal itself is left on the cheapest way to a goal.

        Raises
        ------
        CharacterError
            If the frame is not in the graph, or no goal is.
        """
        if not self.kept[node]:
            raise CharacterError(f"frame {node} is not in the graph; start from a kept frame")
        to_go = self.to_go(goals)
        if to_go.following[node] >= 0:
            return to_go.following[node]
        own = self.edges.edges_from(node)
        totals = [
            weight + to_go.costs[target]
            for target, weight in zip(
                self.edges.targets[own].tolist(), self.edges.weights[own].tolist(), strict=True
            )
        ]
        best = int(np.argmin(totals))
        if not np.isfinite(totals[best]):
            raise CharacterError(
                "what is asked for is not in the graph: its frames were pruned; "
                "raise the threshold or add clips"
            )
        return int(self.edges.targets[own][best])

    def path(self, start: int, goals: NDArray[np.bool_]) -> list[int]:
        """Return the frames of the cheapest path to any of the goals (frames,), at least two.

        Raises
        ------
        CharacterError
            If the start is not in the graph, or no goal is.
        """
        return [start, *self.to_go(goals).path(self.next(start, goals))]

    def walk(self, start: int, rng: np.random.Generator, jump: float = 0.2) -> Iterator[int]:
        """Yield the frames of an endless walk; at a frame with jumps it takes one so often."""
        node = start
        while True:
            yield node
            following = self.edges.successors[node]
            natural = int(self.library.successors[node])
            if natural in following and (len(following) == 1 or rng.random() >= jump):
                node = natural
            else:
                others = [each for each in following if each != natural] or following
                node = others[int(rng.integers(len(others)))]


def build_graph(
    library: MotionLibrary,
    distance: FrameDistance,
    candidates: Candidates,
    threshold: float,
    costs: EdgeCosts | None = None,
) -> MotionGraph:
    """Return the graph of all jumps nearer than a threshold, pruned.

    What remains is the largest strongly connected component (M1.4). Consecutive frames are always
    connected (erratum 3).

    Raises
    ------
    CharacterError
        If the threshold connects nothing.
    """
    costs = costs or EdgeCosts()
    near = candidates.below(threshold)
    sources = library.predecessors[near.rows] if costs.rule == "successor" else near.rows
    usable = (sources >= 0) & (library.successors[sources] != near.columns)
    sources, targets, jumps = sources[usable], near.columns[usable], near.distances[usable]
    if costs.most_jumps:
        best = _cheapest(sources, library.clip_of[targets], jumps, costs.most_jumps)
        sources, targets, jumps = sources[best], targets[best], jumps[best]
    jumps = (np.sqrt(jumps) if costs.root else jumps) + costs.jump
    starts = np.flatnonzero(library.successors >= 0)
    ends = library.successors[starts]
    natural = costs.natural_weight * distance.pairs(starts, ends)
    if costs.balance:
        leans = unsupported_lean(library)
        pushes = velocity_lean(library, sources, targets)
        jumps = jumps + costs.balance * (np.square(pushes) + np.square(leans[targets]))
        natural = natural + costs.balance * np.square(leans[ends])
    every = Edges.of(
        len(library),
        np.concatenate([starts, sources]),
        np.concatenate([ends, targets]),
        np.concatenate([natural, jumps]) + costs.per_frame,
    )
    kept = largest_component(every.successors)
    edges = every.within(kept)
    if not len(edges):
        raise CharacterError(
            f"a threshold of {threshold:g} connects nothing: only {len(near)} pairs of frames are "
            "nearer; raise it"
        )
    inside = int((kept[sources] & kept[targets]).sum())
    barred = candidates.count_barred_below(threshold)
    return MotionGraph(library, edges, kept, threshold, barred, len(sources) - inside)


def _cheapest(sources: Nodes, clips: Nodes, distances: Array, most: int) -> NDArray[np.bool_]:
    """Return which jumps are among the nearest ones from their frame into their clip, (jumps,)."""
    order = np.lexsort((distances, clips, sources))
    new = np.ones(len(order), bool)
    new[1:] = (np.diff(sources[order]) != 0) | (np.diff(clips[order]) != 0)
    places = np.arange(len(order))
    rank = places - np.maximum.accumulate(np.where(new, places, 0))
    best = np.zeros(len(order), bool)
    best[order] = rank < most
    return best
