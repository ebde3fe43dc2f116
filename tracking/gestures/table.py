"""The table, learned from where the cube rests.

The rule, in full:

1. The cube teaches when it keeps still for 0.3 s (`Stillness`). A *firm* rest, without tremor,
counts at once; a
   trembling one only after a second, and what it teaches is provisional.
2. Up is first the normal of that seen face that comes closest to `PRIOR_UP`, later the table's own.
3. Rests that agree with the table improve it. Each place counts once, however long the cube stays
there: its
   errors (a badly folded face, the lens) are the same in every frame. So the table settles within a
   second and then does not move at all.
4. Rests that agree with each other but not with the table gather evidence for another one, and
replace
   it: after 0.3 s if it was provisional and they are firm, after 1.5 s of firm rest, after 4 s of
   trembling rest. A hand that held the cube still in the air is so forgotten, and a camera that was
   moved is noticed.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tracking.cube.model import FACE_AXES
from tracking.geometry import se3

Array = NDArray[np.float64]

PRIOR_UP = np.array([0.0, -np.cos(np.deg2rad(35)), -np.sin(np.deg2rad(35))])
"""Up in the camera frame for an upright camera that looks down by 35°."""

FACE_SPREAD = np.deg2rad(1.0)
"""How far a face of a folded cube leans from its place [rad], one standard deviation."""

HEIGHT_SPREAD = 0.001
"""How far the foot of a resting cube is from the table [m], one standard deviation."""

SETTLING = 0.5
"""A place counts once it has been rested on for this long [s]; later frames there add nothing."""

NEW_PLACE = 0.03
"""A rest this far from the last one [m] is another place."""

TREMBLING_START = 1.0
"""How long a trembling rest must last before it teaches a first, provisional table [s]."""


@dataclass(frozen=True)
class Rest:
    """The foot of a cube at rest, in the camera frame."""

    foot: Array
    """Centre of the face that it stands on, (3,) [m]."""

    up: Array
    """Normal of the face that looks up, (3,)."""


def face_directions() -> dict[str, Array]:
    """Outward normals of the six sides in the cube frame, whether or not they carry a marker."""
    return {name: np.cross(*axes).astype(np.float64) for name, axes in FACE_AXES.items()}


DIRECTIONS = face_directions()


def rest_of(camera_from_cube: Array, edge: float, up: Array | None = None) -> Rest | None:
    """Where a resting cube stands, if `up` (or the prior, where it is None) says which side is up.

    Without a table only sides that look at the camera can be up, and none that is 60° off the
    prior.
    """
    turn, centre = camera_from_cube[:3, :3], camera_from_cube[:3, 3]
    normals = np.stack(list(DIRECTIONS.values())) @ turn.T
    likeness = normals @ (PRIOR_UP if up is None else up)
    if up is None:
        tops = centre + normals * (edge / 2)
        seen = -np.einsum("ij,ij->i", normals, tops) > -0.1 * np.linalg.norm(tops, axis=1)
        likeness = np.where(seen, likeness, -1)
    best = int(np.argmax(likeness))
    if likeness[best] < 0.5:
        return None
    return Rest(centre - normals[best] * (edge / 2), normals[best])


class Table:
    """A plane that improves with every place the cube rests on, by recursive least squares.

    Heights above its first estimate, (x, z) ↦ d + a·x + b·z: a rest measures the height at its foot
    and, less precisely, both slopes.
    """

    def __init__(self, rest: Rest) -> None:
        self._start = _frame(rest.foot, rest.up)
        self._plane = np.zeros(3)
        self._information = np.diag(1 / np.square([HEIGHT_SPREAD, FACE_SPREAD, FACE_SPREAD]))
        self._place = rest.foot
        self._settled = SETTLING
        self.camera_from_table = self._start

    def learn(self, rest: Rest, seconds: float) -> None:
        """Improve with a rest that has lasted `seconds` more."""
        if float(np.linalg.norm(rest.foot - self._place)) > NEW_PLACE:
            self._place, self._settled = rest.foot, 0.0
        share = min(seconds, SETTLING - self._settled) / SETTLING
        if share <= 0:
            return
        self._settled += share * SETTLING
        x, y, z, a, b = self._measured(rest)
        rows = np.array([[1, x, z], [0, 1, 0], [0, 0, 1]])
        weights = share / np.square([HEIGHT_SPREAD, FACE_SPREAD, FACE_SPREAD])
        self._information = self._information + (rows.T * weights) @ rows
        error = np.array([y, a, b]) - rows @ self._plane
        self._plane = self._plane + np.linalg.solve(self._information, rows.T @ (weights * error))
        self._rebuild()

    def height(self, point: Array) -> tuple[float, float]:
        """Height of a point of the camera frame above the table, and its standard deviation [m]."""
        x, y, z = (se3.inverse(self._start) @ np.append(point, 1))[:3]
        row = np.array([1, x, z])
        spread = float(np.sqrt(row @ np.linalg.solve(self._information, row)))
        slope = float(np.sqrt(1 + self._plane[1] ** 2 + self._plane[2] ** 2))
        return float(y - row @ self._plane) / slope, spread

    def agrees(self, rest: Rest) -> bool:
        """Whether a rest can be on this table."""
        height, spread = self.height(rest.foot)
        return abs(height) < 0.005 + 3 * spread and float(rest.up @ self.up) > np.cos(np.deg2rad(7))

    @property
    def up(self) -> Array:
        """Normal of the table in the camera frame, (3,)."""
        return self.camera_from_table[:3, 1]

    def _measured(self, rest: Rest) -> tuple[float, ...]:
        x, y, z = (se3.inverse(self._start) @ np.append(rest.foot, 1))[:3]
        normal = self._start[:3, :3].T @ rest.up
        return (
            float(x),
            float(y),
            float(z),
            float(-normal[0] / normal[1]),
            float(-normal[2] / normal[1]),
        )

    def _rebuild(self) -> None:
        d, a, b = self._plane
        up = self._start[:3, :3] @ np.array([-a, 1.0, -b])
        origin = self._start @ np.array([0, d, 0, 1])
        self.camera_from_table = _frame(origin[:3], up / np.linalg.norm(up))


class TableLearner:
    """Finds the table and notices when it is another, by the rule at the head of this module."""

    def __init__(self, edge: float) -> None:
        self._edge = edge
        self.table: Table | None = None
        self._provisional = False
        self._rival: Table | None = None
        self._firm_evidence = 0.0
        self._soft_evidence = 0.0

    def learn(self, camera_from_cube: Array, firm: bool, seconds: float) -> None:
        """Take in one frame in which the cube keeps still, `seconds` after the last such frame."""
        if self.table is not None:
            rest = rest_of(camera_from_cube, self._edge, self.table.up)
            if rest is not None and self.table.agrees(rest):
                if firm or self._provisional:
                    self.table.learn(rest, seconds)
                    self._forget_rival()
                self._provisional &= not firm
                return
        self._gather(camera_from_cube, firm, seconds)

    def _gather(self, camera_from_cube: Array, firm: bool, seconds: float) -> None:
        rest = rest_of(camera_from_cube, self._edge)
        if rest is None:
            return
        if self._rival is None or not self._rival.agrees(rest):
            self._forget_rival()
            self._rival = Table(rest)
            # The window that proves stillness is itself evidence only for a first table.
            seconds = 0.0
        self._rival.learn(rest, seconds)
        self._firm_evidence += seconds if firm else 0.0
        self._soft_evidence += seconds
        if self._convincing(firm):
            self.table, self._provisional = self._rival, self._firm_evidence == 0 and not firm
            self._forget_rival()

    def _convincing(self, firm: bool) -> bool:
        if self.table is None:
            return firm or self._soft_evidence >= TREMBLING_START
        if self._provisional and firm:
            return self._firm_evidence >= 0.3
        return self._firm_evidence >= 1.5 or self._soft_evidence >= 4.0

    def _forget_rival(self) -> None:
        self._rival = None
        self._firm_evidence = self._soft_evidence = 0.0


def _frame(origin: Array, up: Array) -> Array:
    """Frame of a table, (4, 4): +y up, +z level towards the camera.

    Straight below the camera, where no level direction leads to it, +z points down in the picture.
    """
    towards = -origin - up * (-origin @ up)
    if float(np.linalg.norm(towards)) < 0.02:
        towards = np.array([0.0, 1.0, 0.0])
        towards = towards - up * (towards @ up)
    z = towards / np.linalg.norm(towards)
    return se3.pose(np.stack([np.cross(up, z), up, z], axis=1), origin)
