"""The flat sides of a body, by their names or as a file places them, and the markers on them."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from cubeling.toml_file import TomlTable
from cubeling.tracking.geometry.arrays import Array

FACE_AXES: dict[str, tuple[tuple[int, int, int], tuple[int, int, int]]] = {
    "front": ((1, 0, 0), (0, 1, 0)),
    "right": ((0, 0, -1), (0, 1, 0)),
    "back": ((-1, 0, 0), (0, 1, 0)),
    "left": ((0, 0, 1), (0, 1, 0)),
    "top": ((1, 0, 0), (0, 0, -1)),
    "bottom": ((1, 0, 0), (0, 0, 1)),
}
"""For each face of a cube, seen from outside: the directions (right, up) in the cube frame."""

SIDE_KEYS = ("center_mm", "normal", "up", "outline_mm")
"""The keys of a [[face]] table that place a side of a body that is neither cube nor box."""

MAX_REACH_MM = 1000.0
"""No coordinate of a body is greater."""

MIN_UP_SINE = 0.1
"""The direction `up` of a side is at least so far from its normal, as a sine."""

SAME_PLANE_COSINE, SAME_PLANE_M = np.cos(np.deg2rad(2)), 0.001
"""Two sides whose normals and planes are closer than this lie in one plane."""


@dataclass(frozen=True)
class Side:
    """One flat side of a body."""

    name: str

    cube_from_side: Array
    """Frame of the side, (4, 4) [m]: origin in its centre; seen from outside, x points right, y up
    and z to the viewer."""

    outline: Array
    """Its corners in that frame, (N, 2) [m], counter-clockwise seen from outside, convex."""

    @property
    def normal(self) -> Array:
        """Outward unit normal, (3,)."""
        return self.cube_from_side[:3, 2]

    @property
    def corners(self) -> Array:
        """Corners of the outline in the cube frame, (N, 3) [m]."""
        return np.asarray(
            self.outline @ self.cube_from_side[:3, :2].T + self.cube_from_side[:3, 3], np.float64
        )

    @property
    def height(self) -> float:
        """Distance of its plane from the origin [m]."""
        return float(self.normal @ self.cube_from_side[:3, 3])

    def square(
        self, marker: float, at: tuple[float, float] = (0.0, 0.0), roll_deg: int = 0
    ) -> Array:
        """Corners of a marker in the cube frame, (4, 3) [m], in the order of `Face.corners`.

        Parameters
        ----------
        marker
            Side of its black square [m].
        at
            Its middle in the frame of the side [m].
        roll_deg
            Its rotation, 0, 90, 180 or 270, clockwise seen from outside.
        """
        square = np.array([(-1, 1), (1, 1), (1, -1), (-1, -1)]) * (marker / 2)
        square = np.roll(square, -(roll_deg // 90), axis=0) + at
        right, up, _, centre = self.cube_from_side[:3].T
        return np.asarray(square[:, :1] * right + square[:, 1:] * up + centre, np.float64)

    def room(self, at: tuple[float, float]) -> float:
        """Side of the largest square about a place on the side that does not leave it [m].

        Its sides are parallel to the axes of the side; negative where the place is outside.
        """
        inward, depths = self._depths(at)
        return 2 * float((depths / np.abs(inward).sum(axis=1)).min())

    def breadth(self, at: tuple[float, float]) -> float:
        """Diameter of the largest circle about a place on the side that does not leave it [m]."""
        return 2 * float(self._depths(at)[1].min())

    def _depths(self, at: tuple[float, float]) -> tuple[Array, Array]:
        """Inward unit normals of the edges, (N, 2), and how far inside of each a place is [m]."""
        edges = np.roll(self.outline, -1, axis=0) - self.outline
        # Inward, as the outline runs counter-clockwise.
        inward = np.stack([-edges[:, 1], edges[:, 0]], axis=1)
        inward /= np.linalg.norm(inward, axis=1, keepdims=True)
        return inward, ((np.asarray(at) - self.outline) * inward).sum(axis=1)

    def scale(self, factor: float) -> Self:
        """Return the same side of a body in another size."""
        frame = self.cube_from_side.copy()
        frame[:3, 3] *= factor
        return replace(self, cube_from_side=frame, outline=self.outline * factor)


def box_sides(width: float, height: float, depth: float) -> tuple[Side, ...]:
    """Sides of a box in the order of `FACE_AXES`, by its size along x, y and z [m].

    >>> [side.name for side in box_sides(0.06, 0.06, 0.06)][:2]
    ['front', 'right']
    """
    half, sides = np.array([width, height, depth]) / 2, []
    for name, axes in FACE_AXES.items():
        right, up, normal = (np.asarray(axis, np.float64) for axis in (*axes, np.cross(*axes)))
        frame = np.eye(4)
        frame[:3] = np.stack([right, up, normal, normal * half], axis=1)
        across, along = float(np.abs(right) @ half), float(np.abs(up) @ half)
        outline = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) * (across, along)
        sides.append(Side(name, frame, outline))
    return tuple(sides)


def read_side(table: TomlTable, name: str, border: float) -> Side:
    """Read a side of any body from its [[face]] table.

    Parameters
    ----------
    table
        With `SIDE_KEYS`; without `up` it is that of a cube's side, and without `outline_mm` the
        outline is a square.
    name
        The name of the side.
    border
        Half the side of that square [m].

    Raises
    ------
    TrackingError
        If they do not describe a side of a body around the origin; it names file and key.
    """
    reach = (-MAX_REACH_MM, MAX_REACH_MM)
    centre, normal = (np.array(table.numbers(key, 3, *reach)) for key in ("center_mm", "normal"))
    length = float(np.linalg.norm(normal))
    if length == 0:
        raise table.wrong("normal", "it has no direction")
    normal /= length
    level = (0.0, 0.0, -float(np.sign(normal[1]))) if abs(normal[1]) > 0.99 else (0.0, 1.0, 0.0)
    up = np.array(table.numbers("up", 3, *reach, default=level))
    flat = up - normal * (normal @ up)
    if np.linalg.norm(flat) <= MIN_UP_SINE * np.linalg.norm(up):
        raise table.wrong("up", "it points where the normal does")
    flat /= np.linalg.norm(flat)
    if normal @ centre <= 0:
        raise table.wrong("normal", "it must point away from the origin, which is in the body")
    frame = np.eye(4)
    frame[:3] = np.stack([np.cross(flat, normal), flat, normal, centre / 1000], axis=1)
    outline = border * np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)], np.float64)
    if "outline_mm" in table:
        outline = _outline(table)
    return Side(name, frame, outline)


def _outline(table: TomlTable) -> Array:
    rows = table.list("outline_mm", "corners")
    wanted = "at least 3 corners of 2 numbers each, right and up from the centre"
    try:
        outline = np.array(rows, np.float64) / 1000
    except (TypeError, ValueError, OverflowError):
        outline = np.empty(0)
    if outline.ndim != 2 or outline.shape[1] != 2 or len(outline) < 3:
        raise table.unlike("outline_mm", wanted)
    if not (np.abs(outline) <= MAX_REACH_MM / 1000).all():  # NaN is refused, too
        raise table.unlike("outline_mm", wanted)
    edges = np.roll(outline, -1, axis=0) - outline
    after = np.roll(edges, -1, axis=0)
    turns = edges[:, 0] * after[:, 1] - edges[:, 1] * after[:, 0]
    directions = np.unwrap(np.arctan2(edges[:, 1], edges[:, 0]), period=2 * np.pi)
    around = directions[-1] - directions[0] < 2 * np.pi
    if not ((turns > 0).all() and around):
        raise table.wrong("outline_mm", "it must be convex, counter-clockwise seen from outside")
    return outline


def shared_plane(sides: Sequence[Side]) -> tuple[str, str] | None:
    """Return the names of two sides that lie in one plane, if any do."""
    for number, one in enumerate(sides):
        for other in sides[:number]:
            apart = abs(one.height - other.height)
            if one.normal @ other.normal > SAME_PLANE_COSINE and apart < SAME_PLANE_M:
                return other.name, one.name
    return None


class SideDirections:
    """Which side of a body is up, and how high the body stands on what is opposite.

    A body that stands on a side to which none is parallel has a direction of its own for that.
    """

    def __init__(self, sides: Sequence[Side]) -> None:
        normals = [side.normal for side in sides]
        names, heights = [side.name for side in sides], [side.height for side in sides]
        for side in sides:
            if not any(side.normal @ other.normal < -SAME_PLANE_COSINE for other in sides):
                names.append(f"on {side.name}")
                normals.append(-side.normal)
        corners = np.concatenate([side.corners for side in sides])
        self.normals = dict(zip(names, normals, strict=True))
        """Direction of each name in the cube frame, (3,)."""
        self.all_normals = np.stack(normals)
        """All of them, (D, 3)."""
        self.depths = -(corners @ self.all_normals.T).min(axis=0)
        """How high the origin is where the direction is up, (D,) [m]."""
        tops = (corners @ self.all_normals.T).max(axis=0)
        self.heights = np.concatenate([heights, tops[len(heights) :]])
        """How much higher the uppermost side is than the origin, (D,) [m]."""


MAX_DISTORTION = 0.02
"""A marker is a square to this share of its side."""

MAX_DISPLACEMENT = 0.15
"""No corner is displaced by more than this share of the marker's side."""


def measured_corners(table: TomlTable, ideal: Array, marker: float) -> Array:
    """Return the corners of a face's table in the cube frame, 4 of 3 numbers [mm] → (4, 3) [m].

    They must be those of a square with the side `marker` [m] near the `ideal` ones, (4, 3) [m].

    Raises
    ------
    TrackingError
        If they are not; it names file and key.
    """
    try:
        corners = np.array(table.value("corners_mm"), np.float64) / 1000
    except (TypeError, ValueError, OverflowError):
        corners = np.empty(0)
    if corners.shape != (4, 3) or not np.isfinite(corners).all():
        raise table.unlike("corners_mm", "4 corners of 3 numbers each")
    spans, right = (np.linalg.norm(c[:, None] - c, axis=2) for c in (corners, ideal))
    warp = np.linalg.norm(corners[0] - corners[1] + corners[2] - corners[3])
    if max(np.abs(spans - right).max(), warp) > MAX_DISTORTION * marker:
        raise table.wrong("corners_mm", f"no square of {marker * 1000:g} mm, the marker_mm")
    away = float(np.linalg.norm(corners - ideal, axis=1).max())
    if away > MAX_DISPLACEMENT * marker:
        raise table.wrong(
            "corners_mm",
            f"{away * 1000:.1f} mm from where the marker should be; "
            "check their order (top-left, top-right, bottom-right, bottom-left) and roll_deg",
        )
    return corners
