"""The path that a wish leads."""

import math

import pytest
from hypothesis import given, strategies as st

from cubeling.characters.motion.motion import RootDelta
from cubeling.characters.synthesis.matching.prediction import MAX_TURN_RATE, Impulse, Wish, predict

HEIGHT_M = 1.7


def walked(wish, seconds, elapsed=1 / 60):
    """Return where a wish leads in a time [s]."""
    place, impulse = RootDelta(), Impulse()
    for _ in range(round(seconds / elapsed)):
        impulse, place = impulse.advance(place, wish, HEIGHT_M, elapsed)
    return place, impulse


@given(st.floats(-6, 6), st.floats(-6, 6), st.floats(0.5, 4.0))
def test_it_stops_before_a_target_wherever_that_is(x, z, speed):
    place, impulse = walked(Wish(speed, (x, z), 0.5), 20.0, 1 / 30)
    away = math.hypot(x - place.x, z - place.z)
    assert away < max(math.hypot(x, z), 0.0) + 1e-9
    assert away < 0.6 or math.hypot(x, z) <= 0.6
    assert abs(impulse.speed) < 0.05


def test_a_target_that_is_not_to_stop_at_is_passed_at_full_speed():
    place, impulse = walked(Wish(2.0, (0.0, 1.0), math.inf), 0.45)
    assert 0.3 < place.z < 1.0
    assert impulse.speed > 1.3


def test_it_turns_no_faster_than_a_body_can():
    wish, elapsed = Wish(0.0, (0.0, -1.0)), 1 / 60
    place, impulse = RootDelta(), Impulse()
    for _ in range(120):
        impulse, after = impulse.advance(place, wish, HEIGHT_M, elapsed)
        assert abs(after.yaw - place.yaw) <= MAX_TURN_RATE * elapsed + 1e-9
        place = after
    assert abs(math.remainder(place.yaw - math.pi, math.tau)) < 0.1


def test_standing_features_stay_where_they_are():
    features = predict(RootDelta(3.0, 1.0, 0.7), Impulse(), Wish(), HEIGHT_M)
    assert features["path"] == pytest.approx([0.0] * 6)
    assert features["facing"] == pytest.approx([0.0, 1.0] * 3)
