"""Splines and easings of expressive gestures (Huang 2013, section 8.7)."""

from collections import Counter

import numpy as np
import pytest
from hypothesis import given, strategies as st

from cubeling.characters.behaviour.expressivity import GestureExpressivity
from cubeling.characters.behaviour.gestures.collection import GestureCollection
from cubeling.characters.behaviour.gestures.style.easing import (
    ease_time,
    out_back,
    out_bounce,
    out_quart,
)
from cubeling.characters.behaviour.gestures.style.effect import without_effect
from cubeling.characters.behaviour.gestures.style.splines import TcbSpline
from cubeling.characters.behaviour.gestures.style.trunk import torso_controller
from cubeling.characters.smoothing import hermite

TIMES = np.array([0.0, 0.2, 0.7, 1.0])
POINTS = np.array([[0.0, 0.0], [1.0, 0.5], [0.5, 2.0], [-1.0, 0.0]])
UNIT = st.floats(-1.0, 1.0)


def segment(spline, number, u):
    """Return the points of a segment at shares u (m,) of its time."""
    length = float(spline.times[number + 1] - spline.times[number])
    slopes = length * spline.outgoing[number], length * spline.incoming[number + 1]
    ends = spline.points[number : number + 2]
    return np.array([hermite(ends[0], slopes[0], ends[1], slopes[1], float(each)) for each in u])


@given(UNIT, UNIT, UNIT)
def test_splines_go_through_their_keys(tension, fluidity, bias):
    style = GestureExpressivity(tension=tension, fluidity=fluidity, bias=bias)
    spline = TcbSpline.of(TIMES, POINTS, style)
    for number in range(3):
        ends = segment(spline, number, np.array([0.0, 1.0]))
        assert ends == pytest.approx(POINTS[number : number + 2], abs=1e-12)


def _speeds(spline, key):
    step = 1e-6
    before = segment(spline, key - 1, np.array([1.0 - step, 1.0]))
    after = segment(spline, key, np.array([0.0, step]))
    lengths = np.diff(spline.times)
    return (
        (before[1] - before[0]) / (step * lengths[key - 1]),
        (after[1] - after[0]) / (step * lengths[key]),
    )


def test_the_speed_is_continuous_without_fluidity_though_keys_are_not_uniform():
    before, after = _speeds(TcbSpline.of(TIMES, POINTS), 1)
    assert before == pytest.approx(after, abs=1e-4)


@pytest.mark.parametrize("fluidity", [-1.0, -0.4, 0.6])
def test_fluidity_makes_a_kink(fluidity):
    style = GestureExpressivity(fluidity=fluidity)
    before, after = _speeds(TcbSpline.of(TIMES, POINTS, style), 1)
    assert np.linalg.norm(before - after) > 0.1


def test_full_tension_stops_at_keys():
    spline = TcbSpline.of(TIMES, POINTS, GestureExpressivity(tension=1.0))
    assert not spline.incoming.any()
    assert not spline.outgoing.any()


def test_uniform_keys_give_catmull_rom():
    spline = TcbSpline.of(np.arange(4.0), POINTS)
    assert spline.outgoing[1] == pytest.approx((POINTS[2] - POINTS[0]) / 2.0)


def test_bias_overshoots_after_a_key():
    times, points = np.arange(3.0), np.array([[0.0], [1.0], [1.0]])
    biased, plain = (
        segment(
            TcbSpline.of(times, points, GestureExpressivity(bias=bias)),
            1,
            np.linspace(0.0, 1.0, 50),
        )
        for bias in (1.0, 0.0)
    )
    assert biased.max() > plain.max() > 1.0


def test_no_mix_of_parameters_pulls_harder_than_one_at_its_end():
    wild = TcbSpline.of(TIMES, POINTS, GestureExpressivity(tension=-1.0, fluidity=-1.0, bias=1.0))
    one = TcbSpline.of(TIMES, POINTS, GestureExpressivity(bias=1.0))
    assert np.abs(wild.incoming).max() <= np.abs(one.incoming).max() + 1e-12


@pytest.mark.parametrize("easing", [out_quart, out_back, out_bounce])
def test_easings_go_from_0_to_1(easing):
    assert easing(0.0) == pytest.approx(0.0)
    assert easing(1.0) == pytest.approx(1.0)


def test_out_back_overshoots_by_a_tenth():
    x = np.linspace(0.0, 1.0, 100_001)
    way = out_back(x)
    assert way.max() == pytest.approx(1.1000, abs=5e-5)
    assert x[way.argmax()] == pytest.approx(0.580, abs=5e-4)


def test_out_quart_slows_down():
    assert (np.diff(out_quart(np.linspace(0.0, 1.0, 200)), 2) < 0.0).all()


def test_out_bounce_rebounds_and_never_overshoots():
    way = out_bounce(np.linspace(0.0, 1.0, 2000))
    assert way.max() <= 1.0 + 1e-9
    assert np.count_nonzero(np.diff(np.sign(np.diff(way))) != 0) == 6


def test_power_switches_from_linear_to_out_quart_to_out_back():
    x = np.linspace(0.0, 1.0, 11)
    for power, easing in ((0.0, lambda t: t), (0.7, out_quart), (1.0, out_back)):
        assert ease_time(x, GestureExpressivity(power=power)) == pytest.approx(easing(x))


@given(st.floats(0.0, 1.0), st.floats(-1.0, 1.0))
def test_every_style_arrives(power, tension):
    style = GestureExpressivity(power=power, tension=tension)
    assert ease_time(np.array([0.0, 1.0]), style) == pytest.approx([0.0, 1.0])


def test_the_torso_controller_is_linear_in_power():
    keys = np.array([[0.1, 0.0, 0.2], [0.4, 0.1, 0.0], [0.2, 0.0, 0.0]])
    assert torso_controller(keys, 0.0) == pytest.approx(keys)
    added = [torso_controller(keys, power) - keys for power in (0.25, 0.5, 1.0)]
    assert added[1] == pytest.approx(2.0 * added[0])
    assert added[2] == pytest.approx(4.0 * added[0])
    assert added[2][1] == pytest.approx(keys[1] - keys[0])


def test_few_gestures_say_of_a_parameter_that_it_does_nothing():
    said = Counter(
        name for each in GestureCollection.load_bundled() for name in without_effect(each)
    )
    assert set(said) == {"spatial"}
    assert said["spatial"] <= 6
