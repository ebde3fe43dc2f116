"""The benchmark's trackers answer from processes of their own."""

import cv2
import numpy as np
import pytest

from tests.bench.tracking.rivals.environments import ENTRIES, Entry, UnavailableError
from tests.bench.tracking.rivals.worker import Worker
from tracking import CubeModel

MATRIX = np.array([[900.0, 0, 641.5], [0, 902.0, 357.0], [0, 0, 1]])
POSE = np.array([[1.0, 0, 0, 0.02], [0, -1, 0, -0.01], [0, 0, -1, 0.45], [0, 0, 0, 1]])
"""The front face looks straight at the camera."""


@pytest.fixture
def job(tmp_path):
    """Draw the front of the cube in two frames, and an empty third; return file and message."""
    cube = CubeModel.load("locomotion")
    face = cube.face("front")
    dictionary = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_4X4_50)
    marker = cv2.aruco.generateImageMarker(dictionary, face.marker_id, 240)
    corners, _ = cv2.projectPoints(face.corners, cv2.Rodrigues(POSE[:3, :3])[0], POSE[:3, 3],
                                   MATRIX, np.zeros(5))  # fmt: skip
    square = np.array([(-0.5, -0.5), (239.5, -0.5), (239.5, 239.5), (-0.5, 239.5)], np.float32)
    plane = cv2.getPerspectiveTransform(square, corners.reshape(4, 2).astype(np.float32))
    picture = cv2.warpPerspective(marker, plane, (1280, 720), borderValue=200, flags=cv2.INTER_AREA)
    frames = np.full((3, 720, 1280, 3), 200, np.uint8)
    frames[:2] = cv2.GaussianBlur(picture, (0, 0), 0.7)[..., None]
    np.save(tmp_path / "frames.npy", frames)
    faces = [
        {"id": each.marker_id, "name": each.name, "corners": each.corners.tolist()}
        for each in cube.faces
    ]
    message = {
        "timestamps": [0.0, 1 / 30, 2 / 30],
        "independent": False,
        "camera": {"matrix": MATRIX.tolist(), "distortion": [0.0] * 5, "size": [1280, 720]},
        "cube": {"name": "locomotion", "dictionary": "DICT_4X4_50", "edge": 0.06, "faces": faces},
    }
    return tmp_path / "frames.npy", message


@pytest.mark.parametrize("name", ["subpix", "ours"])
def test_a_tracker_answers_frame_by_frame_with_pose_and_time(name, job):
    with Worker(ENTRIES[name], threads=1) as worker:
        worker.begin(*job)
        found, again, empty = worker.ask(range(3))
    assert [answer["index"] for answer in (found, again, empty)] == [0, 1, 2]
    assert [answer.get("failure") for answer in (found, again, empty)] == [None] * 3
    assert np.linalg.norm(np.array(again["pose"])[:3, 3] - POSE[:3, 3]) < 0.003
    assert empty["pose"] is None
    assert 0 < found["ms"] < 1000


def test_a_slow_tracker_is_asked_for_some_frames_only(job):
    entry = Entry("cv2", ENTRIES["subpix"].module, "SUBPIX", every=2)
    with Worker(entry, threads=1) as worker:
        worker.begin(*job)
        assert [answer["index"] for answer in worker.ask(range(3))] == [0, 2]


def test_a_tracker_that_cannot_start_says_why():
    with pytest.raises(UnavailableError, match=r"its process ended: .*no_such_tracker"):
        Worker(Entry("none", "tests.bench.tracking.rivals.no_such_tracker"), threads=1)


def test_a_tracker_whose_process_dies_says_why(job):
    with Worker(ENTRIES["subpix"], threads=1) as worker:
        frames, message = job
        worker.begin(frames.with_name("absent.npy"), message)
        with pytest.raises(UnavailableError, match=r"its process ended: .*absent\.npy"):
            worker.ask(range(3))
