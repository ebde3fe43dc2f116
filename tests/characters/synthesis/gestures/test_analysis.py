"""Strength and apex of strokes: the laws of M4."""

import math

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from cubeling.characters.skeleton import rotations
from cubeling.characters.synthesis.gestures.analysis import (
    bimanual_strength,
    features,
    find_apex,
    gesture_strength,
    hand_paths,
    kinetic_energies,
    masses,
)
from cubeling.characters.synthesis.gestures.learning import find_gestures
from tests.examples import examples

RATE = 120.0


def stroke(degrees, seconds, joints=1):
    """Return a stroke of one joint with minimum jerk, (frames, joints, 4)."""
    u = np.linspace(0.0, 1.0, round(seconds * RATE) + 1)
    angle = math.radians(degrees) * u**3 * (10 - 15 * u + 6 * u * u)
    return np.repeat(rotations.about("x", angle)[:, None], joints, axis=1)


def strength(degrees, seconds, variant="mean"):
    return gesture_strength(stroke(degrees, seconds), {0: 2.0}, RATE, variant)


@settings(max_examples=examples(30), deadline=None)
@given(st.floats(8, 70), st.floats(0.5, 2.0))
def test_stretching_by_w_lowers_the_mean_by_2_ln_w_and_the_total_by_ln_w(degrees, w):
    for variant, power in (("mean", 2.0), ("total", 1.0)):
        change = strength(degrees, 0.5 * w, variant) - strength(degrees, 0.5, variant)
        assert change == pytest.approx(-power * math.log(w), rel=0.05, abs=0.05)


@given(st.floats(5, 60), st.floats(1.05, 2.0))
def test_a_larger_stroke_is_stronger(degrees, more):
    assert strength(degrees * more, 0.4) > strength(degrees, 0.4)


def test_strengths_are_those_of_the_thesis_for_gentle_and_violent_strokes():
    arm = dict(enumerate([2.0, 3.0, 3.0]))  # all three joints turn alike
    gentle, violent = (gesture_strength(stroke(*s, 3), arm, RATE) for s in ((8, 0.6), (70, 0.3)))
    assert gentle == pytest.approx(7.3, abs=0.5)
    assert violent == pytest.approx(13.1, abs=0.5)


def test_wrapping_quaternions_do_not_count_as_motion():
    turns = stroke(40, 0.3)
    flipped = turns * np.where(np.arange(len(turns)) % 2, -1.0, 1.0)[:, None, None]
    assert gesture_strength(flipped, {0: 2.0}, RATE) == pytest.approx(
        gesture_strength(turns, {0: 2.0}, RATE)
    )


def test_the_features_of_equal_motions_are_equal_and_grow_with_energy():
    weak, strong = (features(stroke(d, 0.4, 2), np.array([2.0, 3.0]), RATE) for d in (10, 40))
    assert (strong > weak).all()
    assert np.exp(weak) - 1 == pytest.approx(
        kinetic_energies(stroke(10, 0.4, 2), np.array([2.0, 3.0]), RATE)
    )


def test_arms_have_the_masses_of_the_thesis(human):
    assert sorted(masses(human.anatomy, "left").values()) == [2.0, 3.0, 3.0]


@pytest.mark.parametrize(
    ("strengths", "apices", "expected"),
    [
        ((10.0, 10.0), (1.0, 1.09), 10.0 + math.log(2.0)),  # together
        ((10.0, 10.0), (1.0, 1.11), 10.0),  # one after the other
        ((10.0, 8.9), (1.0, 1.0), 10.0),  # one of them minor
    ],
)
def test_coordinated_strokes_of_both_hands_add_up(strengths, apices, expected):
    assert bimanual_strength(strengths, apices) == pytest.approx(expected)


BEAT = [(0, 0), (0.4, 0), (0.75, 95), (0.95, 50), (1.5, 50), (2.1, 0), (2.6, 0)]


def test_legs_and_the_way_that_somebody_faces_do_not_count(human, beating):
    def others(turns, now):
        legs = [human.anatomy.joints[s + "UpperLeg"] for s in ("left", "right")]
        turns[:, legs] = rotations.about("x", 0.5 * np.sin(5 * now))[:, None]
        turns[:, 0] = rotations.about("y", 2.0 * now)

    plain, busy = (
        find_gestures(beating(BEAT, others=each), human.skeleton, human.anatomy)
        for each in (None, others)
    )
    assert [p.bounds for p in plain.phrases] == [p.bounds for p in busy.phrases]
    assert plain.phrases[0].strength == pytest.approx(busy.phrases[0].strength)


@pytest.mark.parametrize("seconds", [0.15, 0.22, 0.31, 0.4])
@pytest.mark.parametrize(("size", "recoil"), [(25, 0), (25, 6), (45, 12), (70, 3)])
def test_the_apex_is_where_the_stroke_ends_within_two_frames(human, beating, seconds, size, recoil):
    down = 0.75 + seconds
    knots = [(0, 0), (0.4, 0), (0.75, 95), (down, 95 - size), (down + 0.15, 95 - size + recoil)]
    clip = beating([*knots, (down + 0.6, 95 - size + recoil)])
    path = hand_paths(clip.poses, human.skeleton, human.anatomy)["right"]
    found = find_apex(path, clip.rate, (round(0.75 * 60), round(down * 60)))
    assert abs(found - down * 60) <= 2


def matthews(truth, said):
    """Return Matthews' correlation coefficient of two classes."""
    tp, fp, fn, tn = [
        float((said[truth == true] == found).sum()) for found in (1, 0) for true in (1, 0)
    ]
    spread = (tp + fp) * (tp + fn) * (tn + fp) * (tn + fn)
    return (tp * tn - fp * fn) / math.sqrt(spread) if spread else 0.0


def best_split(values, truth):
    """Return the threshold of the greatest coefficient."""
    limits = np.quantile(values, np.linspace(0.05, 0.95, 37))
    return max(limits, key=lambda limit: matthews(truth, (values > limit).astype(int)))


def test_no_mix_of_indicators_tells_weak_from_strong_better_than_the_strength():
    rng = np.random.default_rng(4)
    rows, energy = [], []
    for _ in range(600):
        degrees, seconds = rng.uniform(8, 70), rng.uniform(0.2, 0.6)
        turns = stroke(degrees, seconds)
        gsi = gesture_strength(turns, {0: 2.0}, RATE)
        speeds = np.abs(np.diff(rotations.to_rotation_vector(turns)[:, 0, 0])) * RATE
        rows.append([gsi, seconds, degrees, speeds.max(), np.ptp(speeds), 1.0])
        energy.append(gsi + rng.normal(0.0, 1.2))  # two experts agree that far
    data, truth = np.array(rows), (np.array(energy) > np.median(energy)).astype(int)
    train, test = slice(0, 300), slice(300, 600)
    mix, *_ = np.linalg.lstsq(data[train], 2.0 * truth[train] - 1.0, rcond=None)
    scores = []
    for values in (data[:, 0], data @ mix):
        limit = best_split(values[train], truth[train])
        scores.append(matthews(truth[test], (values[test] > limit).astype(int)))
    assert scores[0] >= 0.5
    assert scores[0] >= scores[1] - 0.02
