"""The cube as a window: when its walls open, and what is then seen inside."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cubeling.app.pipeline.choices import inside_of
from cubeling.app.pipeline.resident import Resident
from cubeling.characters import Character, CharacterCommand, PosedCharacter
from cubeling.characters.rendering import Box
from cubeling.tracking import SIDE_NORMALS, CubeControls, CubeModel, CubeState

Array = NDArray[np.float64]

DWELL_S = 0.5
"""A face must be shown for so long before it opens or closes the cube [s]: others are shown for a
moment while the hand turns it."""

OPENING_S = 0.6
"""Time in which the walls open or close [s]."""

LEAVE_SHARE, ARRIVE_SHARE = 0.5, 0.4
"""Shares of this time at which the character on the table has left, and the one in the cube begins
to appear."""

INVITATION_S = 5.0
"""The player is asked to look inside for so long after the cube has opened [s]."""

HOLD_S = 0.25
"""A cube that is lost for no longer than this stays open where it was last seen [s]: fingers hide
it for moments."""


@dataclass(frozen=True)
class Interior:
    """What is seen of an open cube in one frame."""

    box: Box | None
    """The open cube; None while it is not seen."""

    resident: PosedCharacter | None
    """The character in it, placed on the table through the cube; None while it is too small."""

    left_on_table: float
    """Share of its size that the character on the table still has, 0…1."""


class CubeWindow:
    """Opens and closes one cube, frame by frame.

    Time comes from `CubeControls.timestamp`. It decides about the picture only.

    Parameters
    ----------
    cube, character
        The cube in play, and who is seen in it.
    roles
        The roles that the scenario reads from the face on top; () if it reads none, and the side
        that looks at the camera decides.
    choice
        One of `INSIDE_CHOICES`.
    """

    def __init__(
        self, cube: CubeModel, character: Character, roles: Sequence[str], choice: str = "auto"
    ) -> None:
        self._cube, self._character = cube, character
        self._top_decides = bool(roles)
        # What is inside is drawn in a cube.
        self._choice = inside_of("never" if cube.body else choice)
        self._with_role = frozenset(face.side for face in cube.faces if face.role)
        self._wanted = self._choice == "always"
        self._asked_by_face = False
        self._changing_since: float | None = None
        self._opening = 0.0
        self._now: float | None = None
        self._opened_at: float | None = None
        self._seen: tuple[float, Array] | None = None
        self._resident: Resident | None = None

    @property
    def invites(self) -> bool:
        """Whether it has opened only just, so that the player is asked to look inside."""
        if self._opened_at is None or self._now is None or not self._wanted:
            return False
        return self._now - self._opened_at < INVITATION_S

    def cast(self, character: Character) -> None:
        """Let another character be inside."""
        self._character, self._resident = character, None

    def update(
        self, state: CubeState, controls: CubeControls, command: CharacterCommand, toggled: bool
    ) -> Interior | None:
        """Advance by one frame, and return what is seen inside; None for a closed cube.

        `toggled` is whether the player asks to open a closed cube, or to close an open one.
        """
        now, table = controls.timestamp, controls.camera_from_table
        elapsed = 0.0 if self._now is None else max(now - self._now, 0.0)
        self._now = now
        if self._choice != "never":
            self._decide(state, controls, toggled)
        pose = self._pose(now, state)
        if table is None or pose is None:
            if self._seen is None:
                self._opening, self._resident, self._opened_at = 0.0, None, None
            return None if self._opening <= 0.0 else Interior(None, None, self._left)
        change = elapsed / OPENING_S * (1.0 if self._wanted else -1.0)
        self._opening = min(max(self._opening + change, 0.0), 1.0)
        if self._opening <= 0.0:
            self._resident = self._opened_at = None
            return None
        if self._opened_at is None:
            self._opened_at = now
        if self._resident is None:
            self._resident = Resident(self._character, self._cube.edge)
        size = _smooth((self._opening - ARRIVE_SHARE) / (1.0 - ARRIVE_SHARE))
        table_from_camera = np.asarray(np.linalg.inv(table), float)
        resident = self._resident.update(
            command, controls.top_face, table_from_camera @ pose, table_from_camera[:3, 3], size
        )
        box = Box(pose, self._cube.edge, _smooth(self._opening))
        return Interior(box, resident, self._left)

    @property
    def _left(self) -> float:
        return 1.0 - _smooth(self._opening / LEAVE_SHARE)

    def _decide(self, state: CubeState, controls: CubeControls, toggled: bool) -> None:
        """Let the shown face decide if it changes for long enough, and the player at once."""
        if toggled:
            self._wanted = not self._wanted
        face = self._shown_face(state, controls)
        if self._choice != "auto" or not self._with_role or face is None:
            return
        asks = face not in self._with_role
        if asks == self._asked_by_face:
            self._changing_since = None
            return
        if self._changing_since is None:
            self._changing_since = controls.timestamp
        if controls.timestamp - self._changing_since >= DWELL_S - 1e-9:
            self._asked_by_face = self._wanted = asks
            self._changing_since = None

    def _shown_face(self, state: CubeState, controls: CubeControls) -> str | None:
        """Return the name of the face that decides; None while none does.

        In the hand it is the one that looks at the camera most squarely; on the table the one on
        top, or the most square one of the sides.
        """
        pose, top = state.camera_from_cube, controls.top_face
        if pose is None or not controls.visible or top is None:
            return None
        if controls.resting and self._top_decides:
            return top
        toward = -pose[:3, :3].T @ pose[:3, 3]
        shown = {
            name: float(normal @ toward)
            for name, normal in SIDE_NORMALS.items()
            if controls.lifted or self._top_decides or abs(normal @ SIDE_NORMALS[top]) < 0.5
        }
        return max(shown, key=lambda name: shown[name])

    def _pose(self, now: float, state: CubeState) -> Array | None:
        """Return the cube's pose, or the last one for a moment; forget it after that."""
        if state.camera_from_cube is not None:
            self._seen = now, state.camera_from_cube
        elif self._seen is not None and now - self._seen[0] > HOLD_S:
            self._seen = None
        return None if self._seen is None else self._seen[1]


def _smooth(share: float) -> float:
    """Return a share, 0…1, that begins and ends slowly.

    >>> [round(_smooth(share), 4) for share in (-1.0, 0.5, 2.0)]
    [0.0, 0.5, 1.0]
    """
    return 0.5 - 0.5 * math.cos(math.pi * min(max(share, 0.0), 1.0))
