"""The bundled recordings against the truth of the scripts that they were drawn from."""

import numpy as np
import pytest

from cubeling.app.scenarios import SCENARIOS
from cubeling.app.session import messages
from cubeling.app.session.bundled import bundled
from cubeling.app.session.encoding import decode
from cubeling.tracking import CubeControls, CubeState
from cubeling.tracking.synthetic import open_synthetic


def recorded(name, topic, kind):
    return [decode(kind, data) for _, _, data in messages(bundled(name), topic)]


@pytest.mark.parametrize("name", SCENARIOS)
def test_the_recorded_pose_is_the_true_one(name):
    """Through lens, noise, blur, fingers and H.264."""
    source = open_synthetic(name)
    shifts, angles = [], []
    for index, state in enumerate(recorded(name, "/cube/state", CubeState)):
        if not state.visible or state.camera_from_cube is None:
            continue
        truth, pose = source.truth(index), state.camera_from_cube
        shifts.append(np.linalg.norm(pose[:3, 3] - truth[:3, 3]))
        turn = pose[:3, :3].T @ truth[:3, :3]
        angles.append(np.arccos(np.clip((np.trace(turn) - 1) / 2, -1, 1)))
    assert np.median(shifts) < 1e-3
    assert np.degrees(np.median(angles)) < 0.15
    assert np.max(shifts) < 0.02, "silently wrong"


@pytest.mark.parametrize("name", SCENARIOS)
def test_every_resting_frame_has_the_right_top_face(name):
    source = open_synthetic(name)
    resting = 0
    for index, controls in enumerate(recorded(name, "/cube/controls", CubeControls)):
        state = source.state(index)
        if controls.resting and state.resting:
            resting += 1
            assert controls.top_face == state.top_face, f"frame {index}"
    assert resting > 100
