"""The benchmark's trackers answer from processes of their own."""

import numpy as np
import pytest

from cubeling.tracking import CubeModel, Intrinsics
from tests.bench.tracking.rivals.environments import ENTRIES, Entry, UnavailableError
from tests.bench.tracking.rivals.worker import Worker
from tests.tracking.drawn import held, photograph, scene

pytestmark = pytest.mark.full

MATRIX = np.array([[900.0, 0, 641.5], [0, 902.0, 357.0], [0, 0, 1]])
POSE = held(at=(0.02, -0.01, 0.45))
"""Three faces are seen: of a single one, square on, the tracker would be unsure."""


@pytest.fixture
def job(tmp_path):
    """Draw the cube in two frames, and an empty third; return file and message."""
    cube = CubeModel.load("locomotion")
    camera = Intrinsics(MATRIX, np.zeros(5), (1280, 720))
    # In linear grey values white does not grow over black, which would move the corners of cv2.
    picture = photograph(scene((cube, POSE), camera=camera), exponent=1.0)
    frames = np.full((3, 720, 1280, 3), 200, np.uint8)
    frames[:2] = picture
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
