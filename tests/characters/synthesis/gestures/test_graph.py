"""The gesture graph: Table 4.2, and what may follow what (M7, M9)."""

from dataclasses import replace

import numpy as np

from cubeling.characters.synthesis.gestures.graph import THRESHOLDS, GestureGraph, sweep
from cubeling.characters.synthesis.gestures.nodes import BLEND_S, LONGEST_TO_REST_S


def test_a_higher_threshold_connects_more_until_all_are_connected(library):
    rows = sweep(library, (0.003, 0.01, 0.1, 0.4, 1.0, 2.0))
    for name in ("branching", "component"):
        values = [getattr(row, name) for row in rows]
        assert values == sorted(values)
    assert rows[0].component < len(library.phrases) == rows[-1].component


def test_what_follows_in_a_recording_follows_at_once(library):
    graph = GestureGraph.of(library, 0.4)
    for number in np.flatnonzero(library.consecutive):
        assert graph.costs[number - 1, number] == graph.blends[number - 1, number] == 0.0


def test_costs_are_shares_of_the_threshold_and_rest_is_always_near(library):
    graph = GestureGraph.of(library, 0.4)
    edges = graph.costs[np.isfinite(graph.costs)]
    assert edges.min() >= 0.0
    assert edges.max() <= 1.0
    assert np.isfinite(graph.costs[graph.rest]).all()
    assert np.isfinite(graph.costs[:, graph.rest]).all()
    blends = graph.blends[:-1, :-1]
    assert {*np.unique(blends).tolist()} <= {0.0, *BLEND_S}
    assert graph.blends[-1].max() <= LONGEST_TO_REST_S


def test_strokes_alone_are_gestures_too(library):
    whole = GestureGraph.of(library, 0.4, strokes_alone=False)
    both = GestureGraph.of(library, 0.4)
    assert len(both.nodes) == 2 * len(whole.nodes)
    for node in both.nodes[len(whole.nodes) :]:
        assert node.alone
        assert node.frames == node.phrase.stroke


def test_the_smallest_threshold_that_keeps_every_phrase_is_chosen(library):
    graph = GestureGraph.of(library)
    assert graph.threshold in THRESHOLDS
    (row,) = sweep(library, [graph.threshold])
    assert row.component == len(library.phrases)
    (below,) = sweep(library, [graph.threshold - 0.1])
    assert below.component < len(library.phrases) or below.branching < len(library.phrases) / 2


def test_what_is_not_connected_is_left_out(library):
    alone = replace(library, phrases=library.phrases[:8])
    graph = GestureGraph.of(alone, 0.001)
    assert 1 <= len({node.number for node in graph.nodes}) < 8


def test_weights_of_joints_count(library):
    arms = {"leftUpperArm": 1.0, "rightUpperArm": 1.0}
    fewer, usual = (sweep(library, [0.2], weights)[0] for weights in (arms, {"neck": 1.0} | arms))
    assert fewer.branching >= usual.branching
