"""Paths of hands: f(t) = R sin(T π t + shift) about a centre (Huang 2013, section 8.4)."""

import numpy as np
import pytest

from cubeling.characters.behaviour.gestures.targeting import PathFormula, ramp
from cubeling.characters.behaviour.symbolic_gesture import HandKey

TIMES = np.linspace(0.0, 1.0, 41)


def test_samples_are_those_of_the_formula():
    formula = PathFormula(np.array([0.1, 0.2, 0.0]), 3.0, np.array([0.5, 0.0, 0.1]))
    expected = formula.radius * np.sin(3.0 * np.pi * TIMES[:, None] + formula.shift)
    assert formula.at(TIMES) == pytest.approx(expected)


def test_a_circle_is_closed_and_has_one_radius():
    formula = PathFormula.of(HandKey(1.0, path="circle", turns=2.0), np.array([0.3, 0.3, 0.0]))
    assert np.linalg.norm(formula.at(TIMES), axis=1) == pytest.approx(0.3)
    assert formula.offsets(np.array([0.0, 0.5, 1.0])) == pytest.approx(np.zeros((3, 3)), abs=1e-12)


def test_a_circle_in_depth_turns_about_the_other_axis():
    formula = PathFormula.of(HandKey(1.0, path="circle"), np.array([0.0, 0.2, 0.2]))
    assert np.linalg.norm(formula.at(TIMES), axis=1) == pytest.approx(0.2)


@pytest.mark.parametrize("path", ["line", "keys"])
def test_a_line_adds_nothing(path):
    formula = PathFormula.of(HandKey(1.0, path=path), np.array([0.3, 0.3, 0.3]))
    assert formula.offsets(TIMES) == pytest.approx(np.zeros((41, 3)))


def test_without_a_radius_every_path_is_a_line():
    for path in ("arc", "circle", "wave"):
        formula = PathFormula.of(HandKey(1.0, path=path), np.zeros(3))
        assert not formula.offsets(TIMES).any()


def test_an_arc_bows_once_and_ends_at_its_key():
    bow = PathFormula.of(HandKey(1.0, path="arc"), np.array([0.0, 0.2, 0.0])).offsets(TIMES)[:, 1]
    assert bow.max() == pytest.approx(0.2)
    assert bow[[0, -1]] == pytest.approx([0.0, 0.0], abs=1e-12)


def test_a_wave_goes_to_and_fro_as_often_as_asked_and_ends_at_its_key():
    key = HandKey(1.0, path="wave", turns=2.5)
    wave = PathFormula.of(key, np.array([0.2, 0.0, 0.0])).offsets(TIMES)[:, 0]
    signs = np.sign(wave[np.abs(wave) > 1e-9])
    assert np.count_nonzero(np.diff(signs)) == 4  # five halves
    assert wave[-1] == pytest.approx(0.0, abs=1e-12)


def test_ramped_times_start_and_stop_at_rest_and_run_evenly_between():
    t = np.linspace(0.0, 1.0, 2001)
    speed = np.gradient(ramp(t), t)
    assert ramp(np.array([0.0, 1.0])) == pytest.approx([0.0, 1.0])
    assert speed[[0, -1]] == pytest.approx([0.0, 0.0], abs=0.01)
    assert np.ptp(speed[400:1600]) < 1e-6
