"""The arm is covered to the border of the picture, and what is no arm is not."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, strategies as st

from cubeling.tracking.appearance.hand.arm import (
    ARM_UP_EDGES,
    MAX_WIDTH_EDGES,
    arm_samples,
    with_arm,
)
from cubeling.tracking.appearance.hand.background import GRID_PX
from cubeling.tracking.appearance.hand.finder import HandFinder
from cubeling.tracking.appearance.hand.mask import EDGE_SLOPE, HandMask
from cubeling.tracking.appearance.hand.window import HandWindow
from tests.bench.hand_mask import covered, overlap
from tests.bench.hand_scenes import SKINS, HandView
from tests.examples import some
from tests.tracking.appearance.hand.resting_scene import CUBE, RestingScene, state_at

SCALE, EDGE = 3, 30.0
"""Pixels of the image for each of the window, and the cube's edge [px of the window]."""

SIZE = 1280, 721
"""Of the image, (width, height) [px]."""

WINDOW = HandWindow(150, 60, 120, 90, SCALE, EDGE, np.zeros((6, 4, 2)), np.s_[30:60, 40:70])


def hand(box: tuple[slice, slice] = np.s_[20:60, 80:120]) -> HandMask:
    """A hand in some rows and columns of the window, at its right border."""
    share = np.zeros((WINDOW.height, WINDOW.width), np.uint8)
    share[box] = 255
    return HandMask(SCALE * WINDOW.left, SCALE * WINDOW.top, share, np.zeros(3), SCALE, EDGE_SLOPE)


def found(changed: np.ndarray, window: HandWindow = WINDOW) -> np.ndarray:
    """What is covered of an image in which some pixels of the working resolution have changed."""
    samples = arm_samples(window, SIZE)
    middles = changed[1::GRID_PX, 1::GRID_PX][samples]
    placed = replace(hand(), x=SCALE * window.left, y=SCALE * window.top)
    return covered(with_arm(placed, middles, samples, window), SIZE[::-1])


def image() -> np.ndarray:
    return np.zeros((SIZE[1] // SCALE, SIZE[0] // SCALE), bool)


def at(row: int, column: int) -> tuple[int, int]:
    """A pixel of the image at one of the working resolution."""
    return SCALE * row, SCALE * column


@pytest.mark.slow(reason="the frames of a film are drawn")
@pytest.mark.parametrize(
    ("azimuth", "skin"), some([(-60, "Monk 09"), (10, "Monk 03"), (-165, "Monk 03")])
)
def test_an_arm_is_covered_to_the_border_of_the_picture(azimuth, skin):
    made = RestingScene(HandView(SKINS[skin], azimuth, seed=2, defocus=0.6), CUBE)
    finder = HandFinder(CUBE, made.intrinsics)
    for index in range(27):
        frame, truth = made.frame(index)
        mask = finder.update(frame.image, state_at(made.truth(index)))
    assert overlap(covered(mask, truth.shape), truth) > 0.93


@pytest.mark.slow(reason="the frames of a film are drawn")
def test_an_arm_that_was_there_from_the_beginning_leaves_no_ghost():
    made = RestingScene(HandView("3f6fc4", azimuth_deg=10, seed=1), CUBE)
    finder = HandFinder(CUBE, made.intrinsics)
    for index in range(25, 46):
        frame, truth = made.frame(index)
        mask = finder.update(frame.image, state_at(made.truth(index)))
    cover = covered(mask, truth.shape)
    assert np.maximum(cover - truth, 0).sum() < 0.2 * truth.sum()
    assert overlap(cover, truth) > 0.8


def test_what_is_connected_to_the_hand_is_its_arm():
    changed = image()
    changed[80:115, 240:] = True
    changed[10:30, 300:320] = True  # something else
    cover = found(changed)
    assert cover[at(97, 400)] == cover[at(97, 271)] == cover[720 - 425, 1276] == 1.0
    assert cover[at(75, 400)] == cover[at(120, 400)] == cover[at(20, 310)] == 0.0


def test_specks_at_a_hand_are_no_arm():
    changed = image()
    changed[80:84, 268:300] = True  # one sample wide
    assert not found(changed)[:, SCALE * 276 :].any()


def test_a_body_behind_the_arm_hides_nothing():
    changed, wide = image(), round(MAX_WIDTH_EDGES * EDGE) + 3 * GRID_PX
    changed[80:115, 240:320] = True
    changed[60 : 60 + wide, 320 : 320 + wide] = True
    cover = found(changed)
    assert cover[at(97, 300)] == 1.0
    assert not cover[:, SCALE * 330 :].any()


def test_an_arm_is_not_followed_far_up():
    window, changed = replace(WINDOW, top=150), image()
    changed[:190, 240:300] = True  # beside the window, from the hand to the upper border
    cover, end = found(changed, window), window.top - round(ARM_UP_EDGES * EDGE)
    assert cover[at(end + 6, 285)] == 1.0
    assert not cover[: SCALE * (end - 1)].any()


@given(st.integers(3, 80), st.integers(3, 110), st.integers(1, 40), st.integers(1, 40))
def test_a_hand_without_an_arm_stays_as_it_is(top, left, height, width):
    alone = hand(np.s_[top : top + height, left : left + width])
    samples = arm_samples(WINDOW, SIZE)
    nothing = np.zeros([side.stop - side.start for side in samples], bool)
    same = covered(with_arm(alone, nothing, samples, WINDOW), SIZE[::-1])
    inner = np.s_[: SCALE * (WINDOW.top + 84), : SCALE * (WINDOW.left + 114)]
    np.testing.assert_array_equal(same[inner], covered(alone, SIZE[::-1])[inner])


@pytest.mark.parametrize("corner", [(0, 0), (306, 150), (306, 0)])
def test_a_window_at_the_border_of_the_image_keeps_its_hand(corner):
    left, top = corner
    window = HandWindow(left, top, 120, 90, SCALE, EDGE, np.zeros((6, 4, 2)), np.s_[30:60, 40:70])
    share = np.full((90, 120), 255, np.uint8)
    mask = HandMask(SCALE * left, SCALE * top, share, np.zeros(3), SCALE, EDGE_SLOPE)
    samples = arm_samples(window, SIZE)
    nothing = np.zeros([side.stop - side.start for side in samples], bool)
    cover = covered(with_arm(mask, nothing, samples, window), SIZE[::-1])
    assert cover[at(top + 2, left + 2)] == cover[at(top + 87, left + 117)] == 1.0
