"""The background of a window, and the part of it where the picture differs."""

from functools import cache

import numpy as np
import pytest
from hypothesis import given, strategies as st

from cubeling.tracking.appearance.hand.background import GRID_PX, MARGIN_PX, MIDDLES, Background
from cubeling.tracking.appearance.hand.window import HandWindow

HEIGHT, WIDTH = 120, 150
BOX = np.s_[9 : 9 + HEIGHT, 21 : 21 + WIDTH]
"""A window in a background of 160 x 200 pixels."""

SAMPLES = np.s_[3 : 3 + HEIGHT // GRID_PX, 7 : 7 + WIDTH // GRID_PX]
"""Those of the window."""

CUBE = np.s_[50:80, 60:90]
"""Where the cube is in it."""


def desk() -> np.ndarray:
    """L + 16, a and b of a desk with texture."""
    planes = np.random.default_rng(1).normal(0, 0.5, (3, HEIGHT, WIDTH))
    return np.asarray(planes + np.array([140, 6, 20])[:, None, None], np.float32)


def outside() -> np.ndarray:
    flags = np.ones((HEIGHT, WIDTH), bool)
    flags[CUBE] = False
    return flags


def seen_for_long() -> Background:
    made, free = Background(), outside()
    made.match_size(200, 160)
    for _ in range(10):
        place = made.compare(desk(), BOX, free, whole=True)
        made.learn(desk(), BOX, free, place)
    made.learn(desk(), BOX, ~free, place)
    return made


@cache
def seen_once() -> Background:
    """Return the one of tests that change nothing in it."""
    return seen_for_long()


@pytest.fixture
def background() -> Background:
    """One that has seen the desk for long."""
    return seen_for_long()


def differing(background: Background, picture: np.ndarray) -> tuple[slice, slice]:
    return background.difference_box(picture[:, MIDDLES, MIDDLES], SAMPLES, CUBE)


def test_the_differing_part_of_a_still_desk_is_around_the_cube(background):
    rows, columns = differing(background, desk())
    assert 50 - MARGIN_PX - 2 * GRID_PX <= rows.start <= 50 - MARGIN_PX + GRID_PX
    assert 90 + MARGIN_PX - GRID_PX <= columns.stop <= 90 + MARGIN_PX + 3 * GRID_PX


def test_the_differing_part_holds_the_arm_at_the_cube_and_nothing_else(background):
    picture = desk()
    picture[0, 60:70, 85:150] += 60
    picture[0, 5:15, 5:15] += 60  # somewhere else
    rows, columns = differing(background, picture)
    assert columns.stop >= WIDTH
    assert rows.start > 20


def test_a_desk_that_was_never_seen_differs(background):
    background.forget()
    rows, columns = differing(background, desk())
    assert (rows.start, columns.start) == (0, 0)
    assert rows.stop >= HEIGHT


def test_a_forgotten_sample_is_forgotten_with_its_square_and_nothing_else(background):
    forgotten, known = (
        np.zeros((HEIGHT // GRID_PX, WIDTH // GRID_PX), bool),
        background.age(BOX) > 0,
    )
    forgotten[4, 5] = True
    background.forget_samples(SAMPLES, forgotten)
    known[4 * GRID_PX : 5 * GRID_PX, 5 * GRID_PX : 6 * GRID_PX] = False
    np.testing.assert_array_equal(background.age(BOX) > 0, known)
    assert not known.all()


def test_noise_measured_in_a_whole_window_is_kept_for_its_parts(background):
    part = np.s_[9 : 9 + 90, 21 : 21 + 100]
    picture, free = desk()[:, :90, :100], outside()[:90, :100]
    picture[0, :50, :40] += 60
    place = background.compare(picture, part, free, whole=False)
    assert place.changed[10:40, 10:30].all()
    assert not place.changed[60:, :50].any()


def test_a_picture_of_something_else_is_not_steady(background):
    assert background.steady
    other = desk()
    other[0] -= np.random.default_rng(2).uniform(30, 90, (HEIGHT, WIDTH)).astype(np.float32)
    background.compare(other, BOX, outside(), whole=True)
    assert not background.steady
    background.forget()
    assert background.steady


def test_a_part_of_a_window_shows_the_same_of_the_image():
    quads = np.arange(48.0).reshape(6, 4, 2)
    window = HandWindow(20, 10, WIDTH, HEIGHT, 3, 30.0, quads, CUBE)
    part = window.part(np.s_[40:200, 30:100])
    assert part.image_box == (slice(150, 390), slice(150, 360))
    assert part.cube_box == np.s_[10:40, 30:60]
    assert np.allclose(part.quads + (part.left, part.top), quads + (window.left, window.top))
    assert np.allclose(part.cube_quads(), window.cube_quads())


@given(
    gain=st.one_of(st.floats(0.6, 0.95), st.floats(1.05, 1.5)),
    steps=st.tuples(st.floats(-0.05, 0.05), st.floats(-0.05, 0.05)),
)
def test_a_change_of_the_camera_is_undone(gain, steps):
    picture = gain * desk()
    picture[1:] += np.array(steps)[:, None, None] * picture[0]
    picture[:, 40:80, 60:] = 90  # a hand
    change = seen_once().camera_change(picture.astype(np.float32), BOX)
    assert change is not None
    undone = np.tensordot(change, picture, 1)
    assert np.abs(undone - desk())[:, :40].mean() < 0.5


def test_a_large_hand_is_no_change_of_the_camera(background):
    picture = desk()
    picture[:, 30:] *= np.float32(0.4)
    assert background.camera_change(picture, BOX) is None


def test_a_desk_that_was_not_seen_tells_no_change_of_the_camera():
    never = Background()
    never.match_size(200, 160)
    assert never.camera_change(desk(), BOX) is None


def test_noise_is_measured_where_the_picture_is_not_clipped():
    noise, free = np.random.default_rng(3), outside()
    made = Background()
    made.match_size(200, 160)
    for _ in range(12):
        picture = desk()
        blocks = noise.normal(0, 0.6, (2, HEIGHT // 10, (WIDTH - 100) // 10))
        picture[1:, :, 100:] += blocks.repeat(10, axis=1).repeat(10, axis=2)
        place = made.compare(picture, BOX, free, whole=True)
        made.learn(picture, BOX, free, place)
    assert np.count_nonzero(place.changed) < 0.005 * place.changed.size
