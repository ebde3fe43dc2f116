"""A blend of two poses that move does not change its way round."""

import itertools

import numpy as np
import pytest
from hypothesis import given, strategies as st

from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.way_round import WayRound

RATE = 60


def turn_of(one, other):
    return float(
        np.linalg.norm(
            rotations.to_rotation_vector(rotations.multiply(rotations.conjugate(one), other))
        )
    )


def speeds(mix, turned, weights):
    """Largest angle from frame to frame of a mix of a still joint and one that turns about y."""
    still = rotations.about("y", [0.0])
    shown = [mix(still, rotations.about("y", [a]), u) for a, u in zip(turned, weights, strict=True)]
    return max(turn_of(a, b) for a, b in itertools.pairwise(shown))


def test_past_half_a_turn_it_goes_on_where_the_shorter_way_jumps():
    turned = np.linspace(2.0, 5.0, RATE)
    weights = np.full(RATE, 0.5)
    assert speeds(WayRound().mix, turned, weights) < 0.5 * np.ptp(turned) / RATE * 1.1
    assert speeds(rotations.nlerp, turned, weights) > 2.0


def test_far_apart_a_fade_keeps_its_pace():
    turned = np.concatenate([np.linspace(2.0, 5.4, 2 * RATE), np.full(RATE, 5.4)])
    weights = np.concatenate([np.full(2 * RATE, 0.9), np.linspace(0.9, 0.1, RATE)])
    even = 5.4 * 0.8 / (RATE - 1)
    assert speeds(WayRound().mix, turned, weights) == pytest.approx(even, rel=0.05)


@given(st.floats(-3.1, 3.1), st.floats(0.0, 1.0))
def test_a_single_frame_takes_the_shorter_way_at_an_even_pace(angle, u):
    mixed = WayRound().mix(rotations.about("y", [0.0]), rotations.about("y", [angle]), u)
    assert turn_of(mixed, rotations.about("y", [u * angle])) < 0.003


def test_after_a_whole_weight_it_begins_by_the_shorter_way():
    way, still = WayRound(), rotations.about("y", [0.0])
    for angle in np.linspace(2.0, 4.0, 20):
        way.mix(still, rotations.about("y", [angle]), 0.5)
    way.mix(still, rotations.about("y", [4.0]), 1.0)
    mixed = way.mix(still, rotations.about("y", [4.0]), 0.5)
    assert turn_of(mixed, rotations.about("y", [0.5 * (4.0 - 2.0 * np.pi)])) < 0.003


def test_a_way_that_is_hardly_the_shorter_one_goes_past_the_rest():
    """A leg is folded as it begins to reach behind a shoulder, and straightens meanwhile."""
    way, rest = WayRound(), rotations.about("y", [0.0])
    shown = []
    for u in np.linspace(0.01, 0.99, 99):
        folded, place = np.radians(-30.0 * (1.0 - u)), np.radians(175.0 - 75.0 * u)
        mixed = way.mix(rotations.about("y", [folded]), rotations.about("y", [place]), u, rest)
        shown.append(float(rotations.to_rotation_vector(mixed)[0, 1]))
    assert np.degrees(shown[-1]) == pytest.approx(100.0, abs=3.0)
    assert np.degrees(np.ptp(shown)) < 150.0, "the other way is 285° long"
