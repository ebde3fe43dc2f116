"""A camera's file comes back as it was written, and ROS's own files are understood."""

import cv2
import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from hypothesis.extra.numpy import arrays

from cubeling.tracking import Intrinsics, TrackingError
from tests.examples import examples

ROS_FILE = """
image_width: 640
image_height: 480
camera_name: narrow_stereo
camera_matrix:
  rows: 3
  cols: 3
  data: [438.783367, 0.000000, 305.593336, 0.000000, 437.302876, 243.738352, 0, 0, 1]
distortion_model: plumb_bob
distortion_coefficients:
  rows: 1
  cols: 5
  data: [-0.361976, 0.110510, 1e-05, 0.000506, 0.000000]
"""

focal = st.floats(50, 5000)
lens = st.sampled_from([4, 5, 8]).flatmap(
    lambda count: arrays(np.float64, count, elements=st.floats(-2, 2, allow_subnormal=False))
)


@given(
    focal, focal, st.floats(-1e4, 1e4), lens, st.tuples(st.integers(1, 9999), st.integers(1, 9999))
)
@settings(max_examples=examples(50))
def test_a_saved_camera_is_read_back_exactly(tmp_path_factory, fx, fy, centre, distortion, size):
    matrix = np.array([[fx, 0.25, centre], [0, fy, centre / 3], [0, 0, 1]])
    camera = Intrinsics(matrix, distortion, size)
    path = tmp_path_factory.getbasetemp() / "camera.yaml"
    camera.save(path)
    again = Intrinsics.load(path)
    np.testing.assert_array_equal(again.matrix, camera.matrix)
    np.testing.assert_array_equal(again.distortion, camera.distortion)
    assert again.size == camera.size


def test_a_file_of_ros_is_read(tmp_path):
    path = tmp_path / "camera.yaml"
    path.write_text(ROS_FILE, encoding="utf-8")
    camera = Intrinsics.load(path)
    assert camera.size == (640, 480)
    assert camera.matrix[1, 2] == 243.738352
    np.testing.assert_array_equal(camera.distortion, [-0.361976, 0.11051, 1e-05, 0.000506, 0])


def test_the_guess_has_a_field_of_view_of_sixty_degrees():
    camera = Intrinsics.guess((1280, 720))
    left = np.degrees(np.arctan((-0.5 - camera.matrix[0, 2]) / camera.matrix[0, 0]))
    right = np.degrees(np.arctan((1279.5 - camera.matrix[0, 2]) / camera.matrix[0, 0]))
    assert right - left == pytest.approx(60)


def test_a_guess_is_60_degrees_along_the_longer_side():
    upright = Intrinsics.guess((480, 854))
    assert upright.matrix[0, 0] == pytest.approx(854 / 2 / np.tan(np.radians(30)))
    assert upright.focal_deviation == 0.35


def test_a_file_keeps_how_sure_the_focal_length_is(tmp_path):
    path = tmp_path / "camera.yaml"
    for deviation in (0.012, None):
        Intrinsics.guess((640, 480)).lengthen(1.5, deviation).save(path)
        assert Intrinsics.load(path).focal_deviation == deviation
    path.write_text(path.read_text() + "focal_deviation: wide\n")
    with pytest.raises(TrackingError, match="'focal_deviation' must be a share such as"):
        Intrinsics.load(path)


@given(arrays(np.float64, (7, 2), elements=st.floats(-0.3, 0.3)))
def test_undistorted_points_are_those_of_the_pinhole(rays):
    matrix = np.array([[900.0, 0, 639.5], [0, 905, 359.5], [0, 0, 1]])
    camera = Intrinsics(matrix, np.array([-0.12, 0.05, 0.001, -0.0005, 0.01]), (1280, 720))
    points = np.column_stack([rays, np.ones(len(rays))])
    none = np.zeros(3)
    seen, _ = cv2.projectPoints(points, none, none, camera.matrix, camera.distortion)
    perfect = (points @ matrix.T)[:, :2]
    np.testing.assert_allclose(camera.undistort(seen[:, 0]), perfect, atol=1e-6)


def test_undistorting_keeps_any_shape():
    camera = Intrinsics.guess((640, 480))
    assert camera.undistort(np.zeros((3, 4, 2))).shape == (3, 4, 2)
    assert camera.undistort(np.zeros((0, 2))).shape == (0, 2)


def test_a_scaled_camera_sees_the_same_rays():
    camera = Intrinsics.guess((1280, 720))
    half = camera.scale((640, 360))
    corner = np.linalg.inv(camera.matrix) @ (-0.5, -0.5, 1)
    np.testing.assert_allclose(np.linalg.inv(half.matrix) @ (-0.5, -0.5, 1), corner, atol=1e-12)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("image_width: 640", "image_width: wide", "'image_width' must be a whole number"),
        ("image_height: 480", "image_height: 0", "at least one pixel"),
        ("438.783367", "-438.783367", "focal lengths must be positive"),
        ("438.783367", ".nan", "finite"),
        ("438.783367, ", "", "must hold 9 numbers, not 8"),
        ("438.783367", "[1, 2]", "list of numbers called 'data'"),
        ("plumb_bob", "equidistant", "only plumb_bob and rational_polynomial"),
        ("-0.361976, ", "-0.3, 0.1, ", "must be 4, 5 or 8"),
        ("camera_matrix:", "matrix:", "'camera_matrix' needs"),
        ("image_width: 640", "image_width: [640", "is not YAML"),
        (ROS_FILE, "- 1", "holds no 'camera_matrix'"),
        (ROS_FILE, "", "holds no 'camera_matrix'"),
        ("image_width: 640", "a: &a [1, 2]\nb: *a", "it has aliases"),
    ],
)
def test_a_bad_camera_file_is_one_line(tmp_path, old, new, words):
    path = tmp_path / "camera.yaml"
    path.write_text(ROS_FILE.replace(old, new), encoding="utf-8")
    with pytest.raises(TrackingError) as caught:
        Intrinsics.load(path)
    assert words in str(caught.value)
    assert "\n" not in str(caught.value)


def test_absent_and_unwritable_files_are_one_line(tmp_path):
    with pytest.raises(TrackingError, match="cannot read the camera file"):
        Intrinsics.load(tmp_path / "none.yaml")
    with pytest.raises(TrackingError, match=r"cannot write .*camera\.yaml"):
        Intrinsics.guess((640, 480)).save(tmp_path / "none" / "camera.yaml")
