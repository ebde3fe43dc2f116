"""Graphs and searches as the thesis prints them, beside our own."""

import numpy as np
import pytest

from cubeling.characters.synthesis.body import default_body_plan
from cubeling.characters.synthesis.distances import thesis_distance
from cubeling.characters.synthesis.graphs.building import analyse, part_graphs, standard_graph
from cubeling.characters.synthesis.graphs.graph import EdgeCosts, MotionGraph
from cubeling.characters.synthesis.graphs.parts import PartGraphs, threshold_shares
from cubeling.characters.synthesis.graphs.search import cost_to_go
from cubeling.characters.synthesis.graphs.storage import StoredGraph, load_graph, save_graph
from cubeling.characters.synthesis.library import MotionLibrary
from cubeling.characters.synthesis.transitions.evaluation import (
    shortest_part_outcome,
    shortest_standard_outcome,
)
from cubeling.characters.synthesis.transitions.progressive import (
    PRINTED_SEARCH,
    SearchSettings,
    TransitionPlanner,
)


@pytest.fixture(scope="module")
def printed(library: MotionLibrary) -> StoredGraph:
    return analyse(library, as_printed=True)


@pytest.fixture(scope="module")
def graphs(printed: StoredGraph) -> PartGraphs:
    return part_graphs(printed)


def _requests(kept: np.ndarray, library: MotionLibrary) -> list[tuple[int, np.ndarray]]:
    """Return some frames of the walk, each with a clip to go to."""
    targets = [library.clip_of == clip for clip in (1, 3)]
    return [(int(f), goals) for f in np.flatnonzero(kept)[:60:13] for goals in targets]


def test_one_threshold_is_shared_out_by_weight(printed: StoredGraph, stored: StoredGraph) -> None:
    library = printed.library
    parts = default_body_plan().split(printed.profile, library.skeleton, library.anatomy)
    ratios = [
        printed.thresholds[part.name] / share
        for part, share in zip(parts, threshold_shares(parts), strict=True)
    ]
    assert ratios == pytest.approx([ratios[0]] * len(parts))
    assert len(part_graphs(printed).joined_clips) >= len(part_graphs(stored).joined_clips)


def test_a_file_keeps_which_frames_its_jumps_join(printed: StoredGraph, tmp_path) -> None:
    save_graph(printed, tmp_path / "p.graph")
    graph = standard_graph(load_graph(tmp_path / "p.graph"), EdgeCosts(natural_weight=0.5))
    edges, library = graph.edges, graph.library
    jumps = library.successors[edges.sources] != edges.targets
    assert jumps.any()
    exact = thesis_distance(library).pairs(edges.sources[jumps], edges.targets[jumps])
    assert edges.weights[jumps] == pytest.approx(exact, rel=1e-4)  # frames are kept as float32


def test_no_part_leaves_or_arrives_before_the_legs(graphs: PartGraphs) -> None:
    planner = TransitionPlanner(graphs, None, PRINTED_SEARCH)
    answered = 0
    for frame, goals in _requests(graphs.kept, graphs.library):
        found = planner.plan(frame, goals)
        legs, *others = found.moves
        for move in others:
            assert legs.departure <= move.departure <= legs.departure + 10
            assert legs.arrival <= move.arrival <= legs.arrival + 10
            assert abs(move.length - move.required) <= 0.2 * move.required + 1e-9
        answered += found.fallback in ("", "arrival")
    assert answered


@pytest.mark.parametrize("symmetric", [False, True])
def test_a_part_takes_the_cheapest_of_the_cheapest_paths_that_fit(
    graphs: PartGraphs, symmetric: bool
) -> None:
    planner = TransitionPlanner(graphs, None, SearchSettings("shortest", symmetric=symmetric))
    library, found = graphs.library, 0
    nodes = np.arange(len(library))
    for frame, goals in _requests(graphs.kept, library):
        plans = (planner.plan_to(frame, goal) for goal in np.flatnonzero(goals)[::4].tolist())
        plan = next((each for each in plans if each is not None), None)
        if plan is None:
            continue
        found += 1
        legs, *others = plan.moves
        for graph, move in zip(graphs.graphs[1:], others, strict=True):
            early = 10 if symmetric else 0
            best = np.inf
            for arrival in range(max(legs.arrival - early, 1), legs.arrival + 11):
                end = _along(library, int(legs.frames[-1]), arrival - legs.arrival)
                ways = cost_to_go(graph.edges, nodes == end)
                for departure in range(max(legs.departure - early, 0), legs.departure + 11):
                    start = _along(library, frame, departure)
                    length, needed = len(ways.path(start)) - 1, arrival - departure
                    if length and abs(length - needed) <= 0.2 * needed:
                        best = min(best, ways.costs[start])
            assert move.cost == pytest.approx(best)
    assert found


def _along(library: MotionLibrary, frame: int, count: int) -> int:
    """Return a frame some frames on or back in a clip; all clips here repeat."""
    neighbours = library.successors if count > 0 else library.predecessors
    for _ in range(abs(count)):
        frame = int(neighbours[frame])
    return frame


@pytest.mark.parametrize("settings", [PRINTED_SEARCH, SearchSettings("shortest")])
def test_the_shortest_answer_of_parts_is_the_least_over_all_goals(
    graphs: PartGraphs, settings: SearchSettings
) -> None:
    """Eq. 3.4: duration and response have their minima each by itself."""
    planner = TransitionPlanner(graphs, None, settings)
    for frame, goals in _requests(graphs.kept, graphs.library)[::3]:
        kept = np.flatnonzero(goals & graphs.kept).tolist()
        every = [planner.plan_to(frame, goal) for goal in kept]
        found = [each for each in every if each is not None]
        own = shortest_part_outcome(planner, frame, goals)
        assert own.answered == bool(found)
        if found:
            assert own.duration == min(each.duration for each in found)
            assert own.response == min(each.response for each in found)


def test_the_shortest_answer_of_the_whole_body_is_the_least_over_all_goals(
    printed: StoredGraph,
) -> None:
    graph: MotionGraph = standard_graph(printed)
    library = graph.library
    for frame, goals in _requests(graph.kept, library):
        paths = []
        for goal in np.flatnonzero(goals & graph.kept):
            paths.append(graph.path(frame, np.arange(len(library)) == goal))
        own = shortest_standard_outcome(graph, frame, goals)
        assert own.duration == min(len(path) - 1 for path in paths)
        leaves = [np.flatnonzero(library.successors[path[:-1]] != path[1:])[0] for path in paths]
        assert own.response == min(leaves)
