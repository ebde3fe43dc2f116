"""Boxes, a dodecahedron and a pyramid on a table: which side is up, and that they rest."""

from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from cubeling.tracking import CubeControls, CubeModel, CubeState
from cubeling.tracking.cube.sides import SideDirections
from cubeling.tracking.geometry import se3
from cubeling.tracking.gestures.gestures import CubeGestures
from tests.tracking.gestures.test_gestures import COVARIANCE, camera_from_table

Array = NDArray[np.float64]

BODIES: dict[str, dict[str, object]] = {
    "box": {"size_mm": [90, 40, 60], "face": [{"name": "front", "marker_id": 0}]},
    "pyramid": {
        "face": [
            {"name": "base", "center_mm": [0, -10, 0], "normal": [0, -1, 0]},
            {"name": "slope", "center_mm": [0, 5, 15], "normal": [0, 1, 1], "marker_id": 0},
        ]
    },
}


def body(name: str) -> CubeModel:
    if name == "dodecahedron":
        return CubeModel.load(Path(__file__).parents[1] / "dodecahedron.toml")
    document = {"dictionary": "DICT_4X4_50", "marker_mm": 20, **BODIES[name]}
    return CubeModel.from_document(document, "test", name)


def upright(direction: Array, height: float) -> Array:
    """Pose on the table of a body with a direction up, its origin at a height [m]."""
    axis = np.cross(direction, (0.0, 1.0, 0.0))
    sine = np.linalg.norm(axis)
    axis = axis / sine if sine > 1e-9 else np.array([1.0, 0.0, 0.0])
    turn = se3.rotation(axis * np.arctan2(sine, direction[1]))
    return se3.pose(turn, np.array([0.0, height, 0.0]))


def watched(cube: CubeModel, poses: list[Array]) -> list[CubeControls]:
    gestures = CubeGestures(cube)
    return [
        gestures.update(
            CubeState(
                True,
                camera_from_table() @ pose,
                np.zeros(6),
                COVARIANCE,
                "markers",
                (),
                0.1,
                index / 30,
            )
        )
        for index, pose in enumerate(poses)
    ]


@pytest.mark.parametrize("name", ["box", "dodecahedron"])
def test_each_side_can_be_up(name: str) -> None:
    cube = body(name)
    sides = SideDirections(cube.sides)
    for (side, normal), depth in zip(sides.normals.items(), sides.depths, strict=True):
        rest = [upright(normal, depth)] * 40
        lifted = [upright(normal, depth + 0.03)] * 10
        controls = watched(cube, rest + lifted)
        assert controls[39].top_face == side
        assert controls[39].resting
        assert not controls[39].lifted
        assert controls[-1].lifted
        table = controls[39].camera_from_table
        assert table is not None
        np.testing.assert_allclose(table, camera_from_table(), atol=1e-3)


def test_a_pyramid_rests_on_its_base_though_no_side_is_opposite() -> None:
    controls = watched(body("pyramid"), [upright(np.array([0.0, 1.0, 0.0]), 0.01)] * 40)
    assert (controls[-1].top_face, controls[-1].resting) == ("on base", True)
