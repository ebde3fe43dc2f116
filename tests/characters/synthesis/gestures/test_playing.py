"""Planned gestures as a motion: continuous, exact where it must be, and from rest to rest."""

from dataclasses import replace

import numpy as np
import pytest

from cubeling.characters import Motion
from cubeling.characters.skeleton import rotations
from cubeling.characters.synthesis.gestures.graph import GestureGraph
from cubeling.characters.synthesis.gestures.planning import GesturePlanner, GestureSettings
from tests.characters.synthesis.gestures.test_planning import BODYSPEECH, LETTER, accents

FRAME_S = 1 / 60


@pytest.fixture(scope="module", params=[BODYSPEECH, LETTER, GestureSettings()])
def plan(request, library):
    return GesturePlanner.of(GestureGraph.of(library), request.param).plan(accents(5), 40.0, seed=1)


@pytest.fixture(scope="module")
def motion(plan):
    return plan.motion()


def steps(turns):
    """Return the angle of each joint from frame to frame."""
    between = rotations.multiply(rotations.conjugate(turns[:-1]), turns[1:])
    return np.linalg.norm(rotations.to_rotation_vector(between), axis=-1)


def test_it_is_a_motion_in_place(motion, library):
    assert isinstance(motion, Motion)
    pose = motion.sample(1.234)
    assert pose.rotations.shape == library.skeleton.rest.rotations.shape
    assert np.linalg.norm(pose.rotations, axis=-1) == pytest.approx(1.0)
    assert motion.travel(0.0, 5.0).length == 0.0


def test_it_begins_and_ends_in_rest_and_has_no_weight_there(motion, library):
    for time in (0.0, motion.duration, motion.duration + 9.0):
        assert np.abs(motion.turns(time) - library.rest).max() < 1e-9
        assert motion.weight(time) == 0.0


def test_strokes_of_phrases_are_the_recorded_frames_bit_for_bit(library):
    """The model "bodyspeech" warps what is around a stroke; accents press it to do so."""
    graph = GestureGraph.of(library)
    settings = replace(BODYSPEECH, longest_hold_s=0.0, anticipations=1)
    plan = GesturePlanner.of(graph, settings).plan(accents(5), 40.0, seed=1)
    motion, warped = plan.motion(), 0
    for each in plan.gestures:
        if len(each.knots) == 4:
            recorded = library.recordings[each.node.phrase.recording].turns
            for frame in range(*each.node.phrase.stroke):
                assert np.array_equal(motion.turns(each.time_of(frame)), recorded[frame])
            warped += each.warp != 1.0
    assert warped >= 5


def test_nothing_jumps_where_gestures_are_joined(plan, motion, library):
    limits = np.max([steps(each.turns).max(0) for each in library.recordings], axis=0)
    for segment in motion.segments[1:]:
        times = segment.start + np.array([-1.5, -0.5, 0.5, 1.5]) * FRAME_S
        played = np.stack([motion.turns(float(now)) for now in times])
        assert (steps(played) < 2.0 * limits).all()


def test_the_weight_is_1_in_strokes_and_is_continuous(plan, motion):
    for each in plan.gestures:
        for time in (*map(each.time_of, each.node.phrase.stroke), each.apex):
            assert motion.weight(time) == pytest.approx(1.0, abs=1e-6)
    weights = [motion.weight(float(t)) for t in np.arange(0.0, motion.duration, FRAME_S)]
    assert min(weights) >= 0.0
    assert max(weights) <= 1.0
    assert np.abs(np.diff(weights)).max() < 0.35


def test_phases_are_in_order_and_cover_the_gesture(plan):
    for each in plan.gestures:
        names = [name for name, *_ in each.phases]
        assert "stroke" in names
        assert each.phases[0][1] == pytest.approx(each.start)
        assert each.phases[-1][2] == pytest.approx(each.end)
        for (_, _, end), (_, start, _) in zip(each.phases, each.phases[1:], strict=False):
            assert end == pytest.approx(start)
