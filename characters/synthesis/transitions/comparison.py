"""The standard graph and the part graphs of the same clips, each at its critical threshold."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, partial

from cubeling.characters.synthesis.body import BodyPart, default_body_plan
from cubeling.characters.synthesis.distances import JointAngles, thesis_distance
from cubeling.characters.synthesis.graphs.building import LARGEST_THRESHOLD, critical_threshold
from cubeling.characters.synthesis.graphs.candidates import Candidates, find_candidates
from cubeling.characters.synthesis.graphs.graph import EdgeCosts, MotionGraph, build_graph
from cubeling.characters.synthesis.graphs.parts import (
    PartGraphs,
    part_candidates,
    part_distance,
    threshold_shares,
)
from cubeling.characters.synthesis.library import MotionLibrary
from cubeling.characters.synthesis.transitions.evaluation import (
    Answers,
    Requests,
    by_pair,
    graph_requests,
    part_outcome,
    shortest_part_outcome,
    shortest_standard_outcome,
    standard_outcome,
)
from cubeling.characters.synthesis.transitions.progressive import (
    PRINTED_SEARCH,
    SearchSettings,
    TransitionPlanner,
)

LOWEST_THRESHOLD = 1e-4


@dataclass(frozen=True)
class Comparison:
    """A library, compared once, of which graphs at any threshold are made."""

    library: MotionLibrary

    costs: EdgeCosts
    """What edges cost in all graphs."""

    @cached_property
    def distance(self) -> JointAngles:
        """The distance of the thesis."""
        return thesis_distance(self.library)

    @cached_property
    def candidates(self) -> Candidates:
        """Look-alikes of the whole body."""
        return find_candidates(
            self.distance, self.library, 2 * LARGEST_THRESHOLD, self.library.phases
        )

    def standard(self, threshold: float) -> MotionGraph:
        """Return the graph of the whole body at a threshold."""
        return build_graph(self.library, self.distance, self.candidates, threshold, self.costs)

    @cached_property
    def standard_threshold(self) -> float:
        """The least threshold at which the graph of the whole body joins most clips."""
        return critical_threshold(
            lambda threshold: len(self.standard(threshold).joined_clips),
            LOWEST_THRESHOLD,
            2 * LARGEST_THRESHOLD,
        )

    def split(self, profile: str) -> "SplitComparison":
        """Return the same for the part graphs of a split profile."""
        library = self.library
        parts = default_body_plan().split(profile, library.skeleton, library.anatomy)
        candidates = {
            part.name: part_candidates(library, part, 2 * LARGEST_THRESHOLD * share)
            for part, share in zip(parts, threshold_shares(parts), strict=True)
        }
        return SplitComparison(self, parts, candidates)

    def answers(self, graph: MotionGraph, asked: Requests) -> Answers:
        """Return the answers of the graph of the whole body."""
        return by_pair(partial(standard_outcome, graph), self.library, asked)

    def shortest(self, graph: MotionGraph, asked: Requests) -> Answers:
        """Return the shortest answers of the graph of the whole body (eq. 3.4)."""
        return by_pair(partial(shortest_standard_outcome, graph), self.library, asked)

    def part_answers(
        self,
        profiles: Sequence[PartGraphs],
        asked: Requests,
        settings: SearchSettings | None = None,
    ) -> Answers:
        """Return the answers of part graphs, of the best split profile for each request."""
        standard = self.standard(self.standard_threshold)
        planners = [TransitionPlanner(graphs, standard, settings) for graphs in profiles]
        return by_pair(partial(part_outcome, planners), self.library, asked)


@dataclass(frozen=True)
class SplitComparison:
    """The part graphs of a split profile at any threshold."""

    whole: Comparison
    """The library, and the graph of the whole body."""

    parts: tuple[BodyPart, ...]

    candidates: Mapping[str, Candidates]
    """Look-alikes of each part, by its name."""

    def graphs(self, threshold: float) -> PartGraphs:
        """Return the part graphs at a threshold that is shared out by weight (M2.2)."""
        return self._at([threshold * share for share in threshold_shares(self.parts)])

    def free(self) -> PartGraphs:
        """Return the part graphs, each at its own critical threshold (M2, go beyond)."""
        return self._at(self.free_thresholds)

    @cached_property
    def threshold(self) -> float:
        """The least threshold at which the parts together keep most clips."""
        return critical_threshold(
            lambda threshold: len(self.graphs(threshold).joined_clips),
            LOWEST_THRESHOLD,
            2 * LARGEST_THRESHOLD,
        )

    @cached_property
    def free_thresholds(self) -> list[float]:
        """The least threshold of each part at which its graph joins most clips."""
        shares = threshold_shares(self.parts)
        return [
            self._critical(part, 2 * LARGEST_THRESHOLD * share)
            for part, share in zip(self.parts, shares, strict=True)
        ]

    def _critical(self, part: BodyPart, most: float) -> float:
        """Return the least threshold at which the graph of a part joins most clips."""
        library, candidates = self.whole.library, self.candidates[part.name]
        distance = part_distance(library, part)

        def count_joined(threshold: float) -> int:
            return len(build_graph(library, distance, candidates, threshold).joined_clips)

        return critical_threshold(count_joined, LOWEST_THRESHOLD, most)

    def answers(
        self,
        graphs: PartGraphs,
        asked: Requests,
        settings: SearchSettings | None = None,
    ) -> Answers:
        """Return the answers of the part graphs."""
        return self.whole.part_answers([graphs], asked, settings)

    def shortest(
        self,
        graphs: PartGraphs,
        asked: Requests,
        settings: SearchSettings = PRINTED_SEARCH,
    ) -> Answers:
        """Return the shortest answers of the part graphs (eq. 3.4)."""
        planner = TransitionPlanner(graphs, None, settings)
        return by_pair(partial(shortest_part_outcome, planner), graphs.library, asked)

    def _at(self, thresholds: list[float]) -> PartGraphs:
        return PartGraphs.build(
            self.whole.library, self.parts, self.candidates, thresholds, self.whole.costs
        )


def common_requests(standard: MotionGraph, graphs: PartGraphs, stride: int) -> Requests:
    """Return requests that both can answer; see `requests`."""
    return graph_requests(standard.library, standard.kept & graphs.kept, stride)
