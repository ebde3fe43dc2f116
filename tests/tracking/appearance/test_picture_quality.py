"""Blur and noise of a picture, measured on a cube that was drawn with both known."""

from dataclasses import replace

import cv2
import numpy as np
import pytest

from cubeling.tracking import CubeModel, CubeState
from cubeling.tracking.appearance.picture_quality import INK_SHARE, QualityMeter
from tests.examples import some
from tests.tracking import drawn
from tests.tracking.drawn import WIDE, digitised, grey_values, held, photograph, scene, window

CUBE = CubeModel.load("locomotion")
POSE = held(0.35, 0.5, 0.1, at=(0.01, 0.0, 0.3))
STILL = CubeState(True, POSE, np.zeros(6), np.zeros((6, 6)), "markers", (), 0.1, 0.0)


@pytest.fixture(scope="module")
def light():
    return scene((CUBE, POSE), camera=WIDE)


def measure(light, state=STILL, blur=0.0, noise=0.0, frames=60, times=1):
    if blur:
        light = cv2.GaussianBlur(light, (0, 0), blur)
    meter, grey = QualityMeter(CUBE, WIDE), grey_values(light)
    picture = digitised(grey, noise=0.0)
    pose = POSE if state.camera_from_cube is None else state.camera_from_cube
    left, top, right, bottom = window(CUBE, [pose], WIDE)
    near = np.s_[top:bottom, left:right]
    for number in range(frames):
        if noise:  # what is away from the cube is not measured
            picture[near] = digitised(grey[near], noise, seed=number // times)
        quality = meter.update(picture.copy(), state)
    return quality


@pytest.fixture(scope="module")
def own_blur(light):
    """Blur of the drawing: `scene` blurs by 0.6."""
    return measure(light).blur


@pytest.mark.parametrize("blur", some([0.6, 1.8, 0.9, 1.3], 2))
def test_blur_is_measured_within_a_tenth_of_a_pixel(light, own_blur, blur):
    assert own_blur == pytest.approx(0.66, abs=0.08)
    found = measure(light, blur=blur, noise=2.0).blur
    assert found == pytest.approx(np.hypot(own_blur, blur), abs=0.1)


@pytest.mark.parametrize("noise", some([3.0, 1.0, 6.0]))
def test_noise_is_measured_whatever_the_blur(light, noise):
    for blur in (0.0, 1.2):
        found = measure(light, blur=blur, noise=noise).noise
        assert found == pytest.approx(np.hypot(noise, 0.29), rel=0.12, abs=0.25)


def test_grain_of_the_paper_is_no_noise(light):
    grain = 1 + 0.05 * np.random.default_rng(0).standard_normal(light.shape)
    noisy = measure((light * grain).astype(np.float32), noise=2.0).noise
    assert noisy == pytest.approx(2.0, rel=0.12)


HAZES = [(glare, blur) for blur in (0.0, 1.0) for glare in (0.1, 0.0, 0.03, 0.2)]
"""Light that a lens spreads, and its blur."""


@pytest.fixture(scope="module")
def grey_print():
    """A cube whose ink is as light as that of any print."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(drawn, "BLACK", INK_SHARE * drawn.WHITE)
        return drawn.scene((CUBE, POSE), camera=WIDE)


@pytest.mark.parametrize(("glare", "blur"), some(HAZES, 2))
def test_haze_is_measured_whatever_the_blur(grey_print, glare, blur):
    found = measure(0.8 * grey_print + glare, blur=blur, noise=2.0)
    assert found.haze * found.paper == pytest.approx(glare, abs=0.012)
    assert found.paper == pytest.approx(0.8 * 0.9 * drawn.WHITE + glare, rel=0.12)


def test_a_clear_picture_of_dark_ink_has_no_haze(light):
    assert measure(light, noise=2.0).haze == 0.0


def test_a_moving_cube_tells_nothing(light):
    moving = replace(STILL, velocity=np.array([0.1, 0, 0, 0, 0, 0]))
    assert measure(light, moving) is None


def test_an_unseen_cube_tells_nothing(light):
    assert measure(light, replace(STILL, visible=False)) is None
    assert measure(light, replace(STILL, camera_from_cube=None)) is None


def test_clipped_white_is_not_taken_for_a_sharp_border(light):
    assert measure(2.5 * light) is None


def test_a_cube_partly_out_of_the_picture_is_measured_where_it_is_seen(own_blur):
    pose = held(0.35, 0.5, 0.1, at=(-0.23, 0.0, 0.3))  # the left half of it is outside
    outside = scene((CUBE, pose), camera=WIDE)
    found = measure(outside, replace(STILL, camera_from_cube=pose), noise=2.0)
    assert found.blur == pytest.approx(own_blur, abs=0.1)
    assert found.noise == pytest.approx(2.0, abs=0.3)
    assert found.paper == pytest.approx(0.85 * drawn.WHITE, rel=0.05)  # of the face on the right


def test_frames_before_and_after_a_seek_are_not_compared(light):
    """The cube has moved since: its print would count as noise."""
    moved = held(0.35, 0.5, 0.1, at=(0.03, 0.02, 0.3))
    aside, there = replace(STILL, camera_from_cube=moved), scene((CUBE, moved), camera=WIDE)
    meter = QualityMeter(CUBE, WIDE)
    for number in range(24):
        state, seen = ((STILL, light), (aside, there))[number // 3 % 2]
        state = replace(state, timestamp=number / 30 + 10.0 * (number // 3))
        quality = meter.update(photograph(seen, noise=2.0, seed=number), state)
    assert quality is not None
    assert quality.noise == pytest.approx(2.0, abs=0.5)


@pytest.mark.parametrize("times", some([3, 2, 4]))
def test_a_repeated_frame_tells_nothing_of_noise(light, times):
    """A webcam that takes fewer pictures than it promises sends each of them again."""
    found = measure(light, noise=2.0, frames=160, times=times)
    assert found.noise == pytest.approx(2.0, rel=0.12)
