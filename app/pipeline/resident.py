"""The character in the cube: it fits into it, stands on the lowest wall, and faces the camera."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from cubeling.characters import (
    ActionIntent,
    Animator,
    Character,
    CharacterCommand,
    LocomotionIntent,
    PosedCharacter,
    RootDelta,
)
from cubeling.characters.motion import smoothstep
from cubeling.characters.rendering import WALL_SHARE
from cubeling.tracking import SIDE_NORMALS, se3

Array = NDArray[np.float64]

MAX_HEIGHT, MAX_WIDTH = 0.60, 0.92
"""Most that the character takes of the room's height, so that the beam of the walls' rims does not
hide its face from a camera that looks down, and of its width, as shares of the room's side."""

SWING_S = 0.35
"""Time in which the character moves over to another wall when that has become the floor [s]."""

MIN_SIZE = 0.02
"""A smaller character, as a share of its size, is not drawn."""


class Resident:
    """Animates a character in a cube whose edge is `edge` long [m].

    It does what the scenario asks for where it stands, with the face and the words of the one on
    the table; that one's way is not its own.
    """

    def __init__(self, character: Character, edge: float) -> None:
        self._animator = Animator(character, place=RootDelta())
        low, high = character.bounds * self._animator.scale
        room = (1.0 - 2.0 * WALL_SHARE) * edge
        width, height = float((high - low)[[0, 2]].max()), float(high[1] - min(low[1], 0.0))
        self._fit = min(MAX_HEIGHT * room / max(height, 1e-9), MAX_WIDTH * room / max(width, 1e-9))
        self._centre = np.eye(4)
        self._centre[[0, 2], 3] = -(character.bounds.mean(axis=0))[[0, 2]]
        self._floor_from_middle = 0.5 * room
        self._top = ""
        self._turned: tuple[Array, Array, float] | None = None  # from, by, and since when
        self._room = np.eye(3)  # cube_from_room, where +y is up

    def update(
        self,
        command: CharacterCommand,
        top_face: str | None,
        table_from_cube: Array,
        camera: Array,
        size: float,
    ) -> PosedCharacter | None:
        """Advance to the command's time and return the character in the table frame.

        Parameters
        ----------
        command
            What the scenario asks of the character.
        top_face
            Name of the face that points up.
        table_from_cube
            Where the cube is, (4, 4) [m].
        camera
            Where the camera is, (3,) in the table frame [m].
        size
            Share of its size, 0…1; None is returned if it is too small to be seen.
        """
        now = command.timestamp
        if top_face is not None and top_face != self._top:
            self._turn_room(SIDE_NORMALS[top_face], table_from_cube, camera, now)
            self._top = top_face
        cube_from_room = np.eye(4)
        cube_from_room[:3, :3] = self._turn(now)
        cube_from_room[:3, 3] = -self._floor_from_middle * cube_from_room[:3, 1]
        table_from_room = table_from_cube @ cube_from_room
        eye = (np.linalg.inv(table_from_room) @ [*camera, 1.0])[:3] / self._fit
        posed = self._animator.update(
            replace(
                command,
                locomotion=LocomotionIntent(facing=eye[[0, 2]]),
                action=command.action or ActionIntent("idle"),
                gaze=None if command.gaze is None else eye,
                behaviour=None,
                obstacles=(),
            )
        )
        if size < MIN_SIZE:
            return None
        stands = np.array(posed.table_from_character)
        stands[[0, 2], 3] = 0.0
        scaled = np.diag([*[self._fit * size] * 3, 1.0])
        return replace(posed, table_from_character=table_from_room @ scaled @ stands @ self._centre)

    def _turn_room(self, up: Array, table_from_cube: Array, camera: Array, now: float) -> None:
        """Make another wall the floor; the first time, let the room face the camera."""
        if not self._top:
            toward = table_from_cube[:3, :3].T @ (camera - table_from_cube[:3, 3])
            level = np.where(np.abs(up) > 0.5, 0.0, toward)
            front = np.zeros(3)
            largest = int(np.argmax(np.abs(level)))
            front[largest] = np.copysign(1.0, level[largest])
            self._room = np.stack([np.cross(up, front), up, front], axis=1)
            return
        before = self._turn(now)
        axis: Array = np.cross(self._room[:, 1], up)
        if not axis.any():  # it is upside down
            axis = 2.0 * self._room[:, 2]
        self._room = np.rint(se3.rotation(np.pi / 2.0 * axis) @ self._room) + 0.0
        self._turned = before, se3.rotation_vector(self._room @ before.T), now

    def _turn(self, now: float) -> Array:
        """Return `cube_from_room` as it is now, (3, 3): it moves on smoothly to another floor."""
        if self._turned is None:
            return self._room
        before, by, since = self._turned
        share = min(max((now - since) / SWING_S, 0.0), 1.0)
        if share >= 1.0:
            self._turned = None
            return self._room
        return np.asarray(se3.rotation(smoothstep(share) * by) @ before)
