"""Synchrony and intensity (M6)."""

import math

import numpy as np
import pytest

from cubeling.characters.errors import CharacterError
from cubeling.characters.synthesis.gestures.rules import IntensityRule, SynchronyRule, pair


@pytest.mark.parametrize(
    ("apex", "suits"),
    [(1.0, True), (1.0299, True), (1.0301, False), (0.7801, True), (0.7799, False)],
)
def test_an_apex_is_from_30_ms_after_to_220_ms_before_the_accent(apex, suits):
    assert SynchronyRule().holds(1.0, apex) is suits


def test_the_band_is_open_at_its_edges():
    rule = IntensityRule()
    for psi in (0.01, 0.3, 1.0):
        centre = 11.24 + 0.6633 * math.log(psi)
        for inside in (centre, centre + 0.999999, centre - 0.999999):
            assert rule.holds(psi, inside)
        for outside in (centre + 1.000001, centre - 1.000001):
            assert not rule.holds(psi, outside)
    assert not IntensityRule(1.0, 10.0, 0.5).holds(1.0, 10.5)


def test_the_strength_of_silence_is_no_infinity():
    assert float(IntensityRule().centre(0.0)) == pytest.approx(8.185, abs=0.01)


def speech(seed=1, count=200):
    """Return apices, GSI, accents and PSI that belong together, with accents of no gesture."""
    rng = np.random.default_rng(seed)
    times = np.cumsum(rng.uniform(0.7, 1.6, count))
    psi = np.exp(rng.normal(-1.0, 0.8, count))
    gsi = 11.24 + 0.6633 * np.log(psi) + rng.normal(0.0, 0.6, count)
    more = times[::3] + 0.35
    order = np.argsort(np.concatenate([times, more]))
    accents = np.concatenate([times, more])[order]
    strengths = np.concatenate([psi, np.exp(rng.normal(-1.0, 0.8, len(more)))])[order]
    truth = np.searchsorted(accents, times)
    apices = times - np.clip(rng.normal(0.1, 0.05, count), -0.03, 0.22)
    return apices, gsi, accents, strengths, truth


def test_gestures_find_their_accents_one_to_one_and_in_order():
    apices, gsi, accents, psi, truth = speech()
    found = pair(apices, gsi, accents, psi)
    kept = found[found >= 0]
    assert (np.diff(kept) > 0).all()
    assert (found == truth).mean() > 0.97
    delta = accents[kept] - apices[found >= 0]
    assert delta.min() >= -0.2
    assert delta.max() <= 0.5


def test_gestures_without_an_accent_nearby_stay_alone():
    found = pair(np.array([1.0, 9.0]), np.ones(2), np.array([1.1]), np.ones(1))
    assert found.tolist() == [0, -1]
    assert pair(np.array([1.0]), np.ones(1), np.zeros(0), np.zeros(0)).tolist() == [-1]


def test_the_fit_finds_the_line_of_paired_data():
    apices, gsi, accents, psi, truth = speech()
    slope, intercept = np.polyfit(np.log(psi[truth]), gsi, 1)
    found = pair(apices, gsi, accents, psi)
    own = psi[found[found >= 0]]
    assert np.corrcoef(np.log(own), gsi[found >= 0])[0, 1] > 0.3
    rule = IntensityRule.fit(own, gsi[found >= 0], margin=None)
    assert rule.slope == pytest.approx(slope, abs=0.05)
    assert rule.intercept == pytest.approx(intercept, abs=0.05)
    assert rule.margin == pytest.approx(0.6, abs=0.1)
    assert IntensityRule.fit(own, gsi[found >= 0]).margin == 1.0


def test_too_little_to_fit_is_refused_in_one_line():
    with pytest.raises(CharacterError, match="give three or more"):
        IntensityRule.fit(np.ones(9), np.arange(9.0))


def test_without_pairs_the_rule_spreads_over_the_library():
    rule = IntensityRule.spread_over(np.linspace(8.0, 13.0, 101))
    assert float(rule.centre(1.0)) == pytest.approx(12.5)
    assert float(rule.centre(0.1)) == pytest.approx(8.5)
