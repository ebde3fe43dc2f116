"""Comparison mean opinion scores, with the figures of the thesis (section 4.4.6)."""

import math
from statistics import stdev

import pytest
from hypothesis import given, strategies as st

from cubeling.app.workshop.study.bundled.gesture_and_speech import COUNTS as THESIS
from cubeling.app.workshop.study.reporting.cmos import (
    PUBLISHED_THREE_LEVEL,
    Votes,
    ranking,
)

counts = st.integers(0, 40)
votes = st.builds(Votes, counts, counts, st.integers(1, 40), counts, counts)


@pytest.mark.parametrize(
    ("pair", "better", "worse", "mean", "median"),
    [
        (("intensity", "random"), 65.3, 8.1, 0.69, 1),
        (("intensity", "time"), 67.7, 19.4, 0.63, 1),
        (("time", "random"), 43.5, 23.4, 0.23, 0),
        (("intensity", "original"), None, 100 - 40.3, -0.65, -1),
        (("time", "original"), None, 100 - 16.9, -1.19, -1),
        (("random", "original"), None, 100 - 15.3, -1.21, -1),
    ],
)
def test_counts_give_the_printed_figures(pair, better, worse, mean, median):
    own = THESIS[pair]
    assert own.total == 124
    assert better is None or round(100 * own.better_share, 1) == better
    assert round(100 * own.worse_share, 1) == pytest.approx(worse)
    assert round(own.mean, 2) == mean
    assert own.median == median


def test_three_levels_give_the_figure_that_is_set_beside_others():
    own = THESIS["intensity", "original"]
    assert round(own.three_level, 2) == PUBLISHED_THREE_LEVEL["Fernández-Baena 2015"]
    assert round(1 - own.worse_share, 3) == 0.403


def test_the_order_is_original_intensity_time_random():
    assert [name for name, _ in ranking(THESIS)] == ["original", "intensity", "time", "random"]


def test_the_printed_significance_holds():
    # The thesis has p < 0.01 for one pair and p < 0.001 for the others, by t-tests.
    for pair, own in THESIS.items():
        z = own.mean / (stdev(own.scores) / math.sqrt(own.total))
        p = math.erfc(abs(z) / math.sqrt(2))
        assert p < (0.01 if pair == ("time", "random") else 0.001)


@given(votes)
def test_swapping_the_videos_turns_the_score_round(own):
    other = Votes(own.much_worse, own.worse, own.same, own.better, own.much_better)
    assert other.mean == pytest.approx(-own.mean)
    assert other.median == -own.median


def test_no_votes_are_refused():
    with pytest.raises(ValueError, match="at least one"):
        Votes(0, 0, 0, 0, 0)
