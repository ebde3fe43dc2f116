"""Camera frames are undistorted and fitted, and the light is estimated from them."""

from dataclasses import replace

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from cubeling.characters.errors import CharacterError
from cubeling.characters.rendering.camera_picture.light import (
    LINEAR_FROM_SRGB,
    MIN_RISE,
    PICTURES_PER_LOOK,
    LightEstimator,
    paper_color,
)
from cubeling.characters.rendering.camera_picture.undistortion import Undistorter
from cubeling.characters.rendering.context import create_context
from cubeling.tracking.appearance import HandMask, MeasuredLight

SIZE = (320, 180)
BENT = np.array([0.12, -0.2, 0.001, -0.002, 0.05])


def test_an_undistorted_frame_shows_points_at_their_pinhole_projection(view):
    point = np.array([0.09, -0.04, 0.6])
    bent, _ = cv2.projectPoints(point, np.zeros(3), np.zeros(3), view.matrix, BENT)
    yy, xx = np.mgrid[:180, :320]
    spot = np.exp(-((xx - bent[0, 0, 0]) ** 2 + (yy - bent[0, 0, 1]) ** 2) / 8)
    frame = np.repeat((250 * spot)[..., None], 3, axis=2).astype(np.uint8)
    undistorter = Undistorter((320, 180))
    bent_view = replace(view, image=frame, distortion=BENT)
    straight, matrix = undistorter.undistort(bent_view), undistorter.matrix_of(bent_view)
    weight = straight[..., 0].astype(float)
    seen = [(weight * xx).sum(), (weight * yy).sum()] / weight.sum()
    assert seen == pytest.approx((matrix @ point / point[2])[:2], abs=0.05)


def test_a_frame_without_distortion_is_an_unchanged_copy(view):
    undistorter = Undistorter((320, 180))
    picture, matrix = undistorter.undistort(view), undistorter.matrix_of(view)
    assert np.array_equal(picture, view.image)
    assert not np.shares_memory(picture, view.image)
    assert np.array_equal(matrix, view.matrix)


def test_a_frame_of_another_size_is_scaled_with_its_matrix(view):
    undistorter = Undistorter((640, 400))
    picture, matrix = undistorter.undistort(view), undistorter.matrix_of(view)
    assert picture.shape == (400, 640, 3)
    assert matrix[0, 0] == pytest.approx(2 * view.matrix[0, 0])
    middle = matrix @ np.linalg.inv(view.matrix) @ [159.5, 89.5, 1.0]
    assert middle[:2] == pytest.approx([319.5, 199.5])


@pytest.mark.parametrize("distortion", [np.zeros(0), BENT], ids=["straight", "bent"])
def test_a_part_of_the_frame_is_that_part_of_the_picture_magnified(view, distortion):
    whole, magnified = Undistorter((320, 180)), Undistorter((128, 128))
    smooth = replace(view, image=cv2.GaussianBlur(noise(3), (0, 0), 6), distortion=distortion)
    part = replace(smooth, part=(100.0, 50.0, 164.0, 114.0))
    picture = magnified.undistort(part)
    expected = cv2.resize(whole.undistort(smooth)[50:114, 100:164], (128, 128))
    inner = np.s_[4:-4, 4:-4]
    np.testing.assert_allclose(picture[inner].astype(int), expected[inner].astype(int), atol=3)
    corner = magnified.matrix_of(part) @ np.linalg.inv(smooth.matrix) @ [99.5, 49.5, 1.0]
    assert corner[:2] == pytest.approx([-0.5, -0.5])


def test_the_maps_are_computed_once_for_each_camera(view, monkeypatch):
    undistorter = Undistorter((320, 180))
    bent = replace(view, distortion=BENT)
    undistorter.undistort(bent)
    monkeypatch.setattr(cv2, "initUndistortRectifyMap", None)
    undistorter.undistort(bent)
    with pytest.raises(TypeError):
        undistorter.undistort(replace(view, distortion=2 * BENT))


def noise(seed):
    return np.random.default_rng(seed).integers(0, 256, (180, 320, 3), np.uint8)


def test_a_frame_that_was_begun_before_is_the_same(view):
    bent = replace(view, image=noise(1), distortion=BENT)
    expected, expected_matrix = Undistorter(SIZE).undistort(bent), Undistorter(SIZE).matrix_of(bent)
    undistorter = Undistorter(SIZE)
    for _ in range(2):  # with maps to compute, and with maps that are known
        undistorter.start(bent.image, bent.matrix, bent.distortion)
        matrix, picture = undistorter.matrix_of(bent), undistorter.undistort(bent)
        assert np.array_equal(picture, expected)
        assert np.array_equal(matrix, expected_matrix)
    again = undistorter.undistort(bent)
    assert not np.shares_memory(again, picture)
    undistorter.release()
    undistorter.release()


def test_the_matrix_is_known_before_the_picture(view, monkeypatch):
    undistorter, bent = Undistorter(SIZE), replace(view, image=noise(1), distortion=BENT)
    expected = undistorter.undistort(bent)
    undistorter.start(bent.image, bent.matrix, bent.distortion)
    monkeypatch.setattr(undistorter, "_finish", None)
    matrix = undistorter.matrix_of(bent)
    monkeypatch.undo()
    assert np.array_equal(matrix, view.matrix)
    assert np.array_equal(undistorter.undistort(bent), expected)
    undistorter.release()


def test_a_frame_that_was_begun_but_is_not_drawn_changes_nothing(view):
    undistorter = Undistorter(SIZE)
    expected = Undistorter(SIZE).undistort(replace(view, image=noise(2), distortion=BENT))
    undistorter.start(noise(1), view.matrix, BENT)
    undistorter.start(noise(3), view.matrix, 2 * BENT)
    picture = undistorter.undistort(replace(view, image=noise(2), distortion=BENT))
    assert np.array_equal(picture, expected)
    undistorter.start(noise(2), view.matrix, 2 * BENT)  # by another lens than the view's
    picture = undistorter.undistort(replace(view, image=noise(2), distortion=BENT))
    assert np.array_equal(picture, expected)
    undistorter.release()


def test_a_frame_that_cannot_be_drawn_is_refused_when_it_is_drawn(view):
    undistorter = Undistorter(SIZE)
    wrong = np.zeros((180, 320), np.uint8)
    undistorter.start(wrong, view.matrix, view.distortion)
    with pytest.raises(CharacterError, match="cannot draw on an image"):
        undistorter.undistort(replace(view, image=wrong))
    undistorter.release()


@pytest.mark.parametrize(("distortion", "size"), [(BENT, SIZE), (np.zeros(5), (640, 400))])
def test_a_cover_lies_on_the_same_pixels_as_the_picture(view, distortion, size):
    frame = np.zeros((180, 320, 3), np.uint8)
    cv2.circle(frame, (250, 140), 20, (255, 255, 255), -1, cv2.LINE_AA)
    cover = HandMask(
        220, 110, np.ascontiguousarray(frame[110:175, 220:290, 0]), np.array([0.0, 0.0, 0.5])
    )
    undistorter = Undistorter(size)
    picture = undistorter.undistort(replace(view, image=frame, distortion=distortion))
    found = undistorter.cover_in_picture(cover)
    assert found is not None
    shown: NDArray[np.uint8] = np.zeros_like(picture[..., 0])
    shown[found.area.slices] = found.share_in(found.area)
    assert shown.max() == 255
    assert np.abs(shown.astype(int) - picture[..., 0]).max() <= 2


def test_an_empty_rim_of_a_cover_is_left_out(view):
    share = np.zeros((100, 120), np.uint8)
    share[40:50, 60:80] = 255
    undistorter = Undistorter(SIZE)
    undistorter.undistort(view)
    found = undistorter.cover_in_picture(HandMask(100, 50, share, np.array([0.0, 0.0, 0.5])))
    assert found is not None
    assert found.area.height < 20
    assert found.area.width < 30
    share = found.share_in(found.area)
    assert (share[90 - found.area.y, 160 - found.area.x], share[0, 0]) == (255, 0)
    assert (
        undistorter.cover_in_picture(HandMask(100, 50, 0 * share, np.array([0.0, 0.0, 0.5])))
        is None
    )


def test_a_low_light_is_raised_so_that_shadows_stay_short(view):
    low = view.camera_from_table[:3, :3] @ [1.0, -0.1, 0.0]
    measured = MeasuredLight(low / np.linalg.norm(low), np.full(3, 0.7), np.full(3, 0.3), 1.0)
    estimate = LightEstimator()
    for _ in range(150):
        light = estimate.update(view.image, None, measured, view.camera_from_table)
    assert light.to_light[1] == pytest.approx(MIN_RISE, abs=0.01)
    assert light.to_light[0] > 0.7
    assert light.white == pytest.approx(0.7 * MIN_RISE + 0.3, rel=0.01)
    guess = LightEstimator().update(view.image)
    uncertain = replace(measured, certainty=0.0)
    first = LightEstimator().update(view.image, None, uncertain, view.camera_from_table)
    assert np.array_equal(first.to_light, guess.to_light)
    for _ in range(150):
        light = estimate.update(view.image)
    assert light.to_light == pytest.approx(LightEstimator().update(view.image).to_light, abs=0.01)


def test_a_darker_and_redder_picture_gives_a_darker_and_redder_light(view):
    bright = LightEstimator().update(np.full((180, 320, 3), 180, np.uint8))
    image = np.full((180, 320, 3), (40, 50, 70), np.uint8)
    dim = LightEstimator().update(image)
    assert (dim.white < bright.white).all()
    assert dim.white[0] > dim.white[1] > dim.white[2]
    black = LightEstimator().update(np.zeros_like(image))
    assert black.white == pytest.approx(LightEstimator.LUMINANCE_RANGE[0], rel=0.01)


@pytest.mark.parametrize("is_measured", [False, True])
def test_a_character_is_as_dark_as_the_paper_in_a_dark_room(view, is_measured):
    room, dim = np.full((180, 320, 3), 20, np.uint8), 0.04
    measured = MeasuredLight(
        view.camera_from_table[:3, 1], np.full(3, dim / 2), np.full(3, dim / 2), 1.0
    )
    estimate = LightEstimator()
    paper = np.full(3, dim * estimate.PAPER_ALBEDO)
    for _ in range(150):
        known = measured if is_measured else None
        light = estimate.update(room, lambda: paper, known, view.camera_from_table)
    assert light.white == pytest.approx(dim, rel=0.01)


@pytest.mark.parametrize(
    ("after", "change"), [(60, 1.0), (30, LINEAR_FROM_SRGB[30] / LINEAR_FROM_SRGB[60])]
)
def test_a_hidden_cube_changes_the_light_only_as_the_picture_changes(view, after, change):
    estimate, paper = LightEstimator(), np.full(3, 0.2)
    seen, hidden = (np.full((180, 320, 3), level, np.uint8) for level in (60, after))
    for _ in range(150):
        before = estimate.update(seen, lambda: paper).white
    for _ in range(150):
        light = estimate.update(hidden, lambda: None).white
    assert light == pytest.approx(change * before, rel=0.01)


def test_the_light_changes_slowly(view):
    estimate = LightEstimator()
    first = estimate.update(np.full((180, 320, 3), 60, np.uint8)).white
    for _ in range(PICTURES_PER_LOOK):  # not all of them are looked at
        second = estimate.update(np.full((180, 320, 3), 240, np.uint8)).white
    for _ in range(80):
        last = estimate.update(np.full((180, 320, 3), 240, np.uint8)).white
    assert (first < second).all()
    assert ((second - first) < 0.1 * (last - first)).all()


@pytest.mark.parametrize("distortion", [np.zeros(5), BENT])
def test_the_paper_of_a_cube_is_measured_between_its_markers(view, cube, distortion):
    corners = np.array([(-1, 1, 1), (1, 1, 1), (1, -1, 1), (-1, -1, 1)]) / 2
    image = np.zeros_like(view.image)
    for scale, value in ((1.0, 180), (0.66, 20)):
        seen = cube.edge * corners * [scale, scale, 1.0]
        seen = seen @ cube.camera_from_box[:3, :3].T + cube.camera_from_box[:3, 3]
        bent, _ = cv2.projectPoints(seen, np.zeros(3), np.zeros(3), view.matrix, distortion)
        pixels = np.rint(bent[:, 0]).astype(int)
        cv2.fillConvexPoly(image, pixels, (value,) * 3)
    view = replace(view, image=image, distortion=distortion)
    paper = paper_color(replace(view, occluders=(cube,)))
    assert paper == pytest.approx(LINEAR_FROM_SRGB[[180] * 3])
    assert paper_color(view) is None
    broken = replace(cube, camera_from_box=np.full((4, 4), np.nan))
    assert paper_color(replace(view, occluders=(broken,))) is None


def test_a_missing_library_is_named_with_the_command_that_installs_it(monkeypatch):
    from cubeling.characters.errors import CharacterError

    def fails(*_, **__):
        raise RuntimeError("libEGL.so not loaded")

    monkeypatch.setattr("moderngl.create_context", fails)
    monkeypatch.setattr("platform.system", lambda: "Linux")
    monkeypatch.setattr("cubeling.characters.rendering.context.find_library", lambda name: None)
    with pytest.raises(CharacterError, match=r"libEGL is missing.*apt install libegl1"):
        create_context()
    monkeypatch.setattr("cubeling.characters.rendering.context.find_library", lambda name: name)
    with pytest.raises(CharacterError, match="libgl1-mesa-dri"):
        create_context()
    with pytest.raises(CharacterError, match="graphics driver"):
        create_context(window=True)
