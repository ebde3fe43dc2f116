"""The plane of the table, estimated from where the cube rests.

1. A cube that keeps still for 0.3 s (`StillnessDetector`) is evidence. A *firm* rest, without
   tremor, counts at once. A trembling one counts after a second, and its table is provisional.
2. Up is first the normal of the visible face that is closest to `PRIOR_UP`, later the table's own.
3. Rests that agree with the table improve it. Each place counts once: its errors (a badly folded
   face, the lens) are the same in every frame. So the table settles within a second.
4. Rests that agree with each other but not with the table are evidence for another table. It
   replaces the first after 0.3 s if that was provisional and the rests are firm, after 1.5 s of
   firm rest (the camera was moved), or after 4 s of trembling rest.
"""

from dataclasses import dataclass

import numpy as np

from cubeling.tracking.cube.sides import FACE_AXES, SideDirections
from cubeling.tracking.geometry import se3
from cubeling.tracking.geometry.arrays import Array

PRIOR_UP = np.array([0.0, -np.cos(np.deg2rad(35)), -np.sin(np.deg2rad(35))])
"""Up in the camera frame for an upright camera that looks down by 35°."""

REST_SIGMAS = np.array([0.001, np.deg2rad(1.0), np.deg2rad(1.0)])
"""Errors of the foot's height [m] and of both slopes [rad] of a folded cube at rest."""

SETTLING_TIME_S = 0.5
"""Rest at one place counts for this long; later frames there add nothing."""

NEW_PLACE_M = 0.03
"""A rest this far from the last one is another place."""

MAX_HEIGHT_ERROR_M, MAX_TILT_ERROR = 0.005, np.deg2rad(7)
"""A rest within this height, plus three standard deviations, and tilt [rad] agrees with a table."""

MIN_UP_COSINE = 0.5
"""The face that is up is at most 60° off."""

FIRST_TREMBLING_S, NEXT_TREMBLING_S = 1.0, 4.0
"""How long trembling rests last before they give a first, provisional table, and another one."""

NEXT_FIRM_S, NEXT_FIRM_AFTER_PROVISIONAL_S = 1.5, 0.3
"""How long firm rests last before they replace a table, and a provisional one."""


MOVED_DOUBT = 5.0
"""How much less sure a table is that another focal length has moved, than one rest."""


@dataclass(frozen=True)
class RestingFoot:
    """The foot of a cube at rest, in the camera frame."""

    foot: Array
    """Centre of the face that it stands on, (3,) [m]."""

    up: Array
    """Normal of the face that looks up, (3,)."""


SIDE_NORMALS = {name: np.cross(*axes).astype(np.float64) for name, axes in FACE_AXES.items()}
"""Outward normals of the six sides in the cube frame, whether or not they carry a marker."""


def rest_of(
    camera_from_cube: Array, sides: SideDirections, up: Array | None = None
) -> RestingFoot | None:
    """Return where a resting cube stands; None where no side of it can be up.

    Without a table (`up` is None) only sides that face the camera can be up.
    """
    rotation, centre = camera_from_cube[:3, :3], camera_from_cube[:3, 3]
    normals = sides.all_normals @ rotation.T
    # Rows are normals: the product with the transpose turns all of them at once.
    cosines = normals @ (PRIOR_UP if up is None else up)
    if up is None:
        tops = centre + normals * sides.heights[:, None]
        # −0.1: a side seen edge-on counts as facing, as noise tilts it either way.
        facing = -np.einsum("ij,ij->i", normals, tops) > -0.1 * np.linalg.norm(tops, axis=1)
        cosines = np.where(facing, cosines, -1)
    best = int(np.argmax(cosines))
    if cosines[best] < MIN_UP_COSINE:
        return None
    return RestingFoot(centre - normals[best] * sides.depths[best], normals[best])


class TablePlane:
    """A plane that every place of rest improves, by recursive least squares.

    It is the height above its first estimate, (x, z) ↦ d + a·x + b·z. Rests measure it and slopes.
    `doubt` is the error of the first estimate as a multiple of that of a rest.
    """

    def __init__(self, rest: RestingFoot, doubt: float = 1.0) -> None:
        self._start = _frame(rest.foot, rest.up)
        self._plane = np.zeros(3)
        self._information = np.diag(1 / (doubt * REST_SIGMAS) ** 2)
        self._place = rest.foot
        # What is less sure than a rest is improved by one at the same place.
        self._rest_time = SETTLING_TIME_S if doubt == 1.0 else 0.0
        self.camera_from_table = self._start

    def learn(self, rest: RestingFoot, seconds: float) -> None:
        """Improve the plane with a rest that lasts `seconds` more."""
        if float(np.linalg.norm(rest.foot - self._place)) > NEW_PLACE_M:
            self._place, self._rest_time = rest.foot, 0.0
        share = min(seconds, SETTLING_TIME_S - self._rest_time) / SETTLING_TIME_S
        if share <= 0:
            return
        self._rest_time += share * SETTLING_TIME_S
        x, y, z = (se3.inverse(self._start) @ np.append(rest.foot, 1))[:3].tolist()
        normal = self._start[:3, :3].T @ rest.up
        # The slopes of y over x and z from a normal (−a, 1, −b) of any length.
        a, b = -normal[0] / normal[1], -normal[2] / normal[1]
        rows = np.array([[1, x, z], [0, 1, 0], [0, 0, 1]])
        weights = share / REST_SIGMAS**2
        self._information = self._information + (rows.T * weights) @ rows
        error = np.array([y, a, b]) - rows @ self._plane
        self._plane = self._plane + np.linalg.solve(self._information, rows.T @ (weights * error))
        d, a, b = self._plane
        up = self._start[:3, :3] @ np.array([-a, 1.0, -b])
        origin = self._start @ np.array([0, d, 0, 1])
        self.camera_from_table = _frame(origin[:3], up / np.linalg.norm(up))

    def height(self, point: Array) -> tuple[float, float]:
        """Height of a point of the camera frame above the table, and its standard deviation [m]."""
        x, y, z = (se3.inverse(self._start) @ np.append(point, 1))[:3]
        row = np.array([1, x, z])
        spread = float(np.sqrt(row @ np.linalg.solve(self._information, row)))
        slope = float(np.sqrt(1 + self._plane[1] ** 2 + self._plane[2] ** 2))
        return float(y - row @ self._plane) / slope, spread

    def agrees(self, rest: RestingFoot) -> bool:
        """Whether a rest can be on this table."""
        height, spread = self.height(rest.foot)
        near = abs(height) < MAX_HEIGHT_ERROR_M + 3 * spread
        return near and float(rest.up @ self.up) > np.cos(MAX_TILT_ERROR)

    @property
    def up(self) -> Array:
        """Normal of the table in the camera frame, (3,)."""
        return self.camera_from_table[:3, 1]


class TableEstimator:
    """Estimates the table, and replaces it when it changes, by the rule at the top of this file."""

    def __init__(self, sides: SideDirections) -> None:
        self._sides = sides
        self.table: TablePlane | None = None
        self._provisional = False
        self._alternative: TablePlane | None = None
        self._firm_s = 0.0
        self._rest_s = 0.0

    def move(self, after_from_before: Array) -> None:
        """Take the table to another camera frame, (4, 4); the next firm rests settle it anew."""
        self._drop_alternative()
        if self.table is not None:
            frame = after_from_before @ self.table.camera_from_table
            foot = RestingFoot(frame[:3, 3], frame[:3, 1])
            self.table, self._provisional = TablePlane(foot, MOVED_DOUBT), True

    def learn(self, camera_from_cube: Array, firm: bool, seconds: float) -> None:
        """Add one frame in which the cube keeps still, `seconds` after the last such frame."""
        if self.table is not None:
            rest = rest_of(camera_from_cube, self._sides, self.table.up)
            if rest is not None and self.table.agrees(rest):
                if firm or self._provisional:
                    self.table.learn(rest, seconds)
                    self._drop_alternative()
                # One firm rest that agrees settles a provisional table for good.
                self._provisional &= not firm
                return
        self._gather(camera_from_cube, firm, seconds)

    def _gather(self, camera_from_cube: Array, firm: bool, seconds: float) -> None:
        rest = rest_of(camera_from_cube, self._sides)
        if rest is None:
            return
        if self._alternative is None or not self._alternative.agrees(rest):
            self._drop_alternative()
            self._alternative = TablePlane(rest)
            # The window of the stillness itself counts only for a first table.
            seconds = 0.0
        self._alternative.learn(rest, seconds)
        self._firm_s += seconds if firm else 0.0
        self._rest_s += seconds
        if self._is_convincing(firm):
            self.table, self._provisional = self._alternative, self._firm_s == 0 and not firm
            self._drop_alternative()

    def _is_convincing(self, firm: bool) -> bool:
        if self.table is None:
            return firm or self._rest_s >= FIRST_TREMBLING_S
        if self._provisional and firm:
            return self._firm_s >= NEXT_FIRM_AFTER_PROVISIONAL_S
        return self._firm_s >= NEXT_FIRM_S or self._rest_s >= NEXT_TREMBLING_S

    def _drop_alternative(self) -> None:
        self._alternative = None
        self._firm_s = self._rest_s = 0.0


def _frame(origin: Array, up: Array) -> Array:
    """Frame of a table, (4, 4): +y up, +z horizontally towards the camera.

    Straight below the camera, where that has no direction, +z points down in the image.
    """
    towards = -origin - up * (-origin @ up)
    # Nearer than 2 cm to the point below the camera its direction is noise.
    if float(np.linalg.norm(towards)) < 0.02:
        towards = np.array([0.0, 1.0, 0.0])
        towards = towards - up * (towards @ up)
    z = towards / np.linalg.norm(towards)
    return se3.pose(np.stack([np.cross(up, z), up, z], axis=1), origin)
