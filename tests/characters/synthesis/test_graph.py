from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from scipy.sparse import csr_array
from scipy.sparse.csgraph import connected_components, dijkstra

from cubeling.characters import CharacterError
from cubeling.characters.synthesis.distances import distance_matrix, thesis_distance
from cubeling.characters.synthesis.graphs.building import standard_graph
from cubeling.characters.synthesis.graphs.candidates import Candidates, find_candidates
from cubeling.characters.synthesis.graphs.components import largest_component, strong_components
from cubeling.characters.synthesis.graphs.edges import Edges
from cubeling.characters.synthesis.graphs.graph import EdgeCosts, build_graph
from cubeling.characters.synthesis.graphs.runs import RunningWays
from cubeling.characters.synthesis.graphs.search import HopCosts, cost_to_go
from cubeling.characters.synthesis.graphs.storage import WHOLE_BODY, StoredGraph
from cubeling.characters.synthesis.library import MotionLibrary
from cubeling.characters.synthesis.transitions.playback import path_clip
from tests.examples import examples


@st.composite
def graphs(draw: st.DrawFn) -> Edges:
    count = draw(st.integers(2, 9))
    nodes = st.integers(0, count - 1)
    edges = draw(st.lists(st.tuples(nodes, nodes, st.integers(1, 9)), min_size=1, max_size=25))
    sources, targets, weights = np.array(edges).T
    return Edges.of(count, sources, targets, weights.astype(float))


def _sparse(edges: Edges) -> csr_array:
    shape = (edges.count, edges.count)
    return csr_array((edges.weights, (edges.sources, edges.targets)), shape=shape)


def test_a_node_without_a_way_back_is_dropped() -> None:
    successors = [[2], [], [3, 1], [4], [5], [0]]
    assert np.flatnonzero(largest_component(successors)).tolist() == [0, 2, 3, 4, 5]


@settings(max_examples=examples(40))
@given(graphs())
def test_components_are_those_of_scipy(edges: Edges) -> None:
    own = strong_components(edges.successors)
    _, theirs = connected_components(_sparse(edges), connection="strong")
    assert np.array_equal(own[:, None] == own, theirs[:, None] == theirs)


@settings(max_examples=examples(40))
@given(graphs(), st.data())
def test_shortest_paths_are_those_of_scipy(edges: Edges, data: st.DataObject) -> None:
    goals = np.array(data.draw(st.lists(st.booleans(), min_size=edges.count, max_size=edges.count)))
    to_go = cost_to_go(edges, goals)
    expected = dijkstra(_sparse(edges))
    for node in range(edges.count):
        least = expected[node, goals].min(initial=np.inf)
        assert to_go.costs[node] == least
        assert to_go.lengths[node] == len(to_go.path(node)) - 1
        if np.isfinite(least):
            path = to_go.path(node)
            costs = _sparse(edges).toarray()
            assert sum(costs[a, b] for a, b in pairwise(path)) == least
            assert goals[path[-1]]


@settings(max_examples=examples(40))
@given(graphs(), st.integers(0, 6))
def test_bounded_paths_are_the_cheapest_of_their_length(edges: Edges, hops: int) -> None:
    table = HopCosts.of(edges, (0,), hops)
    costs = np.full((edges.count, edges.count), np.inf)
    costs[edges.sources, edges.targets] = edges.weights
    best = np.full(edges.count, np.inf)
    best[0] = 0.0
    for hop in range(hops + 1):
        assert np.array_equal(table.costs[hop], best)
        for node in np.flatnonzero(np.isfinite(best)):
            path = table.path(int(node), hop)
            assert len(path) == hop + 1
            steps = costs[path[:-1], path[1:]]
            assert steps.sum() == pytest.approx(best[node])
        best = (best[:, None] + costs).min(0)


def test_candidates_are_the_local_minima_between_clips(library: MotionLibrary) -> None:
    distance = thesis_distance(library)
    found = find_candidates(distance, library, 0.2)
    values = distance_matrix(distance)
    a, b = library.clip("Walk"), library.clip("WalkLeftMedium")
    block = np.pad(values[np.ix_(a, b)], 1, mode="wrap")  # both are loops
    near = [
        block[1 + i : len(a) + 1 + i, 1 + j : len(b) + 1 + j]
        for i in (-1, 0, 1)
        for j in (-1, 0, 1)
    ]
    lowest = (block[1:-1, 1:-1] == np.min(near, axis=0)) & (block[1:-1, 1:-1] < 0.2)
    own = np.isin(found.rows, a) & np.isin(found.columns, b)
    pairs = set(zip(found.rows[own] - a[0], found.columns[own] - b[0], strict=True))
    assert pairs == set(zip(*np.nonzero(lowest), strict=True))
    turned = set(zip(found.columns.tolist(), found.rows.tolist(), strict=True))
    assert turned == set(zip(found.rows.tolist(), found.columns.tolist(), strict=True))


def test_every_kept_frame_reaches_every_other(stored: StoredGraph) -> None:
    graph = standard_graph(stored)
    assert set(graph.joined_clips) == {"Walk", "WalkLeftWide", "WalkLeftMedium", "Run", "stand"}
    count, _ = connected_components(
        _sparse(graph.edges)[graph.kept][:, graph.kept], connection="strong"
    )
    assert count == 1
    jumps = graph.library.successors[graph.edges.sources] != graph.edges.targets
    landing = graph.library.predecessors[graph.edges.targets[jumps]]
    assert graph.jumps == jumps.sum() > 0
    # By the rule "successor", the frame after the jump looks like the frame that it replaces.
    replaced = graph.library.successors[graph.edges.sources[jumps]]
    alike = graph.library.phases[replaced] == graph.library.phases[graph.edges.targets[jumps]]
    assert alike.all()
    assert (landing != graph.edges.sources[jumps]).all()


def test_a_walk_never_ends(stored: StoredGraph) -> None:
    graph = standard_graph(stored)
    start = int(np.flatnonzero(graph.kept)[0])
    walk = graph.walk(start, np.random.default_rng(3))
    visited = np.bincount([next(walk) for _ in range(100_000)], minlength=len(graph.library))
    assert (visited[~graph.kept] == 0).all()
    assert (visited[graph.kept] > 0).all()


def test_the_root_does_not_leap_at_jumps(stored: StoredGraph) -> None:
    graph = standard_graph(stored)
    walk = graph.walk(int(np.flatnonzero(graph.kept)[0]), np.random.default_rng(4))
    clip = path_clip(graph.library, [next(walk) for _ in range(400)])
    steps = np.linalg.norm(np.diff(clip.track[:, :2], axis=0), axis=1)
    longest = np.linalg.norm(graph.library.steps[:, :2], axis=1).max()
    assert steps.max() < longest + 1e-3
    # What is sampled is what was put together.
    assert clip.travel(0.0, clip.duration).length == pytest.approx(
        float(np.hypot(*(clip.track[-1] - clip.track[0])[:2]))
    )


def test_a_blend_joins_two_clips_without_a_jump(stored: StoredGraph) -> None:
    library = stored.library
    walk, run = library.clip("Walk"), library.clip("Run")
    frames = [*walk[:30], *run[20:]]
    sharp, soft = (path_clip(library, frames, blend=blend) for blend in (1e-6, 0.25))
    elbow = library.anatomy.joints["leftLowerArm"]

    def largest_step(clip: object) -> float:
        turns = clip.poses.rotations[:, elbow]  # type: ignore[attr-defined]
        dots = np.abs((turns[1:] * turns[:-1]).sum(-1))
        return float(2 * np.arccos(np.minimum(dots, 1.0)).max())

    assert largest_step(soft) < largest_step(sharp) / 5
    assert np.allclose(soft.poses.rotations[-1, elbow], sharp.poses.rotations[-1, elbow])


def test_a_clip_that_ends_at_a_jump_goes_on_meanwhile(stored: StoredGraph) -> None:
    run = stored.library.clip("Run")
    library = replace(stored.library, loops=np.zeros(len(stored.library.names), bool))
    frames = [*run, *run[20:]]  # half a cycle off
    clip = path_clip(library, frames)
    at = clip.in_place.globals(library.skeleton)[..., :3, 3]
    jumps = np.linalg.norm(np.diff(at, 2, axis=0), axis=-1).max(1)
    own = np.linalg.norm(np.diff(library.positions[run], 2, axis=0), axis=-1).max()
    assert jumps[len(run) - 4 : len(run)].max() < 1.3 * own


def test_the_rule_same_shows_the_look_alike_twice(stored: StoredGraph) -> None:
    library, distance = stored.library, thesis_distance(stored.library)
    found = stored.candidates[WHOLE_BODY]
    same = build_graph(library, distance, found, 0.3, EdgeCosts("same"))
    edges = same.edges
    jumps = library.successors[edges.sources] != edges.targets
    exact = distance.pairs(edges.sources[jumps], edges.targets[jumps])
    assert np.allclose(edges.weights[jumps], exact)


def test_costs_make_jumps_dear(stored: StoredGraph) -> None:
    library, distance = stored.library, thesis_distance(stored.library)
    found = stored.candidates[WHOLE_BODY]
    plain, dear = (
        build_graph(library, distance, found, 0.3, EdgeCosts(jump=jump)) for jump in (0.0, 5.0)
    )
    jumps = library.successors[plain.edges.sources] != plain.edges.targets
    assert np.allclose((dear.edges.weights - plain.edges.weights)[jumps], 5.0)
    assert np.allclose((dear.edges.weights - plain.edges.weights)[~jumps], 0.0)


def test_a_threshold_that_connects_nothing_is_refused(library: MotionLibrary) -> None:
    once = replace(library, loops=np.zeros(len(library.names), bool))
    none = np.array([], np.intp)
    nothing = Candidates(none, none, np.array([]), np.array([]))
    with pytest.raises(CharacterError, match=r"threshold of 0.001 connects nothing"):
        build_graph(once, thesis_distance(once), nothing, 0.001)


def test_a_request_that_cannot_be_met_is_refused(stored: StoredGraph) -> None:
    graph = standard_graph(stored)
    with pytest.raises(CharacterError, match="not in the graph"):
        graph.path(int(np.flatnonzero(graph.kept)[0]), np.zeros(len(graph.library), bool))


def test_a_way_that_runs_on_after_each_jump_arrives(stored: StoredGraph) -> None:
    graph = standard_graph(stored, EdgeCosts(per_frame=0.01))
    library = graph.library
    goals = np.isin(np.arange(len(library)), library.clip("Run")) & graph.kept
    ways = RunningWays(graph, 6)
    for frame in np.flatnonzero(graph.kept & ~goals)[::17].tolist():
        run, runs = 6, []
        for _ in range(300):
            if goals[frame]:
                break
            onward = ways.next(frame, run, goals)
            if onward == library.successors[frame]:
                run += 1
            else:
                runs.append(run)
                run = 0
            frame = onward
        assert goals[frame]
        assert all(each >= 6 for each in runs)
