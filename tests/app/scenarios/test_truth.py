"""The bundled recordings against the truth of the scripts that they were drawn from."""

import numpy as np
import pytest

from cubeling.app.session import messages
from cubeling.app.session.bundled import RECORDED_SCENARIOS
from cubeling.app.session.encoding import decode
from cubeling.tracking import CubeControls, CubeState
from cubeling.tracking.synthetic import open_synthetic
from tests.conftest import FIRST_S
from tests.examples import some

PARTS = [("companion", FIRST_S), *((name, None) for name in RECORDED_SCENARIOS)]


@pytest.fixture(scope="module", params=some([[part] for part in PARTS]), ids=str)
def recording(request, computed_session):
    """The name of a bundled recording, and its file with every channel, or its first seconds."""
    ((name, seconds),) = request.param
    return name, computed_session(name, seconds)


def computed(path, topic, kind):
    return [decode(kind, data) for _, _, data in messages(path, topic)]


def test_the_cube_is_found_in_nearly_every_frame(recording):
    states = computed(recording[1], "/cube/state", CubeState)
    assert np.mean([state.visible for state in states]) > 0.97


def test_the_pose_is_the_true_one(recording):
    """Through lens, noise, blur, fingers and H.264."""
    name, path = recording
    source = open_synthetic(name)
    shifts, angles = [], []
    for index, state in enumerate(computed(path, "/cube/state", CubeState)):
        if not state.visible or state.camera_from_cube is None:
            continue
        truth, pose = source.truth(index), state.camera_from_cube
        shifts.append(np.linalg.norm(pose[:3, 3] - truth[:3, 3]))
        turn = pose[:3, :3].T @ truth[:3, :3]
        angles.append(np.arccos(np.clip((np.trace(turn) - 1) / 2, -1, 1)))
    assert np.median(shifts) < 1e-3
    assert np.degrees(np.median(angles)) < 0.15
    assert np.max(shifts) < 0.02, "silently wrong"


def test_every_resting_frame_has_the_right_top_face(recording):
    name, path = recording
    source = open_synthetic(name)
    resting = 0
    for index, controls in enumerate(computed(path, "/cube/controls", CubeControls)):
        state = source.state(index)
        if controls.resting and state.resting:
            resting += 1
            assert controls.top_face == state.top_face, f"frame {index}"
    assert resting > 100
