"""Body-part motion graphs: one graph for each part of a split profile.

Source: Fernández-Baena 2015, chapter 3.3 (M2.2, M2.3).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.synthesis.body import BodyPart
from cubeling.characters.synthesis.distances.angles import JointAngles
from cubeling.characters.synthesis.graphs.candidates import Candidates, find_candidates
from cubeling.characters.synthesis.graphs.graph import EdgeCosts, MotionGraph, build_graph
from cubeling.characters.synthesis.library import MotionLibrary


def part_distance(library: MotionLibrary, part: BodyPart, velocity: float = 0.0) -> JointAngles:
    """Return the distance of one part; those of all parts sum to that of the body.

    The height of the hips belongs to the legs.
    """
    return JointAngles(library, part.weights, velocity, float(part.prior))


def part_candidates(
    library: MotionLibrary, part: BodyPart, threshold: float, velocity: float = 0.0
) -> Candidates:
    """Return the look-alikes of a part; those of the legs are in one phase of a step (M2.3)."""
    labels = library.phases if part.prior else None
    return find_candidates(part_distance(library, part, velocity), library, threshold, labels)


def threshold_shares(parts: Sequence[BodyPart]) -> list[float]:
    """Return the share of each part in a threshold: st_n = st · W_n / Σ W_m (M2.2).

    If every part passes at one pair of frames, so does the whole body.
    """
    total = sum(part.weight for part in parts)
    return [part.weight / total for part in parts]


@dataclass(frozen=True)
class PartGraphs:
    """The graphs of the parts of a body, over the same frames."""

    parts: tuple[BodyPart, ...]
    """The parts, the prior one first."""

    graphs: tuple[MotionGraph, ...]
    """The graph of each part."""

    @staticmethod
    def build(
        library: MotionLibrary,
        parts: tuple[BodyPart, ...],
        candidates: Mapping[str, Candidates],
        thresholds: Sequence[float],
        costs: EdgeCosts | None = None,
        velocity: float = 0.0,
    ) -> "PartGraphs":
        """Return the graph of each part below its threshold.

        Raises
        ------
        CharacterError
            If a threshold connects nothing.
        """
        graphs = tuple(
            build_graph(
                library,
                part_distance(library, part, velocity),
                candidates[part.name],
                threshold,
                costs,
            )
            for part, threshold in zip(parts, thresholds, strict=True)
        )
        return PartGraphs(parts, graphs)

    @property
    def library(self) -> MotionLibrary:
        """The library that the graphs of all parts share."""
        return self.graphs[0].library

    @cached_property
    def kept(self) -> NDArray[np.bool_]:
        """Which frames are in the graphs of all parts, (frames,)."""
        kept: NDArray[np.bool_] = np.logical_and.reduce([graph.kept for graph in self.graphs])
        return kept

    @property
    def connectivity(self) -> float:
        """Share of the frames that are in the graphs of all parts, 0…1 (M3)."""
        return float(self.kept.mean())

    @property
    def joined_clips(self) -> tuple[str, ...]:
        """Names of the clips that have kept frames."""
        numbers = np.unique(self.library.clip_of[self.kept])
        return tuple(self.library.names[number] for number in numbers)
