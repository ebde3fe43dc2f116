"""A hand that moves with the cube is not looked for in every frame."""

import itertools
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, strategies as st

from cubeling.tracking.appearance.hand.finder import HandFinder
from cubeling.tracking.appearance.hand.last_hand import (
    CARRIED_LOOKS,
    MAX_STEP_EDGES,
    UNSEEN_S,
    LastHand,
)
from cubeling.tracking.appearance.hand.mask import HandMask
from cubeling.tracking.cube.model import CubeModel
from cubeling.tracking.geometry.projection import Projection
from cubeling.tracking.tracker.tracker import CubeTracker
from tests.bench.hand_mask import covered, missed_share, overlap
from tests.bench.hand_scenes import SKINS, HandView
from tests.tracking.appearance.hand.resting_scene import RestingScene
from tests.tracking.drawn import WIDE, held

CUBE = CubeModel.load("locomotion")

POSE = held()

EDGE_PX = CUBE.edge * WIDE.matrix[0, 0] / POSE[2, 3]


def mask(x: int = 600, y: int = 300, scale: int = 3, seed: int = 0) -> HandMask:
    share = np.random.default_rng(seed).integers(0, 256, (40, 50)).astype(np.uint8)
    return HandMask(x, y, share, POSE[:3, 3], scale)


def aside(right_px: float) -> np.ndarray:
    """The pose of a cube that has moved to the right in the picture."""
    pose = POSE.copy()
    pose[0, 3] += right_px * pose[2, 3] / WIDE.matrix[0, 0]
    return pose


@pytest.fixture
def last() -> LastHand:
    """A hand that was found so often at the same place that it is carried, the last time at 0 s."""
    hand = LastHand(CUBE, Projection(WIDE))
    for number in range(-CARRIED_LOOKS, 1):
        assert not hand.carry(POSE, number / 30)
        hand.update(mask(), POSE, number / 30)
    return hand


def test_a_moved_hand_is_elsewhere_in_the_image_and_in_the_room():
    moved = mask().move(5, -2, np.array([0.01, 0.0, -0.02]))
    assert (moved.x, moved.y, moved.scale) == (605, 298, 3)
    np.testing.assert_allclose(moved.behind, POSE[:3, 3] + [0.01, 0.0, -0.02])
    np.testing.assert_array_equal(moved.share, mask().share)


@given(st.integers(-160, 160), st.integers(-130, 130))
def test_the_agreement_of_two_masks_is_the_overlap_of_their_covers(right, down):
    here, there = mask(), mask(600 + 3 * right, 300 + 3 * down, seed=1)
    canvas = np.zeros((2, 400, 400))
    for cover, each in zip(canvas, (here, there), strict=True):
        row, column = 150 + (each.y - 300) // 3, 180 + (each.x - 600) // 3
        cover[row : row + 40, column : column + 50] = each.share
    assert here.agreement(there) == pytest.approx(overlap(*canvas))
    assert there.agreement(here) == pytest.approx(overlap(*canvas))


def test_masks_of_other_squares_and_empty_ones_do_not_agree():
    empty = replace(mask(), share=np.zeros((4, 5), np.uint8))
    assert mask().agreement(mask(scale=2)) == 0
    assert empty.agreement(empty) == 0


def test_a_hand_that_moved_with_the_cube_does_so_until_it_is_due_again(last):
    assert last.carry(aside(20), 0.02)
    assert last.mask.x == 620
    assert last.carry(aside(-10), 0.07)
    assert last.mask.x == 590
    assert not last.carry(aside(-10), UNSEEN_S)


@pytest.mark.parametrize(
    "found",
    [None, mask(), mask(660), mask(620, seed=1), mask(620, scale=2)],
    ids=["gone", "left behind", "moved further", "of another shape", "nearer"],
)
def test_a_hand_that_moves_unlike_the_cube_is_looked_at_in_each_frame(last, found):
    last.update(found, aside(20), 0.03)
    assert not last.carry(aside(20), 0.06)


def test_a_hand_is_looked_at_after_a_leap_of_the_cube_or_a_gap_or_without_a_clock(last):
    at_lens = POSE.copy()
    at_lens[2, 3] = 0.01
    assert not last.carry(aside(1.1 * MAX_STEP_EDGES * EDGE_PX), 0.03)
    assert not last.carry(at_lens, 0.03)
    assert not last.carry(POSE, 0.2)
    assert not last.carry(POSE, 0.0)


def test_a_hand_is_looked_at_when_a_lost_cube_is_found_again(last):
    assert last.predict(aside(20)).x == 620
    assert last.predict(None).x == 600
    assert not last.carry(POSE, 0.03)


@pytest.mark.full
@pytest.mark.slow(reason="a film at a camera's rate is drawn and tracked")
def test_a_carried_hand_covers_the_same_as_one_that_is_looked_at():
    view = HandView(SKINS["Monk 07"], azimuth_deg=-60, seed=2, tapping=True)
    made = RestingScene(view, CUBE, rate_hz=30)
    tracker, finder = CubeTracker(CUBE, made.intrinsics), HandFinder(CUBE, made.intrinsics)
    scores, shares, missed = [], [], []
    for index in [*range(20), *range(76, 112)]:
        frame, truth = made.frame(index)
        found = finder.update(frame.image, tracker.update(frame))
        if made.state(index).grip > 0.99:
            region = finder.region(made.truth(index))
            shares.append(None if found is None else found.share)
            cover = covered(found, truth.shape)[region]
            scores.append(overlap(cover, truth[region]))
            missed.append(missed_share(cover, truth[region]))
    carried = [now is before for before, now in itertools.pairwise(shares)]
    assert 0.3 < np.mean(carried) < 0.7
    assert min(scores) > 0.9
    assert max(missed) < 0.02
