"""A lens that play has measured is used again for the same camera and size, and no other."""

import numpy as np
import pytest

from cubeling.app.preferences import PreferenceStore
from cubeling.app.running.kept_lens import LensStore, camera_name
from cubeling.tracking import Intrinsics

SIZE = (640, 480)
MEASURED = Intrinsics.guess(SIZE).lengthen(1.6, 0.012)


@pytest.fixture
def store(tmp_path):
    return LensStore(PreferenceStore(tmp_path / "preferences.toml"))


def test_a_measured_lens_is_kept_for_its_camera_and_size(store):
    path = store.save("http://phone:8080/video", MEASURED)
    assert path.name == "http-phone-8080-video-640x480.yaml"
    found = store.load("http://phone:8080/video?exposure=8", SIZE)
    np.testing.assert_array_equal(found.matrix, MEASURED.matrix)
    assert found.focal_deviation == 0.012
    assert not found.distortion.any()
    assert store.load("http://other:8080/video", SIZE) is None
    assert store.load("http://phone:8080/video", (1280, 720)) is None
    assert store.problem == ""


def test_a_guess_is_not_kept(store):
    assert store.save("camera:0", Intrinsics.guess(SIZE)) is None
    assert store.save("camera:0", Intrinsics.guess(SIZE).lengthen(1.0, None)) is None
    assert store.load("camera:0", SIZE) is None


def test_without_a_file_of_preferences_nothing_is_kept():
    store = LensStore(PreferenceStore())
    assert store.save("camera:0", MEASURED) is None
    assert store.load("camera:0", SIZE) is None


def test_a_damaged_file_is_ignored_with_one_line(store):
    path = store.save("camera:0", MEASURED)
    path.write_text("camera_matrix: [")
    assert store.load("camera:0", SIZE) is None
    assert path.name in store.problem
    assert "\n" not in store.problem


def test_cameras_on_linux_are_named_by_what_they_are_called(tmp_path, monkeypatch):
    monkeypatch.setattr("cubeling.app.running.kept_lens.VIDEO_DEVICES", tmp_path)
    (tmp_path / "video2").mkdir()
    (tmp_path / "video2" / "name").write_text("HD Pro Webcam C920\n")
    assert camera_name("camera:2?exposure=8") == "camera-2-HD-Pro-Webcam-C920"
    assert camera_name("camera:/dev/video2") == "camera-dev-video2-HD-Pro-Webcam-C920"
    assert camera_name("camera:3") == "camera-3"
