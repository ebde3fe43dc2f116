"""Colours tell a hand from the desk, in any light."""

import numpy as np
import pytest
from hypothesis import given, strategies as st

from cubeling.tracking.appearance.hand.colour_model import LAB_BINS, ColourModel, colours

PIXELS = (20, 30)
EVERYWHERE = np.ones(PIXELS, bool)


def patch(light: float, a: float, b: float, deviation: float = 1.0) -> np.ndarray:
    """L + 16, a and b of an even surface with noise, (3, 20, 30)."""
    noise = np.random.default_rng(1).normal(0.0, deviation, (3, *PIXELS))
    return (np.array([light, a, b])[:, None, None] + noise).astype(np.float32)


def learned(hand: np.ndarray, desk: np.ndarray) -> ColourModel:
    model = ColourModel()
    model.learn_hand(colours(hand), EVERYWHERE)
    model.learn_behind(colours(desk), EVERYWHERE)
    model.see_hand(colours(hand).ravel())
    return model


@given(
    chroma=st.tuples(st.floats(-40.0, 40.0), st.floats(-40.0, 40.0)),
    light=st.floats(60.0, 900.0),  # beyond 296 where the camera lets in less light than at first
    shade=st.floats(0.3, 1.0),
)
def test_a_shadow_changes_no_chroma(chroma, light, shade):
    lit = np.array([light, *chroma], np.float32)[:, None, None]
    chroma_bins, lightness_bins = LAB_BINS[:2], LAB_BINS[2]
    number, in_shade = (
        np.array(np.unravel_index(int(colours(each)[0, 0]) // lightness_bins, chroma_bins))
        for each in (lit, np.asarray(shade * lit, np.float32))
    )
    # Rounding may choose the bin beside.
    assert np.abs(number - in_shade).max() <= 1


def test_a_shadow_on_the_desk_is_less_like_a_hand_than_the_hand_in_it():
    hand, desk = patch(150.0, 18.0, 24.0), patch(220.0, 2.0, 12.0)
    model = learned(hand, desk)
    hand_odds, desk_odds = (
        model.odds(colours(np.asarray(0.8 * each, np.float32))).mean() for each in (hand, desk)
    )
    assert hand_odds > 1.0
    assert desk_odds < 0.0


def test_colours_that_the_desk_does_not_have_are_distinct():
    assert learned(patch(150.0, 18.0, 24.0), patch(220.0, 2.0, 12.0)).distinctness == 1.0


@pytest.mark.parametrize("offset", [0.0, 0.5])
def test_colours_of_the_desk_are_not_distinct(offset):
    desk = patch(220.0, 10.0, 20.0, deviation=3.0)
    assert learned(desk + np.float32(offset), desk).distinctness == 0.0


def test_a_hand_in_other_colours_than_the_first_is_not_distinct():
    model = learned(patch(150.0, 18.0, 24.0), patch(220.0, 2.0, 12.0))
    model.see_hand(colours(patch(215.0, 3.0, 12.0)).ravel())
    assert model.distinctness == 0.0


def test_the_next_hand_may_be_another_one():
    model = learned(patch(150.0, 18.0, 24.0), patch(220.0, 2.0, 12.0))
    model.lose_hand()
    assert model.distinctness == 0.0


def test_nothing_is_distinct_before_a_hand_is_known():
    model = ColourModel()
    model.learn_behind(colours(patch(220.0, 2.0, 12.0)), EVERYWHERE)
    model.odds(colours(patch(150.0, 18.0, 24.0)))
    assert model.distinctness == 0.0


@pytest.mark.parametrize("recoloured", [False, True])
def test_what_moves_with_a_distinct_hand_is_its_shadow_or_has_become_of_another_colour(recoloured):
    desk = patch(220.0, 2.0, 12.0)
    model = learned(patch(150.0, 18.0, 24.0), desk)
    now, before = (colours(np.asarray(light * desk, np.float32)).ravel() for light in (0.7, 1.0))
    covered = model.covered_pixels(now, before, np.full(now.shape, recoloured))
    assert (covered.mean() > 0.9) == recoloured
