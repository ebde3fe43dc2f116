"""Gestures are found in recordings without marks."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from cubeling.characters import Clip
from cubeling.characters.control.controllers.recordings import read_motions
from cubeling.characters.errors import CharacterError
from cubeling.characters.synthesis.gestures.learning import (
    RATE_HZ,
    WALKS,
    find_gestures,
    learn_gestures,
)
from cubeling.characters.synthesis.gestures.segmentation import (
    HOLD,
    PREPARATION,
    REST,
    RETRACTION,
    SETTLE_S,
    STROKE,
    phrase_bounds,
)

SHARED_DATA = Path(__file__).parents[5] / "shared" / "data"

BEATS = [
    *((0, 0), (0.6, 0), (0.95, 95), (1.05, 95), (1.25, 50), (1.7, 50)),  # up, hold, down, hold
    *((1.95, 90), (2.15, 45), (2.6, 45), (3.1, 0), (3.7, 0)),  # up, down, hold, back
]


def test_phases_of_two_beats_are_found_where_they_are(human, beating):
    first, second = find_gestures(beating(BEATS), human.skeleton, human.anatomy).phrases
    assert (first.hand, second.hand) == ("right", "right")
    settled = 1.25 + SETTLE_S, 2.15 + SETTLE_S  # annotators count that to the stroke
    true = [(0.6, 0.95, 1.05, settled[0], 1.7, 1.7), (1.7, 1.95, 1.95, settled[1], 2.6, 3.1)]
    for phrase, times in zip((first, second), true, strict=True):
        assert np.abs(np.array(phrase.bounds) / RATE_HZ - times).max() < 0.1
    assert abs(first.apex - 1.25 * RATE_HZ) <= 2
    assert abs(second.apex - 2.15 * RATE_HZ) <= 2
    assert first.bounds[5] == second.bounds[0]  # one follows the other


def test_authored_strokes_are_found_again(library):
    """Nine units; `tests.bench.gestures` goes through all."""
    found = total = 0
    for number in range(2, len(library.recordings), 3):
        recording = library.recordings[number]
        rests = [np.repeat(recording.turns[[end]], 30, axis=0) for end in (0, -1)]
        turns = np.concatenate([rests[0], recording.turns, rests[1]])
        clip = Clip("unit", RATE_HZ, library.poses(turns), loop=False)
        phrases = find_gestures(clip, library.skeleton, library.anatomy).phrases
        for truth in (each for each in library.phrases if each.recording == number):
            total += 1
            found += any(
                abs(each.apex - 30 - truth.apex) <= 2 and each.hand == truth.hand
                for each in phrases
            )
    assert total >= 24
    assert found / total > 0.85


ONE_BEAT = [(0, 0), (0.35, 95), (0.45, 95), (0.65, 50), (1.0, 50), (1.5, 0)]


def both_hands(human, beating, left, right):
    """Return a clip of both arms."""
    clip, other = beating(right), beating(left, "left")
    joint = human.anatomy.joints["leftLowerArm"]
    clip.poses.rotations[:, joint] = other.poses.rotations[:, joint]
    return clip


@pytest.mark.parametrize("seconds", [0.0, 0.1, 0.3])
def test_a_clip_that_is_cut_tightly_rests_in_its_edges(human, beating, seconds):
    last = ONE_BEAT[-1][0] + 2 * seconds
    knots = [(0, 0), *((time + seconds, bend) for time, bend in ONE_BEAT), (last + 0.01, 0)]
    (found,) = find_gestures(beating(knots), human.skeleton, human.anatomy).phrases
    assert abs(found.apex / RATE_HZ - 0.65 - seconds) <= 0.05
    assert abs(found.stroke[0] / RATE_HZ - 0.45 - seconds) <= 0.1
    assert found.bounds[5] / RATE_HZ >= 1.3 + seconds


def test_a_beat_of_some_centimetres_is_found(human, beating):
    small = [(time + 0.5, bend / 5) for time, bend in ONE_BEAT]
    clip = beating([(0, 0), *small, (2.5, 0)])
    assert len(find_gestures(clip, human.skeleton, human.anatomy).phrases) == 1


@pytest.mark.parametrize(("later", "size", "hand"), [(0.0, 1, "both"), (0.1, 1, "both")])
def test_what_both_hands_do_at_once_is_one_gesture(human, beating, later, size, hand):
    left = [(0, 0), *((time + 0.5 + later, size * bend) for time, bend in ONE_BEAT), (2.5, 0)]
    right = [(0, 0), *((time + 0.5, bend) for time, bend in ONE_BEAT), (2.5, 0)]
    clip = both_hands(human, beating, left, right)
    (found,) = find_gestures(clip, human.skeleton, human.anatomy).phrases
    assert found.hand == hand


@pytest.mark.parametrize(("share", "hand"), [(0.2, "right"), (0.8, "both")])
def test_a_minor_stroke_of_the_other_hand_is_none(human, beating, share, hand):
    right = [(0, 0), *((time + 0.5, bend) for time, bend in ONE_BEAT), (2.5, 0)]
    left = [(time, share * bend) for time, bend in right]
    clip = both_hands(human, beating, left, right)
    (found,) = find_gestures(clip, human.skeleton, human.anatomy).phrases
    assert found.hand == hand


def test_who_passes_the_place_of_rest_at_speed_does_not_rest_there(human, beating):
    swings = [(0, 0)] + [(0.5 * (n + 1), 60 * (-1) ** n) for n in range(7)] + [(4.0, 0)]
    found = find_gestures(beating(swings), human.skeleton, human.anatomy)
    assert not found.phrases
    assert found.reason == "hands pass their place of rest without resting there"


def test_a_phrase_ends_where_the_next_one_begins():
    labels = np.repeat(
        [REST, PREPARATION, HOLD, STROKE, HOLD, PREPARATION, STROKE, RETRACTION, REST], 5
    ).astype(np.int8)
    assert phrase_bounds(labels) == [(5, 10, 15, 19, 25, 25), (25, 30, 30, 34, 35, 40)]


def test_recordings_become_units_from_rest_to_rest(human, beating):
    library = learn_gestures(
        [beating(BEATS), beating(BEATS, "left")], human.skeleton, human.anatomy
    )
    assert [each.hand for each in library.phrases] == ["right", "right", "left", "left"]
    assert library.consecutive == (False, True, False, True)
    for phrase in library.phrases:
        assert (
            0
            <= phrase.bounds[0]
            < phrase.bounds[5]
            < len(library.recordings[phrase.recording].turns)
        )


@pytest.mark.parametrize("knots", [[(0, 0), (3, 0)], [(0, 0), (0.4, 30), (0.8, 0), (1.2, 30)]])
def test_who_never_leaves_rest_or_never_rests_is_refused_in_one_line(human, beating, knots):
    with pytest.raises(
        CharacterError, match=r"no gesture found in beating: (no hand|hands)"
    ) as caught:
        learn_gestures([beating(knots)], human.skeleton, human.anatomy)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(("heights", "found"), [(0.1, 2), (1.0, 0)])
def test_hands_of_who_walks_off_make_no_gestures(human, beating, heights, found):
    clip = beating(BEATS)
    places = clip.poses.translations.copy()
    hips = human.anatomy.joints["hips"]
    places[:, hips, 2] += np.linspace(0.0, heights * human.height, len(places))
    walked = replace(clip, poses=replace(clip.poses, translations=places))
    analysed = find_gestures(walked, human.skeleton, human.anatomy)
    assert len(analysed.phrases) == found
    assert (analysed.reason == WALKS) == (not found)


@pytest.mark.slow(reason="two recordings of people are retargeted and analysed")
@pytest.mark.skipif(not (SHARED_DATA / "bvh").is_dir(), reason="no shared data")
def test_people_who_gesture_are_learned_and_walkers_are_not(human):
    (clip,) = read_motions([str(SHARED_DATA / "bvh" / "131_03.bvh")], human)
    assert len(learn_gestures([clip], human.skeleton, human.anatomy).phrases) >= 4
    (walk,) = read_motions([str(SHARED_DATA / "cmu-mocap" / "02" / "02_01.amc")], human)
    with pytest.raises(CharacterError, match="no gesture found"):
        learn_gestures([walk], human.skeleton, human.anatomy)
