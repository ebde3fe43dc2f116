"""Fingers that are painted into a drawn picture of the cube, and what is none."""

import cv2
import numpy as np
import pytest

from cubeling.tracking.appearance.hand.finder import MANY_FRAMES, HandFinder
from tests.bench.hand_mask import covered
from tests.examples import some
from tests.tracking.appearance.hand.resting_scene import CUBE, state_at
from tests.tracking.drawn import WIDE, held, photograph, scene

SHAPE = 720, 1280
"""Of the pictures of `WIDE`, (height, width) [px]."""


def test_a_shadow_on_a_face_is_no_finger():
    pose, finder = held(), HandFinder(CUBE, WIDE)
    light = scene((CUBE, pose), camera=WIDE)
    shaded = light.copy()
    shaded[:, 620:] *= 0.45
    for index, seen in enumerate([light, light, shaded, shaded]):
        assert finder.update(photograph(seen, seed=index), state_at(pose)) is None


@pytest.mark.parametrize("pose", [None, held()], ids=["lost", "expected"])
def test_a_cube_that_is_not_seen_has_no_hand(pose):
    picture = photograph(scene((CUBE, held()), camera=WIDE))
    picture[210:300, 626:656] = (96, 124, 168)  # a finger, if the cube were seen
    assert HandFinder(CUBE, WIDE).update(picture, state_at(pose, visible=False)) is None


def test_bluish_ink_is_no_finger():
    pose, finder = held(), HandFinder(CUBE, WIDE)
    picture = photograph(scene((CUBE, pose), camera=WIDE)).astype(float)
    dark = np.clip((110 - picture[..., :1]) / 60, 0, 1)
    tinted = np.clip(picture + dark * (16, 0, -6), 0, 255).astype(np.uint8)
    assert finder.update(tinted, state_at(pose)) is None


def test_a_finger_on_a_face_is_found_in_the_first_picture():
    pose, finder = held(), HandFinder(CUBE, WIDE)
    picture = photograph(scene((CUBE, pose), camera=WIDE))
    picture[210:300, 626:656] = (96, 124, 168)  # over its upper corner of the cube
    mask = finder.update(picture, state_at(pose))
    assert mask is not None
    found = covered(mask, SHAPE)
    assert found[250:294, 632:650].mean() > 0.6
    found[200:312, 614:668] = 0
    assert not found.any()


def test_a_finger_that_comes_into_a_still_picture_is_found_at_once():
    pose, finder = held(), HandFinder(CUBE, WIDE)
    picture = photograph(scene((CUBE, pose), camera=WIDE))
    for _ in range(MANY_FRAMES + 5):
        assert finder.update(picture, state_at(pose)) is None
    picture = picture.copy()
    picture[210:276, 626:656] = (96, 124, 168)
    assert finder.update(picture, state_at(pose)) is not None


def test_a_finger_is_found_when_the_cube_has_come_nearer():
    pose, finder = held(), HandFinder(CUBE, WIDE)
    picture = photograph(scene((CUBE, pose), camera=WIDE))
    for _ in range(MANY_FRAMES + 1):
        finder.update(picture, state_at(pose))
    near = pose.copy()
    near[:3, 3] *= 0.55  # so near that the hand is looked for at another resolution
    picture = photograph(scene((CUBE, near), camera=WIDE))
    assert finder.update(picture, state_at(near)) is None
    picture[160:276, 626:656] = (96, 124, 168)
    assert finder.update(picture, state_at(near)) is not None


def test_a_spot_inside_a_face_is_no_finger():
    pose, picture = held(), photograph(scene((CUBE, held()), camera=WIDE))
    picture[300:372, 630:656] = (96, 124, 168)  # a hand would come from outside
    assert HandFinder(CUBE, WIDE).update(picture, state_at(pose)) is None


@pytest.mark.parametrize("shift_px", some([1.0, 0.3]))
def test_a_keyboard_that_moves_by_a_pixel_is_no_hand(shift_px):
    pose, finder = held(), HandFinder(CUBE, WIDE)
    keys = np.full((720, 1280), 0.015, np.float32)
    keys[::14] = keys[1::14] = keys[:, ::14] = keys[:, 1::14] = 0.15
    moved = cv2.warpAffine(keys, np.array([[1, 0, shift_px], [0, 1, shift_px]]), (1280, 720))
    desk = scene((CUBE, pose), camera=WIDE)
    free = cv2.dilate((desk != desk[0, 0]).astype(np.uint8), np.ones((9, 9))) == 0
    free[:, 640:] = False
    for index in range(14):
        light = np.where(free, keys if index < 10 else moved, desk)
        assert finder.update(photograph(light, seed=index), state_at(pose)) is None


def test_what_the_first_hand_hides_for_a_moment_is_not_taken_for_a_hand_later():
    pose, finder = held(), HandFinder(CUBE, WIDE)
    desk = photograph(scene((CUBE, pose), camera=WIDE))
    desk[150:200, 640:690] = (60, 60, 160)  # a red thing behind the cube
    passed = desk.copy()
    passed[140:220, 560:720] = desk[100, 560]  # an arm in the colour of the desk
    for _ in range(MANY_FRAMES - 4):
        finder.update(desk, state_at(pose))
    finder.update(passed, state_at(pose))
    holding = desk.copy()
    holding[190:276, 626:656] = (96, 124, 168)
    for _ in range(4):
        mask = finder.update(holding, state_at(pose))
    assert mask is not None
    assert not covered(mask, SHAPE)[150:184, 664:690].any()
