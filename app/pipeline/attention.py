"""What the character looks at: the cube, the hand that holds it, or who is behind the camera."""

import math

import numpy as np
from numpy.typing import NDArray

from app.errors import AppError
from characters import CharacterCommand
from tracking import CubeControls, CubeState

Array = NDArray[np.float64]

LOOKS = ("auto", "cube", "hand", "camera", "none")
"""What a person may ask for."""

_STIRS = 0.03  # [m/s]: a cube slower than this is held still
_TURNS = 0.4  # [rad/s]
_INTEREST = 1.3  # [s]: how long it keeps looking at a cube that has come to rest
_CAMERA, _CUBE = (2.0, 5.0), (0.8, 2.2)  # [s]: shortest and longest glance at each


class Attention:
    """Chooses a point to look at, frame by frame.

    By itself ("auto") it watches a cube that moves, and the hand while it lifts the cube; when
    all is quiet it looks at the person, with a glance at the cube now and then.

    Parameters
    ----------
    look
        One of `LOOKS`.
    edge
        Of the cube [m].
    """

    def __init__(self, look: str, edge: float) -> None:
        if look not in LOOKS:
            raise AppError(
                f"nothing to look at is called '{look}': choose one of {', '.join(LOOKS)}"
            )
        self._look = look
        self._edge = edge
        self._cube: Array | None = None
        self._moved = -math.inf
        self._rng = np.random.default_rng(1)
        self._glance, self._until = "camera", -math.inf

    def update(
        self, state: CubeState, controls: CubeControls, command: CharacterCommand
    ) -> Array | None:
        """Return what is looked at, (3,) in the table frame [m]; None for nothing.

        Parameters
        ----------
        state, controls
            Where the cube is and what the hand does with it.
        command
            What the character is asked to do.
        """
        table = controls.camera_from_table
        if self._look == "none" or table is None:
            return None
        table_from_camera = np.linalg.inv(table)
        if state.camera_from_cube is not None:
            seen = table_from_camera @ state.camera_from_cube[:, 3]
            self._cube = np.asarray(seen[:3], float)
        self._note(state, controls)
        camera = np.asarray(table_from_camera[:3, 3], float)
        look = self._chosen(controls, command) if self._look == "auto" else self._look
        if look == "camera" or self._cube is None:
            return camera
        return self._hand(self._cube, camera) if look == "hand" else self._cube

    def _note(self, state: CubeState, controls: CubeControls) -> None:
        """Remember when the cube last moved."""
        speeds = state.velocity  # NaN where the cube is not seen
        stirred = np.linalg.norm(speeds[:3]) > _STIRS or np.linalg.norm(speeds[3:]) > _TURNS
        if stirred or controls.lifted:
            self._moved = controls.timestamp

    def _chosen(self, controls: CubeControls, command: CharacterCommand) -> str:
        """Return what deserves attention."""
        now = controls.timestamp
        if command.activity == "move":
            return "cube"
        if controls.lifted:
            return "hand"
        if now - self._moved < _INTEREST:
            self._until = now  # then to the person: and, was that right?
            self._glance = "cube"
            return "cube"
        if now >= self._until:
            self._glance = "cube" if self._glance == "camera" else "camera"
            low, high = _CUBE if self._glance == "cube" else _CAMERA
            self._until = now + float(self._rng.uniform(low, high))
        return self._glance

    def _hand(self, cube: Array, camera: Array) -> Array:
        """Return where the hand is that holds the cube.

        Hands are not tracked: one that holds a cube reaches in from the person's side and from
        above, and hides the edge there.
        """
        toward = camera - cube
        toward[1] = 0.0
        toward /= max(float(np.linalg.norm(toward)), 1e-6)
        held: Array = cube + self._edge * (0.6 * toward + np.array([0.0, 0.6, 0.0]))
        return held
