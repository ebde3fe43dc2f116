"""From clips to graphs: candidates, thresholds that join all clips, and the graphs themselves."""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from cubeling.characters.errors import CharacterError
from cubeling.characters.skeleton.pose import Array
from cubeling.characters.synthesis.body import default_body_plan
from cubeling.characters.synthesis.choices import DEFAULT_PROFILE
from cubeling.characters.synthesis.distances import DISTANCES, FrameDistance, JointAngles
from cubeling.characters.synthesis.graphs.candidates import Candidates, find_candidates
from cubeling.characters.synthesis.graphs.graph import (
    PRINTED_COSTS,
    EdgeCosts,
    MotionGraph,
    build_graph,
)
from cubeling.characters.synthesis.graphs.parts import (
    PartGraphs,
    part_candidates,
    part_distance,
    threshold_shares,
)
from cubeling.characters.synthesis.graphs.storage import WHOLE_BODY, StoredGraph
from cubeling.characters.synthesis.library import MotionLibrary

USUAL_THRESHOLD = 0.165
"""Threshold at which the thesis' own clips are all joined; lower ones are rarely worth it."""

LARGEST_THRESHOLD = 1.5
"""Frames that are less alike than this are never joined: 49° a joint, in the weighted mean."""

_STEP = 1.02  # thresholds are found to 2 %


def analyse(
    library: MotionLibrary,
    profile: str = DEFAULT_PROFILE,
    distance: str = "angles",
    threshold: float | None = None,
    progress: Callable[[str], None] = lambda part: None,
    as_printed: bool = False,
) -> StoredGraph:
    """Return all that a file of a motion graph holds.

    Parameters
    ----------
    library
        The frames.
    profile
        The split profile of the part graphs.
    distance
        Name of the distance of the whole body, one of `DISTANCES`; parts compare angles.
    threshold
        Threshold of the whole body, shared out to the parts by their weights (M2.2). Left out,
        each graph has the least one that joins all its clips, but at least its share of the usual
        one (M2, go beyond: free thresholds).
    progress
        Called with the name of each part before its frames are compared.
    as_printed
        Whether the parts share the least threshold that joins all their clips, where none is given,
        and a jump joins the look-alikes themselves (M1.2, M2.2).

    Raises
    ------
    CharacterError
        If there is no such distance or profile, or the threshold connects nothing.
    """
    check_choices(profile, distance)
    parts = default_body_plan().split(profile, library.skeleton, library.anatomy)
    whole = DISTANCES[distance](library)
    progress(WHOLE_BODY)
    found = find_candidates(whole, library, threshold or LARGEST_THRESHOLD, library.phases)
    candidates = {WHOLE_BODY: found}
    thresholds = {WHOLE_BODY: threshold or joining_threshold(library, whole, found)}
    for part, share in zip(parts, threshold_shares(parts), strict=True):
        if part.name not in candidates:
            progress(part.name)
            limit = share * (threshold or LARGEST_THRESHOLD)
            found = part_candidates(library, part, limit)
            own = part_distance(library, part)
            candidates[part.name] = found
            thresholds[part.name] = (
                limit if threshold else joining_threshold(library, own, found, share)
            )
    if as_printed:
        rule = PRINTED_COSTS.rule
        stored = StoredGraph(library, distance, profile, thresholds, candidates, rule)
        return stored if threshold else replace(stored, thresholds=_shared_thresholds(stored))
    return StoredGraph(library, distance, profile, thresholds, candidates)


def _shared_thresholds(stored: StoredGraph) -> dict[str, float]:
    """Return the thresholds of a graph, with one for all parts, shared out by their weights."""
    library = stored.library
    parts = default_body_plan().split(stored.profile, library.skeleton, library.anatomy)
    names = [part.name for part in parts if part.name != WHOLE_BODY]

    def share_out(threshold: float) -> dict[str, float]:
        shares = zip(names, threshold_shares(parts), strict=False)
        return {**stored.thresholds, **{name: share * threshold for name, share in shares}}

    return share_out(
        critical_threshold(
            lambda threshold: len(
                part_graphs(replace(stored, thresholds=share_out(threshold))).joined_clips
            ),
            USUAL_THRESHOLD,
            LARGEST_THRESHOLD,
        )
    )


def check_choices(profile: str, distance: str) -> None:
    """Refuse a split profile or a distance that does not exist."""
    for kind, name, known in (
        ("split profile", profile, default_body_plan().profiles),
        ("distance", distance, DISTANCES),
    ):
        if name not in known:
            raise CharacterError(f"no {kind} {name!r}; there are {', '.join(known)}")


def joining_threshold(
    library: MotionLibrary, distance: FrameDistance, candidates: Candidates, share: float = 1.0
) -> float:
    """Return the least threshold that joins as many clips as any does, to 2 %.

    It is at least the usual threshold, times the part's share; a distance of other units than
    angles has no usual one.
    """
    most = float(candidates.distances.max(initial=1e-3)) * _STEP
    low = USUAL_THRESHOLD * share if isinstance(distance, JointAngles) else most * 1e-3
    return critical_threshold(
        lambda threshold: len(build_graph(library, distance, candidates, threshold).joined_clips),
        low,
        max(most, low),
    )


def critical_threshold(joined: Callable[[float], int], low: float, high: float) -> float:
    """Return the least threshold between two at which as many clips are joined as at the higher.

    `joined` returns how many clips a threshold joins. The answer is 2 % exact, and never too low.

    >>> 5.0 <= critical_threshold(lambda threshold: 1 + (threshold >= 5.0), 0.1, 30.0) < 5.1
    True
    """

    def count_joined(threshold: float) -> int:
        try:
            return joined(threshold)
        except CharacterError:  # it connects nothing
            return 0

    most = count_joined(high)
    if count_joined(low) >= most:
        return low
    while high > low * _STEP:
        middle = math.sqrt(low * high)
        low, high = (low, middle) if count_joined(middle) >= most else (middle, high)
    return high


def standard_graph(stored: StoredGraph, costs: EdgeCosts | None = None) -> MotionGraph:
    """Return the graph of the whole body that a file holds; its jumps have the file's rule."""
    return build_graph(
        stored.library,
        DISTANCES[stored.distance](stored.library),
        stored.candidates[WHOLE_BODY],
        stored.thresholds[WHOLE_BODY],
        replace(costs or EdgeCosts(), rule=stored.rule),
    )


def part_graphs(stored: StoredGraph, costs: EdgeCosts | None = None) -> PartGraphs:
    """Return the part graphs that a file holds; their jumps have the file's rule."""
    library = stored.library
    parts = default_body_plan().split(stored.profile, library.skeleton, library.anatomy)
    thresholds = [stored.thresholds[part.name] for part in parts]
    costs = replace(costs or EdgeCosts(), rule=stored.rule)
    return PartGraphs.build(library, parts, stored.candidates, thresholds, costs)


def connectivity_curves(stored: StoredGraph, points: int = 24) -> dict[str, tuple[Array, Array]]:
    """Return how connectivity grows with the threshold: thresholds and shares, by graph (M3).

    The thresholds of each graph lie around the one in use, in equal ratios.
    """
    library = stored.library
    parts = default_body_plan().split(stored.profile, library.skeleton, library.anatomy)
    distances: dict[str, FrameDistance] = {WHOLE_BODY: DISTANCES[stored.distance](library)}
    distances |= {part.name: part_distance(library, part) for part in parts}
    curves = {}
    for name, distance in distances.items():
        found = stored.candidates[name]
        thresholds = stored.thresholds[name] * np.geomspace(0.02, 2.0, points)
        costs = EdgeCosts(rule=stored.rule)
        curves[name] = thresholds, connectivity(library, distance, found, thresholds, costs)
    return curves


def connectivity(
    library: MotionLibrary,
    distance: FrameDistance,
    candidates: Candidates,
    thresholds: Array,
    costs: EdgeCosts | None = None,
) -> Array:
    """Return the share of frames in the largest component at each threshold (M3)."""
    shares = []
    for threshold in thresholds.tolist():
        try:
            graph = build_graph(library, distance, candidates, threshold, costs)
            shares.append(graph.connectivity)
        except CharacterError:  # it connects nothing
            shares.append(0.0)
    return np.array(shares)
