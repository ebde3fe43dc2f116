"""The hand is found where it is, and nowhere else."""

import itertools
from dataclasses import replace

import cv2
import numpy as np
import pytest

from cubeling.app.running.kept_lens import intrinsics_for
from cubeling.app.session.bundled import bundled_session
from cubeling.tracking.appearance.hand.background import FULL_AGE
from cubeling.tracking.appearance.hand.finder import HandFinder
from cubeling.tracking.appearance.hand.mask import EDGE_SLOPE, HandMask
from cubeling.tracking.appearance.hand.on_cube.face_pattern import FacePattern
from cubeling.tracking.appearance.hand.window import STILL_FRAMES, Stillness, WindowFinder
from cubeling.tracking.cube.model import CubeModel
from cubeling.tracking.geometry.intrinsics import Intrinsics
from cubeling.tracking.geometry.projection import Projection
from cubeling.tracking.sources import open_source
from cubeling.tracking.tracker.tracker import CubeTracker
from tests.bench.hand_mask import covered, overlap
from tests.bench.hand_scenes import GLOVES, SKINS, HandView
from tests.bench.photographs.sequence import BODY_FILE
from tests.examples import some
from tests.tracking.appearance.hand.resting_scene import (
    CUBE,
    FULL,
    SMALL,
    RestingScene,
    Size,
    state_at,
)

FILM: Size = 960, 540
"""Of the pictures of the film, (width, height) [px]."""


def shown(
    view: HandView, frames: int, begin: int = 0, size: Size = SMALL
) -> tuple[HandMask | None, np.ndarray, tuple[slice, slice]]:
    """The mask of the last of some frames, with the true cover and the region."""
    made = RestingScene(view, CUBE, size=size)
    finder, mask = HandFinder(CUBE, made.intrinsics), None
    truth = np.zeros(size[::-1], np.float32)
    for index in range(begin, frames):
        frame, truth = made.frame(index)
        mask = finder.update(frame.image, state_at(made.truth(index)))
    region = finder.region(made.truth(frames - 1))
    assert region is not None
    return mask, truth, region


def overlap_in(view: HandView, frames: int, begin: int = 0, size: Size = SMALL) -> float:
    """That of the last of some frames, 0 if no hand was found there."""
    mask, truth, region = shown(view, frames, begin, size)
    return overlap(covered(mask, truth.shape)[region], truth[region]) if mask else 0.0


@pytest.fixture(scope="module")
def film() -> tuple[Intrinsics, list[tuple[np.ndarray, np.ndarray]]]:
    """A camera and its pictures of a hand that takes the cube, with the cube's pose in each."""
    made = RestingScene(HandView("825c43", azimuth_deg=-120, seed=3), CUBE, size=FILM)
    return made.intrinsics, [(made.frame(i)[0].image, made.truth(i)) for i in range(25)]


@pytest.mark.full  # films are drawn; those of other tests have two colours of skin
@pytest.mark.parametrize("skin", ["604134", "3f6fc4", "f3e7db"])
def test_hands_of_any_colour_are_found(skin):
    assert overlap_in(HandView(skin, azimuth_deg=-120, seed=3), 25) > 0.8


@pytest.mark.slow(reason="the frames of a film are drawn")
@pytest.mark.parametrize("desk", some(["white", "checked"]))
def test_a_hand_is_found_on_any_desk(desk):
    view = HandView(SKINS["Monk 05"], azimuth_deg=-120, seed=3, desk=desk)
    assert overlap_in(view, 25) > 0.9


def test_what_a_hand_hides_is_on_the_near_side_of_the_cube(film):
    intrinsics, pictures = film
    finder = HandFinder(CUBE, intrinsics)
    masks = [finder.update(picture, state_at(pose)) for picture, pose in pictures]
    behind = [
        mask.behind - pose[:3, 3]
        for mask, (_, pose) in zip(masks, pictures, strict=True)
        if mask is not None
    ]
    assert masks[-1] is not None
    assert len(behind) > 3
    assert np.max(behind, axis=0)[2] <= 0
    assert np.linalg.norm(behind, axis=1).max() < 0.87 * CUBE.edge


@pytest.mark.slow(reason="the frames of a film are drawn")
def test_a_cube_without_a_hand_is_not_covered():
    made = RestingScene(HandView("000000", hand=False), CUBE)
    finder = HandFinder(CUBE, made.intrinsics)
    for index in range(30):
        frame, _ = made.frame(index)
        assert finder.update(frame.image, state_at(made.truth(index))) is None


@pytest.mark.full  # films of two hands are drawn in full size
def test_a_hand_of_another_colour_is_found_after_the_first():
    skins = GLOVES["yellow rubber"], SKINS["Monk 06"]  # the second is as the desk
    views = [HandView(skin, -120, seed=3, defocus=1.2) for skin in skins]
    scenes = [RestingScene(view, CUBE, size=FULL) for view in views]  # no smaller
    finder, scores = HandFinder(CUBE, scenes[0].intrinsics), []
    frames = [(scenes[0], index) for index in range(25)]
    for made, index in frames + [(scenes[1], index) for index in range(31)]:
        frame, truth = made.frame(index)
        mask = finder.update(frame.image, state_at(made.truth(index)))
        region = finder.region(made.truth(index))
        scores.append(overlap(covered(mask, truth.shape)[region], truth[region]))
    assert np.median(scores[-10:]) > 0.65


@pytest.mark.full
@pytest.mark.slow(reason="the frames of a film are drawn")
def test_fingers_on_the_cube_from_the_beginning_are_not_taken_for_its_paper():
    view = HandView(SKINS["Monk 03"], azimuth_deg=-165, seed=4, gradient=0.5, defocus=0.8)
    assert overlap_in(view, 26, begin=22) > 0.8


@pytest.mark.parametrize("skin", some(["825c43", "3f6fc4"]))
def test_a_finger_on_the_cube_shows_the_hand_that_rested_beside_it_from_the_beginning(skin):
    assert overlap_in(HandView(skin, azimuth_deg=10, seed=1), 31, begin=25) > 0.85


def test_a_square_of_the_hand_that_was_learned_as_desk_is_no_hole_in_it(film):
    """The hole is planted: there, the background is what the hand looks like, known for a while."""
    intrinsics, pictures = film
    finder = HandFinder(CUBE, intrinsics)
    for picture, pose in pictures[:-1]:
        before = finder.update(picture, state_at(pose))
    assert before is not None
    inside = cv2.erode((before.share > 250).astype(np.uint8), np.ones((9, 9), np.uint8))
    row, column = np.argwhere(inside)[len(np.argwhere(inside)) // 2]
    top, left = (row + before.y // before.scale - 7, column + before.x // before.scale - 7)
    picture, pose = pictures[-1]
    hole = np.s_[top : top + 15, left : left + 15]
    size = tuple(side // before.scale for side in intrinsics.size)
    small = cv2.resize(picture, size, interpolation=cv2.INTER_AREA)
    background = finder._background
    background._mean[:, *hole] = finder._lab(small)[:, *hole]
    background._age[hole] = 2 * FULL_AGE
    mask = finder.update(picture, state_at(pose))
    assert mask is not None
    found = covered(mask, picture.shape)
    rows, columns = (slice(side.start * mask.scale, side.stop * mask.scale) for side in hole)
    core = covered(before, picture.shape)[rows, columns] > 0.99
    assert core.sum() > 100 * mask.scale**2
    assert found[rows, columns][core].mean() > 0.95
    assert (background._age[hole] == 2 * FULL_AGE).all()  # it is the desk again when the hand goes


@pytest.mark.slow(reason="a desk is drawn")
def test_a_hand_from_the_beginning_stays_when_it_hides_no_face_any_more():
    view = HandView(SKINS["Monk 03"], azimuth_deg=10, seed=1)
    assert overlap_in(view, 49, begin=46, size=FILM) > 0.85  # no smaller


@pytest.mark.full
@pytest.mark.slow(reason="the frames of a film are drawn")
def test_a_wall_in_the_colours_of_a_hand_from_the_beginning_is_no_part_of_it():
    assert overlap_in(HandView(SKINS["Monk 03"], azimuth_deg=-60, seed=2), 38, begin=25) > 0.8


@pytest.mark.full
@pytest.mark.slow(reason="the frames of a film are drawn")
def test_the_sleeve_of_a_hand_that_is_there_from_the_beginning_is_found_when_it_moves():
    view = HandView(SKINS["Monk 09"], azimuth_deg=-120, seed=3, defocus=1.2)
    assert overlap_in(view, 42, begin=22) > 0.8


@pytest.mark.full
@pytest.mark.parametrize(("exposure", "warmth"), some([(-0.5, 0.0), (-0.2, 0.08), (0.4, 0.0)]))
def test_a_camera_that_reacts_to_the_hand_does_not_hide_it(exposure, warmth):
    view = HandView(SKINS["Monk 02"], azimuth_deg=-60, seed=2, exposure=exposure, warmth=warmth)
    assert overlap_in(view, 32) > 0.94


@pytest.mark.slow(reason="noise is drawn for pictures of three looks")
def test_a_still_picture_with_noise_does_not_flicker(film):
    intrinsics, pictures = film
    finder, random = HandFinder(CUBE, intrinsics), np.random.default_rng(1)
    for picture, pose in pictures:
        finder.update(picture, state_at(pose))
    covers = []
    for _ in range(3 * (STILL_FRAMES + 1)):  # it is looked at three times
        noise = np.rint(random.normal(0, 1, picture.shape))
        noisy = np.asarray(cv2.add(picture, noise, dtype=cv2.CV_8U), np.uint8)
        covers.append(covered(finder.update(noisy, state_at(pose)), picture.shape[:2]))
    area = covers[0].sum()
    change = [np.abs(a - b).sum() / area for a, b in itertools.pairwise(covers)]
    assert np.mean(change) < 0.003
    assert max(change) < 0.05


def test_the_prints_of_a_body_with_many_corners_are_where_its_faces_are():
    body, intrinsics = CubeModel.load(BODY_FILE), Intrinsics.guess(FULL)
    projection, pose = Projection(intrinsics), np.eye(4)
    pose[2, 3] = 0.4
    prints = FacePattern(body, projection).corners
    window = WindowFinder(body, projection, prints).window(pose)
    assert window is not None
    corner = np.array([window.left, window.top])
    found = (window.quads + corner + 0.5) * window.scale - 0.5
    at = prints.reshape(-1, 3) + pose[:3, 3]
    assert found.reshape(-1, 2) == pytest.approx(projection.project(at))


def test_a_window_that_shows_the_same_is_looked_at_now_and_then():
    made = RestingScene(HandView("000000", hand=False), CUBE)
    projection = Projection(made.intrinsics)
    window = WindowFinder(CUBE, projection, np.zeros((6, 4, 3))).window(made.truth(0))
    assert window is not None
    picture = np.full((window.height, window.width, 3), 90, np.uint8)
    stillness = Stillness()
    looked_at = [not stillness.is_still(window, picture) for _ in range(2 * STILL_FRAMES + 3)]
    assert np.flatnonzero(looked_at).tolist() == [0, STILL_FRAMES + 1, 2 * STILL_FRAMES + 2]
    noisy = picture + np.random.default_rng(1).integers(0, 9, picture.shape).astype(np.uint8)
    assert stillness.is_still(window, noisy)
    noisy[20:25, 20:25] += 30
    assert not stillness.is_still(window, noisy)
    moved = replace(window, quads=window.quads + 0.2)
    assert not stillness.is_still(moved, noisy)


@pytest.mark.full
def test_skin_in_the_colour_of_the_desk_is_found_by_its_texture():
    assert overlap_in(HandView("a07e56", azimuth_deg=0, seed=2), 28) > 0.75


@pytest.mark.full
@pytest.mark.parametrize("skin", some(["f6ede4", "292420"]))
def test_fingers_in_the_colours_of_print_are_found(skin):
    view = HandView(skin, azimuth_deg=-165, seed=4, gradient=0.5)
    assert overlap_in(view, 26) > 0.86


def test_a_hand_that_was_there_from_the_beginning_leaves_no_ghost():
    view = HandView("eadaba", azimuth_deg=-60, seed=2, gradient=0.3)
    mask, truth, region = shown(view, frames=45, begin=30)
    assert mask is not None
    found = covered(mask, truth.shape)[region]
    assert np.maximum(found - truth[region], 0).sum() < 0.1 * truth[region].sum()
    assert overlap(found, truth[region]) > 0.8


def test_a_hand_stays_for_a_moment_when_the_cube_is_lost(film):
    intrinsics, pictures = film
    finder = HandFinder(CUBE, intrinsics)
    for index, (picture, pose) in enumerate(pictures):
        mask = finder.update(picture, replace(state_at(pose), timestamp=index / 8))
    lost = [
        finder.update(picture, replace(state_at(None, visible=False), timestamp=3 + later))
        for later in (0.1, 0.2, -1.0)  # at last, the recording was wound back
    ]
    assert mask is not None
    assert lost == [mask, None, None]


@pytest.mark.full
def test_dark_fingers_on_ink_are_told_by_their_chroma():
    view = HandView("3a312a", azimuth_deg=-165, seed=4, gradient=0.5)
    assert overlap_in(view, 26) > 0.95


@pytest.mark.parametrize("x", [-103, 1279, 5000])
def test_a_held_hand_may_leave_the_image(x):
    share = np.full((40, 50), 255, np.uint8)
    found = covered(HandMask(x, 718, share, np.zeros(3), 3, EDGE_SLOPE), (720, 1280))
    assert found[:719].max(initial=0) < 1
    assert (found.max() > 0.9) == (x < 1280)


def test_a_hand_is_where_the_lost_cube_is_expected(film):
    intrinsics, pictures = film
    finder = HandFinder(CUBE, intrinsics)
    for picture, pose in pictures:
        mask = finder.update(picture, state_at(pose))
    expected = pose.copy()
    expected[0, 3] += 0.1 * pose[2, 3]
    lost = finder.update(picture, state_at(expected, visible=False))
    assert mask is not None
    assert lost is not None
    assert lost.x - mask.x == pytest.approx(0.1 * intrinsics.matrix[0, 0], rel=0.1)


def test_a_hand_is_found_again_at_once_after_a_pose_at_the_lens(film):
    intrinsics, pictures = film
    finder = HandFinder(CUBE, intrinsics)
    for picture, pose in pictures:
        finder.update(picture, state_at(pose))
    at_lens = pose.copy()
    at_lens[2, 3] = 0.01
    assert finder.update(picture, state_at(at_lens)) is None
    assert finder.update(picture, state_at(pose)) is not None


@pytest.mark.slow(reason="the frames of a film are drawn")
def test_a_hand_that_lets_go_is_in_front_until_it_has_left_the_surroundings():
    made = RestingScene(HandView(SKINS["Monk 03"], azimuth_deg=-120, seed=3), CUBE)
    finder, scores = HandFinder(CUBE, made.intrinsics), []
    for index in [*range(28), *range(27, 17, -1)]:
        frame, truth = made.frame(index)
        mask = finder.update(frame.image, state_at(made.truth(index)))
        region = finder.region(made.truth(index))
        scores.append(overlap(covered(mask, truth.shape)[region], truth[region]))
    assert made.state(19).grip < 0.6
    assert scores[-2] > 0.5
    assert mask is None


def test_a_picture_that_is_mostly_clipped_shows_no_hand():
    with open_source(str(bundled_session("follow"))) as source:
        intrinsics = intrinsics_for(source.intrinsics, source.size)
        tracker, finder = CubeTracker(CUBE, intrinsics), HandFinder(CUBE, intrinsics)
        for frame in itertools.islice(source, 58):  # the hand comes later
            bright = np.asarray(cv2.convertScaleAbs(frame.image, alpha=1.6), np.uint8)
            assert finder.update(bright, tracker.update(frame)) is None
