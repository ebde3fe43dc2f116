"""The model of a cube: its TOML file, and its markers in space."""

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Self

import cv2
import numpy as np

from cubeling.toml_file import TomlTable, read, toml_kind
from cubeling.tracking.cube.icons import ICON_COLOURS
from cubeling.tracking.errors import TrackingError
from cubeling.tracking.geometry.arrays import Array

CUBE_FILE = toml_kind("cube", TrackingError, "cubeling.tracking.cube.model:CubeModel.load")
"""The file of a cube."""

FACE_AXES: dict[str, tuple[tuple[int, int, int], tuple[int, int, int]]] = {
    "front": ((1, 0, 0), (0, 1, 0)),
    "right": ((0, 0, -1), (0, 1, 0)),
    "back": ((-1, 0, 0), (0, 1, 0)),
    "left": ((0, 0, 1), (0, 1, 0)),
    "top": ((1, 0, 0), (0, 0, -1)),
    "bottom": ((1, 0, 0), (0, 0, 1)),
}
"""For each face, seen from outside: the directions (right, up) in the cube frame."""


@dataclass(frozen=True)
class Face:
    """One face of the cube and the marker printed on it."""

    name: str

    marker_id: int
    """Id of the marker in the cube's dictionary."""

    corners: Array
    """Corners of the black square in the cube frame, (4, 3) in metres.

    Top-left, top-right, bottom-right, bottom-left of the marker, seen from outside: the ideal ones,
    or those that `cubeling calibrate` measured on the folded cube (`corners_mm`).
    """

    role: str = ""
    """What the face means to a scenario: "idle", "walk", "kiss" … or ""."""

    icon: str = ""
    """Name of the icon printed next to the marker, or ""."""

    roll_deg: int = 0
    """Rotation of the marker on its face: 0, 90, 180 or 270, clockwise seen from outside."""

    @property
    def normal(self) -> Array:
        """Outward unit normal in the cube frame, (3,), by the measured corners."""
        first, second = self.corners[2] - self.corners[0], self.corners[1] - self.corners[3]
        normal = np.cross(first, second)
        normal /= np.linalg.norm(normal)
        # Exactly the axis where the face is not askew, so recorded sessions replay bit for bit.
        square = np.rint(normal) + 0.0
        return square if np.abs(normal - square).max() < 1e-9 else normal


@dataclass(frozen=True)
class CubeModel:
    """A cube with markers on its faces.

    Its frame: origin in the centre, +y through `top`, +z through `front`, +x through `right`.
    """

    name: str
    """Name of the cube, as printed on its sheet."""

    dictionary: str
    """Name of the OpenCV dictionary, "DICT_4X4_50" …"""

    edge: float
    """Edge of the cube in metres."""

    marker_size: float
    """Side of the black square in metres."""

    faces: tuple[Face, ...]
    """The faces that carry a marker."""

    hint: str = ""
    """One sentence for the person who holds the cube, or ""."""

    @classmethod
    def load(cls, name_or_path: str | Path) -> Self:
        """Read a bundled cube or the TOML file of one.

        Parameters
        ----------
        name_or_path
            "locomotion", "companion", or the path of a TOML file.

        Raises
        ------
        TrackingError
            The file is missing, is not TOML, or does not describe a printable cube.
        """
        path = Path(name_or_path)
        if path.suffix != ".toml":
            path = CUBES_FOLDER / f"{name_or_path}.toml"
            if not path.is_file():
                known = ", ".join(bundled_cubes())
                raise TrackingError(
                    f"no cube is called '{name_or_path}': choose {known}, or give a .toml file"
                )
        return cls.from_document(read(path, CUBE_FILE), str(path), path.stem)

    @classmethod
    def from_document(cls, document: dict[str, Any], where: str, name: str) -> Self:
        """Make a cube from the tables of its TOML file. `where` names the file in errors."""
        table = TomlTable(document, where, error=TrackingError)
        table.only(*FILE_KEYS)
        edge_mm, marker_mm = (table.number(key, 1, 1000) for key in ("edge_mm", "marker_mm"))
        if marker_mm >= edge_mm:
            raise table.wrong(
                "marker_mm",
                f"the marker ({marker_mm:g} mm) does not fit its face ({edge_mm:g} mm); "
                "leave a white border of at least one marker cell",
            )
        capacity = _capacity(table)
        rows = table.rows("face")
        if not rows:
            raise table.wrong("face", "a cube needs at least one [[face]] table")
        faces = tuple(_face(row, capacity, marker_mm / 1000, edge_mm / 1000) for row in rows)
        for key in ("name", "marker_id"):
            values = [getattr(face, key) for face in faces]
            if twice := [value for value in values if values.count(value) > 1]:
                raise table.wrong("face", f"two have the {key} {twice[0]!r}; each must differ")
        return cls(
            table.line("name", "") or name,
            table.text("dictionary"),
            edge_mm / 1000,
            marker_mm / 1000,
            faces,
            table.line("hint", ""),
        )

    @property
    def markers(self) -> frozenset[tuple[str, int]]:
        """The dictionary and the id of each marker; cubes that share all cannot be told apart."""
        return frozenset((self.dictionary, face.marker_id) for face in self.faces)

    def scale(self, edge: float) -> Self:
        """Return the same cube in another size, its markers grown or shrunk with it.

        Parameters
        ----------
        edge
            Edge of the new cube [m], 0.01 to 1.

        Raises
        ------
        TrackingError
            The edge is not 10 to 1000 mm.
        """
        if not 0.01 <= edge <= 1:
            raise TrackingError(f"the edge must be 10 to 1000 mm, not {edge * 1000:g} mm")
        factor = edge / self.edge
        faces = tuple(replace(face, corners=face.corners * factor) for face in self.faces)
        return replace(self, edge=edge, marker_size=self.marker_size * factor, faces=faces)

    def face(self, name: str) -> Face:
        """Return the face with a name, one of `FACE_AXES`.

        Raises
        ------
        KeyError
            No face of the cube with this name has a marker.
        """
        for face in self.faces:
            if face.name == name:
                return face
        raise KeyError(name)


FILE_KEYS = ("name", "hint", "dictionary", "edge_mm", "marker_mm", "face")
"""The keys of a cube's file."""

FACE_KEYS = ("name", "marker_id", "roll_deg", "role", "icon", "corners_mm")
"""The keys of each of its [[face]] tables."""

CUBES_FOLDER = Path(__file__).parents[1] / "cubes"


def bundled_cubes() -> tuple[str, ...]:
    """Names of the bundled cubes."""
    return tuple(sorted(path.stem for path in CUBES_FOLDER.glob("*.toml")))


def aruco_dictionary(name: str) -> cv2.aruco.Dictionary:
    """Return OpenCV's dictionary of that name, ("DICT_4X4_50" …)."""
    number: int = getattr(cv2.aruco, name)
    return cv2.aruco.getPredefinedDictionary(number)


def face_corners(name: str, roll_deg: int, marker: float, edge: float) -> Array:
    """Corners of a marker in the cube frame, (4, 3), in the order of `Face.corners`.

    >>> face_corners("front", 0, 0.04, 0.06)[0].tolist()
    [-0.02, 0.02, 0.03]
    >>> face_corners("front", 90, 0.04, 0.06)[0].tolist()
    [0.02, 0.02, 0.03]
    """
    right, up = (np.array(axis, float) for axis in FACE_AXES[name])
    square = np.array([(-1, 1), (1, 1), (1, -1), (-1, -1)]) * (marker / 2)
    square = np.roll(square, -(roll_deg // 90), axis=0)
    corners = square[:, :1] * right + square[:, 1:] * up + np.cross(right, up) * (edge / 2)
    return np.asarray(corners, np.float64)


def _capacity(table: TomlTable) -> int:
    """Return how many markers a cube's dictionary has."""
    name = table.text("dictionary")
    if not name.startswith("DICT_") or not isinstance(getattr(cv2.aruco, name, None), int):
        raise table.unlike("dictionary", "one of OpenCV's, such as DICT_4X4_50")
    return len(aruco_dictionary(name).bytesList)


def _face(table: TomlTable, capacity: int, marker: float, edge: float) -> Face:
    table.only(*FACE_KEYS)
    name, icon = table.choice("name", FACE_AXES), table.choice("icon", ("", *ICON_COLOURS), "")
    roll = int(table.number("roll_deg", default=0))
    if roll not in (0, 90, 180, 270):
        raise table.unlike("roll_deg", "0, 90, 180 or 270")
    corners = face_corners(name, roll, marker, edge)
    if "corners_mm" in table:
        corners = measured_corners(table, corners, marker)
    marker_id = table.whole("marker_id", 0, capacity - 1)
    return Face(name, marker_id, corners, table.line("role", ""), icon, roll)


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
