"""Paths of hands: f(t) = R sin(T π t + shift) about a centre (Huang 2013, section 8.4)."""

import numpy as np
import pytest

from cubeling.characters.behaviour.gestures.style.splines import TcbSpline
from cubeling.characters.behaviour.gestures.targeting import PathFormula, path_points
from cubeling.characters.behaviour.symbolic_gesture import HandKey
from tests.characters.behaviour.gestures.test_expressivity import segment

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


def test_a_spline_through_the_points_of_a_circle_is_round():
    key = HandKey(1.0, path="circle", radius=(0.3, 0.3, 0.0), turns=2.0)
    shares = np.array([0.0, *path_points(key, 0.0), 1.0])
    spline = TcbSpline.of(shares, PathFormula.of(key, np.array(key.radius)).at(shares))
    inner = [segment(spline, n, np.linspace(0.0, 1.0, 9)) for n in range(1, len(shares) - 2)]
    assert np.linalg.norm(np.concatenate(inner), axis=1) == pytest.approx(0.3, abs=0.003)


def test_a_wave_has_a_point_at_each_turn():
    key = HandKey(1.0, path="wave", radius=(0.2, 0.0, 0.0), turns=1.5)
    wave = PathFormula.of(key, np.array(key.radius)).offsets(path_points(key, 0.0))
    assert wave[:, 0] == pytest.approx([0.2, -0.2, 0.2])


@pytest.mark.parametrize(
    ("path", "length", "points"),
    [("keys", 1.0, 0), ("line", 0.1, 0), ("line", 1.0, 1), ("arc", 0.1, 1)],
)
def test_long_lines_and_arcs_have_a_middle(path, length, points):
    radius = (0.0, 0.1, 0.0) if path == "arc" else (0.0, 0.0, 0.0)
    assert len(path_points(HandKey(1.0, path=path, radius=radius), length)) == points
