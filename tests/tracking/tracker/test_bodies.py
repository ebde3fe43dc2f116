"""Bodies that are no cubes, drawn: found as they are, or refused where they may lean either way."""

import pytest

from cubeling.tracking import CubeModel, CubeTracker, Frame
from cubeling.tracking.gestures.gestures import CubeGestures
from tests.tracking.drawn import CAMERA, held, off, photograph, scene
from tests.tracking.showing import show_until_decided

BOX = CubeModel.from_document(
    {
        "dictionary": "DICT_4X4_50",
        "size_mm": [90, 45, 60],
        "marker_mm": 30,
        "face": [
            {
                "name": "front",
                "marker": [
                    {"marker_id": 1, "at_mm": [-21, 0]},
                    {"marker_id": 2, "at_mm": [21, 2], "roll_deg": 90},
                ],
            },
            {"name": "top", "marker_id": 3, "at_mm": [20, -5]},
            {"name": "right", "marker_id": 4, "roll_deg": 180},
        ],
    },
    "test",
    "box",
)

WEDGE = CubeModel.from_document(
    {
        "dictionary": "DICT_4X4_50",
        "marker_mm": 20,
        "face": [
            {
                "name": "slope",
                "center_mm": [0, 10, 0],
                "normal": [0, 1, 1],
                "outline_mm": [[-25, -30], [25, -30], [25, 30], [-25, 30]],
                "marker_id": 5,
            },
            {
                "name": "side",
                "center_mm": [25, 0, -5],
                "normal": [1, 0, 0],
                "outline_mm": [[-17, -17], [25, -17], [25, -5], [-5, 25], [-17, 25]],
                "marker_id": 6,
                "at_mm": [-4, -4],
            },
            {"name": "floor", "center_mm": [0, -25, 0], "normal": [0, -1, 0]},
        ],
    },
    "test",
    "wedge",
)


@pytest.mark.parametrize("body", [BOX, WEDGE], ids=lambda body: body.name)
def test_a_body_is_found_where_it_is(body: CubeModel) -> None:
    pose = held(x=0.4, y=-0.5, z=0.1)
    tracker, gestures = CubeTracker(body, CAMERA), CubeGestures(body)
    _, calls = show_until_decided(tracker, photograph(scene((body, pose))))
    for index in range(len(calls), len(calls) + 3):
        picture = photograph(scene((body, pose)), seed=index)
        state = tracker.update(Frame(picture, index / 30, index))
        assert state.visible, state.verdict
        assert {face.partition("/")[0] for face in state.faces} >= {body.faces[0].side}
        millimetres, degrees = off(state.camera_from_cube, pose)
        assert millimetres < 1.0
        assert degrees < 0.5
        gestures.update(state)


@pytest.mark.parametrize("lean", [(0.3, 0.2), (0.0, 0.02)])
def test_two_markers_of_one_side_lean_either_way_as_one_does(lean: tuple[float, float]) -> None:
    """Taken for two sides that agree, they would lean wrongly by 42° and 5°."""
    pose = held(*lean, z=0.0, at=(0, 0, 0.6))
    for seed in range(2):
        picture = photograph(scene((BOX, pose)), noise=2.0, seed=seed)
        state, _ = show_until_decided(CubeTracker(BOX, CAMERA), picture)
        assert state.visible
        assert off(state.camera_from_cube, pose)[1] < 2
