"""What a character looks at: the cube, the hand that holds it, the player, or one another."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cubeling.app.pipeline.choices import check_look
from cubeling.characters import CharacterCommand
from cubeling.tracking import CubeControls, CubeState

Array = NDArray[np.float64]

MIN_SPEED_M_S = 0.03
"""A slower cube counts as still."""

MIN_TURN_RAD_S = 0.4
"""A cube that turns more slowly counts as still."""

CUBE_INTEREST_S = 1.3
"""How long the character looks at a cube that has come to rest."""

REST_GLANCE_S = {"camera": (2.0, 5.0), "cube": (0.8, 2.2), "other": (0.9, 2.4)}
BUSY_GLANCE_S = {"camera": (0.8, 1.4), "cube": (1.6, 3.0)}
"""Shortest and longest duration of a glance at each, while the cube rests, and while it moves or
the character goes after it: the player sees a face now and then. A glance at another character
comes between them while the cube rests."""

HAND_OFFSET_EDGES = 0.6
"""Where the hand is, from the cube's center towards the player and up, in edges of the cube."""


THINKING_ASIDE, THINKING_UP = 0.32, 0.22
"""How far from the player who thinks looks, to the side and up, as shares of the distance."""


@dataclass(frozen=True)
class Company:
    """The others of the cast, as one of them sees them."""

    faces: tuple[Array, ...] = ()
    """Where their faces are, (3,) in the table frame each [m]."""

    speaker: Array | None = None
    """The face of one that speaks; None for silence."""

    waits: bool = False
    """Whether it waits for the end of what that one says, to say something itself."""


ALONE = Company()
"""Nobody else is on the table."""


class Attention:
    """Chooses a point to look at, frame by frame.

    With "auto" it watches a cube that moves or that it goes after, with glances at the player, and
    the hand while it lifts the cube. When the cube is still it looks at the player, with a glance
    at the cube now and then, and at one of the others. Another one that speaks is looked at. `edge`
    is that of the cube [m], and `seed` that of the glances. Raises AppError if `look` is not one of
    `LOOK_CHOICES`.
    """

    def __init__(self, look: str, edge: float, seed: int = 1) -> None:
        check_look(look)
        self.look = look
        """One of `LOOK_CHOICES`."""
        self._edge = edge
        self._cube: Array | None = None
        self._last_moved = -math.inf
        self._rng = np.random.default_rng(seed)
        self._glance, self._until = "camera", -math.inf
        self._busy = False
        self._other = 0

    def update(
        self,
        state: CubeState,
        controls: CubeControls,
        command: CharacterCommand,
        company: Company = ALONE,
        *,
        thinks: bool = False,
    ) -> Array | None:
        """Return the point to look at, (3,) in the table frame [m]; None for none.

        Who thinks looks beside the player, and up.
        """
        table = controls.camera_from_table
        if self.look == "none" or table is None:
            return None
        table_from_camera = np.linalg.inv(table)
        if state.camera_from_cube is not None:
            seen = table_from_camera @ state.camera_from_cube[:, 3]
            self._cube = np.asarray(seen[:3], float)
        velocity = state.velocity  # NaN while the cube is not visible
        moves = np.linalg.norm(velocity[:3]) > MIN_SPEED_M_S
        turns = np.linalg.norm(velocity[3:]) > MIN_TURN_RAD_S
        if moves or turns or controls.lifted:
            self._last_moved = controls.timestamp
        camera = np.asarray(table_from_camera[:3, 3], float)
        if thinks:
            right, up = table_from_camera[:3, 0], -table_from_camera[:3, 1]
            distance = float(np.linalg.norm(camera))
            return camera + distance * (THINKING_ASIDE * right + THINKING_UP * up)
        look = self._choose(controls, command, company) if self.look == "auto" else self.look
        if look == "speaker":
            return company.speaker
        if look == "other":
            return company.faces[self._other % len(company.faces)] if company.faces else camera
        if look == "camera" or self._cube is None:
            return camera
        return self._hand(self._cube, camera) if look == "hand" else self._cube

    def _choose(self, controls: CubeControls, command: CharacterCommand, company: Company) -> str:
        """Return what to look at with "auto"."""
        now = controls.timestamp
        if company.speaker is not None and (company.waits or command.activity != "move"):
            return "speaker"
        if controls.lifted and command.activity != "move":
            return "hand"
        busy = command.activity == "move" or now - self._last_moved < CUBE_INTEREST_S
        if busy != self._busy:
            self._busy, self._until = busy, now
            self._glance = "camera" if busy else "cube"  # the other one comes now
        if now >= self._until:
            self._glance = self._next_glance(company)
            durations = BUSY_GLANCE_S if busy else REST_GLANCE_S
            self._until = now + float(self._rng.uniform(*durations[self._glance]))
        return self._glance

    def _next_glance(self, company: Company) -> str:
        if self._glance == "camera":
            return "cube"
        if self._glance == "other" or self._busy or not company.faces:
            return "camera"
        self._other = int(self._rng.integers(len(company.faces)))
        return "other"

    def _hand(self, cube: Array, camera: Array) -> Array:
        """Return a guess of the hand's place: hands come from the player's side and from above."""
        toward = camera - cube
        toward[1] = 0.0
        toward /= max(float(np.linalg.norm(toward)), 1e-6)
        toward[1] = 1.0
        hand: Array = cube + self._edge * (HAND_OFFSET_EDGES * toward)
        return hand
