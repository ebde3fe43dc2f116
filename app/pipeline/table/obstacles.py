"""What is in the character's way: the cube, and the hand and the arm that hold it; and its view."""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from cubeling.app.pipeline.table.situation import SeenCube, table_from_cube
from cubeling.characters import Obstacle, TableView
from cubeling.tracking import CubeControls, CubeState, Intrinsics

Array = NDArray[np.float64]

LETS_GO_S = 1.0
"""A cube that has been still for so long is let go of [s]."""

MIN_SPEED_M_S, MIN_TURN_RAD_S = 0.01, math.radians(6)
"""What is slower is still: noise of the tracker."""

KEPT_S = 1.0
"""A cube that is out of sight is still where it was for so long [s]."""

FINGERS, ELBOW = np.array([-0.02, 0.065, -0.03]), np.array([0.77, 0.175, 0.045])
"""Ends of the hand and the arm, from the cube's centre [m]: that of a right-handed player who sits
before the camera. Nobody sees them before the picture is drawn, so they are taken for granted."""

ARM_SIZE = np.array([float(np.linalg.norm(ELBOW - FINGERS)), 0.10, 0.10])
"""Length and thickness of the arm [m]."""


class Obstacles:
    """Makes the obstacles of each frame. `edge` is that of the cube [m]."""

    def __init__(self, edge: float) -> None:
        self._edge = edge
        self._last_moved = -math.inf
        self._seen: tuple[float, Array] | None = None

    def update(
        self, state: CubeState, controls: CubeControls, *, from_left: bool = False
    ) -> tuple[Obstacle, ...]:
        """Return what is in the way in a frame; whether the arm comes `from_left`."""
        now, table = controls.timestamp, controls.camera_from_table
        pose = table_from_cube(state, controls)
        velocity = np.zeros(3)
        if pose is not None and table is not None:
            self._seen = now, pose
            if np.isfinite(state.velocity).all():
                velocity = np.asarray(table[:3, :3].T @ state.velocity[:3], float)
                turns = float(np.linalg.norm(state.velocity[3:])) > MIN_TURN_RAD_S
                if float(np.linalg.norm(velocity)) > MIN_SPEED_M_S or turns:
                    self._last_moved = now
            if not controls.resting:
                self._last_moved = now
        if self._seen is None or now - self._seen[0] > KEPT_S:
            return ()
        pose = self._seen[1]
        cube = Obstacle(pose, np.full(3, self._edge), velocity)
        if now - self._last_moved > LETS_GO_S:
            return (cube,)
        return cube, Obstacle(_arm(pose[:3, 3], from_left), ARM_SIZE, velocity)


def is_leftmost(cube: SeenCube, cubes: Sequence[SeenCube]) -> bool:
    """Return whether a cube lies left of all others, so that it is held from the left."""
    places = [each.controls.position for each in cubes if each is not cube]
    here = cube.controls.position
    others = [place[0] for place in places if place is not None]
    return here is not None and bool(others) and here[0] < min(others)


def _arm(cube: Array, from_left: bool) -> Array:
    """Return where the middle of the arm is, and how it lies, (4, 4), for a cube's centre (3,)."""
    side = np.array([-1.0 if from_left else 1.0, 1.0, 1.0])
    fingers, elbow = FINGERS * side, ELBOW * side
    along = (elbow - fingers) / np.linalg.norm(elbow - fingers)
    across = np.cross(along, [0.0, 1.0, 0.0])
    across /= np.linalg.norm(across)
    pose = np.eye(4)
    pose[:3, :3] = np.column_stack([along, np.cross(across, along), across])
    pose[:3, 3] = cube + (fingers + elbow) / 2
    return pose


def view_of(controls: CubeControls, camera: Intrinsics) -> TableView | None:
    """Return how a camera sees the table; None before the table is known."""
    table = controls.camera_from_table
    if table is None:
        return None
    (fx, _, cx), (_, fy, cy), _ = camera.matrix.tolist()
    width, height = camera.size
    planes = [[fx, 0, cx], [-fx, 0, width - cx], [0, fy, cy], [0, -fy, height - cy]]
    return TableView(
        np.asarray(np.linalg.inv(table)[:3, 3], float), np.array(planes, float) @ table[:3]
    )
