"""Gestures are chosen for accents: in time, strong enough, and not too expensive (M7, M9)."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, strategies as st

from cubeling.characters.speech.speech import Accent
from cubeling.characters.synthesis.gestures.alignment import (
    PHRASE_WARPS,
    STROKE_WARPS,
    WHOLE_WARPS,
    Timings,
    warp_cost,
)
from cubeling.characters.synthesis.gestures.graph import GestureGraph
from cubeling.characters.synthesis.gestures.planning import GesturePlanner, GestureSettings

BODYSPEECH = GestureSettings(accent_floor=0.0)
THESIS = replace(BODYSPEECH, model="thesis")
LETTER = replace(THESIS, longest_hold_s=0.0, anticipations=1)
"""The thesis without holds, and with one anticipation for each accent."""


@pytest.fixture(scope="module")
def graph(library):
    return GestureGraph.of(library)


def accents(seed, count=40, mean=0.6):
    """Return accents with gaps and pauses as in speech, and ln PSI of all sizes."""
    rng = np.random.default_rng(seed)
    gaps = 0.3 + rng.gamma(2.0, (mean - 0.3) / 2.0, count)
    gaps += np.where(rng.uniform(size=count) < 0.12, 0.9, 0.0)
    strengths = np.exp(np.clip(rng.normal(-0.9, 0.7, count), -3.0, 0.0))
    return [
        Accent(*each) for each in zip(np.cumsum(gaps).tolist(), strengths.tolist(), strict=True)
    ]


@given(st.floats(0.0, 1.0))
def test_a_warp_costs_nothing_at_1_and_is_symmetric_at_both_limits(share):
    for low, high in (WHOLE_WARPS, PHRASE_WARPS, STROKE_WARPS):
        shorter = float(warp_cost(np.array(1 - share * (1 - low)), low, high))
        longer = float(warp_cost(np.array(1 + share * (high - 1)), low, high))
        assert shorter == pytest.approx(longer, abs=1e-9) == pytest.approx(share, abs=1e-9)
        assert warp_cost(np.array([low - 1e-3, high + 1e-3]), low, high).tolist() == [np.inf] * 2


@pytest.mark.parametrize("settings", [BODYSPEECH, THESIS, LETTER])
@pytest.mark.parametrize("seed", [0, 1])
def test_every_rule_holds_for_every_gesture(graph, settings, seed):
    given = accents(seed)
    planner = GesturePlanner.of(graph, settings)
    plan = planner.plan(given, given[-1].time + 1.0, seed=seed)
    chosen = [*(each.accent for each in plan.gestures), *plan.skipped]
    assert sorted(each.time for each in chosen) == sorted({each.time for each in chosen})
    timings = Timings.of(graph, settings.model)
    end = 0.0
    for each in plan.gestures:
        assert settings.synchrony.holds(each.accent.time, each.apex)
        assert abs(each.time_of(min(each.node.phrase.apex, each.node.frames[1])) - each.apex) < 1e-9
        low, high = timings.low[each.number], timings.high[each.number]
        assert low - 1e-9 <= each.warp <= high + 1e-9
        assert each.start >= end - 1e-9
        assert 0.0 <= each.hold <= settings.longest_hold_s
        if settings.model == "thesis" and not each.relaxed:
            weakest, strongest = graph.strengths.min(), graph.strengths.max()
            centre = np.clip(planner.intensity.centre(each.emphasized), weakest, strongest)
            assert abs(each.strength - centre) < planner.intensity.margin
        end = each.end


def test_few_accents_stay_without_a_valid_gesture(graph):
    for settings in (BODYSPEECH, THESIS):
        planner, invalid, count = GesturePlanner.of(graph, settings), 0, 0
        for seed in range(6):
            plan = planner.plan(accents(seed), 60.0, seed=seed)
            invalid += len(plan.skipped) + sum(each.relaxed for each in plan.gestures)
            count += len(plan.skipped) + len(plan.gestures)
        assert invalid <= 0.03 * count


@pytest.mark.parametrize("settings", [BODYSPEECH, LETTER])
def test_the_beam_never_costs_more_than_the_greedy_search(graph, settings):
    beam, greedy = (GesturePlanner.of(graph, replace(settings, beam=n)) for n in (20, 1))
    costs = [
        [planner.plan(accents(seed), 60.0, seed=seed).cost for planner in (beam, greedy)]
        for seed in range(4)
    ]
    assert all(one <= other for one, other in costs)
    assert np.sum(costs, axis=0)[0] < 0.8 * np.sum(costs, axis=0)[1]


def test_strengths_follow_the_accents_only_with_the_intensity_rule(graph):
    def correlation(settings):
        planner, psi, gsi = GesturePlanner.of(graph, settings), [], []
        for seed in range(8):
            gestures = planner.plan(accents(seed), 60.0, seed=seed).gestures
            psi += [each.accent.strength for each in gestures]
            gsi += [each.strength for each in gestures]
        return np.corrcoef(np.log(psi), gsi)[0, 1]

    assert correlation(THESIS) > 0.5
    assert abs(correlation(replace(THESIS, strength_weight=0.0))) < 0.2


@pytest.mark.parametrize("settings", [BODYSPEECH, THESIS, GestureSettings()])
def test_the_slider_makes_gestures_stronger_or_weaker(graph, settings):
    planner = GesturePlanner.of(graph, settings)
    means = [
        np.mean([each.strength for each in planner.plan(accents(3), 60.0, delta).gestures])
        for delta in (-1.0, 0.0, 1.0)
    ]
    assert means[0] < means[1] < means[2]


def test_only_the_phases_around_a_stroke_are_warped_unless_it_is_alone(graph):
    timings = Timings.of(graph, "bodyspeech")
    for number, node in enumerate(graph.nodes):
        begins = node.phrase.stroke[0] == node.frames[0]
        assert timings.whole[number] == (node.alone or begins)
    assert Timings.of(graph, "thesis").whole.all()


def test_a_warped_stroke_is_as_strong_as_its_speed(graph):
    timings, slower = Timings.of(graph, "thesis"), np.array(1.25)
    played = timings.played_strength(graph.strengths, slower)
    assert played == pytest.approx(graph.strengths - 2 * np.log(1.25))
    phrases = Timings.of(graph, "bodyspeech").played_strength(graph.strengths, slower)
    assert (phrases == graph.strengths).any()


def test_of_close_accents_the_stronger_carries_the_gesture(graph):
    given = [Accent(1.0, 0.5), Accent(1.3, 0.9), Accent(3.0, 0.4), Accent(0.1, 1.0)]
    plan = GesturePlanner.of(graph, BODYSPEECH).plan(sorted(given, key=lambda a: a.time), 4.0)
    assert [each.accent.time for each in plan.gestures] == [1.3, 3.0]  # 0.1 is too early


def test_an_accent_that_comes_too_soon_is_skipped_and_the_rest_goes_on(graph):
    crowd = replace(BODYSPEECH, min_spacing_s=0.1)
    given = [Accent(1.0 + 0.12 * n, 0.9) for n in range(6)] + [Accent(3.5, 0.8)]
    plan = GesturePlanner.of(graph, crowd).plan(given, 4.0)
    assert plan.skipped
    assert plan.gestures[-1].accent.time == 3.5


def test_a_plan_depends_on_the_seed_and_on_nothing_else(graph):
    planner = GesturePlanner.of(graph, BODYSPEECH)
    one, again, other = (planner.plan(accents(1), 60.0, seed=seed) for seed in (4, 4, 5))
    assert one.gestures == again.gestures
    assert one.gestures != other.gestures


def test_hands_take_turns_and_phrases_are_seldom_repeated(graph):
    plan = GesturePlanner.of(graph, BODYSPEECH).plan(accents(2, 60), 90.0)
    numbers = [each.node.number for each in plan.gestures]
    assert all(a != b for a, b in pairwise(numbers))
    hands = [each.node.phrase.hand for each in plan.gestures]
    assert min(hands.count(hand) for hand in ("left", "right", "both")) >= 3


def test_silence_has_no_gestures(graph):
    plan = GesturePlanner.of(graph).plan([], 2.0)
    assert not plan.gestures
    assert not plan.skipped
    motion = plan.motion()
    assert motion.duration == 2.0
    assert motion.weight(1.0) == 0.0


def test_a_library_of_one_phrase_still_beats(library):
    one = replace(library, phrases=library.phrases[:1])
    plan = GesturePlanner(one).plan([Accent(2.0, 0.8), Accent(5.0, 0.8), Accent(8.0, 0.8)], 9.0)
    assert len(plan.gestures) == 3
