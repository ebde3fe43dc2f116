"""The model of a cube, or of another body: its TOML file, and its markers in space."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any, Self

import cv2
import numpy as np

from cubeling.files import is_there
from cubeling.toml_file import TomlTable, read, toml_kind
from cubeling.tracking.cube.icons import ICON_COLOURS
from cubeling.tracking.cube.sides import (
    FACE_AXES as FACE_AXES,
    SIDE_KEYS,
    Side,
    box_sides,
    measured_corners,
    read_side,
    shared_plane,
)
from cubeling.tracking.errors import TrackingError
from cubeling.tracking.geometry.arrays import Array

CUBE_FILE = toml_kind("cube", TrackingError, "cubeling.tracking.cube.model:CubeModel.load")
"""The file of a cube."""


@dataclass(frozen=True)
class Face:
    """A marker of the cube, and what the side that carries it means.

    A side of a cube usually carries one; of several, each is a face with a name such as "lid/2".
    """

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

    at: tuple[float, float] = (0.0, 0.0)
    """Middle of the marker on its side, right and up from the centre seen from outside [m]."""

    @property
    def side(self) -> str:
        """Name of the side of the body that carries the marker."""
        return side_of(self.name)

    @cached_property
    def normal(self) -> Array:
        """Outward unit normal in the cube frame, (3,), by the measured corners."""
        first, second = self.corners[2] - self.corners[0], self.corners[1] - self.corners[3]
        normal = np.cross(first, second)
        normal /= np.linalg.norm(normal)
        # Exactly the axis where the face is not askew, so recorded sessions replay bit for bit.
        square = np.rint(normal) + 0.0
        return square if np.abs(normal - square).max() < 1e-9 else normal


def side_of(face: str) -> str:
    """Return the name of the side that carries a face's marker.

    >>> side_of("front"), side_of("lid/2")
    ('front', 'lid')
    """
    return face.partition("/")[0]


@dataclass(frozen=True)
class CubeModel:
    """A cube with markers on its faces, or any rigid body of flat sides.

    Its frame: origin in the centre, +y through `top`, +z through `front`, +x through `right`. That
    of a body without these sides is the one of its file, with the origin inside.
    """

    name: str
    """Name of the cube, as printed on its sheet."""

    dictionary: str
    """Name of the OpenCV dictionary, "DICT_4X4_50" …"""

    edge: float
    """Edge of the cube in metres; of another body, that of a cube of about its size: twice the mean
    distance of its sides from the origin."""

    marker_size: float
    """Side of the black square in metres."""

    faces: tuple[Face, ...]
    """The faces that carry a marker."""

    hint: str = ""
    """One sentence for the person who holds the cube, or ""."""

    body: tuple[Side, ...] = ()
    """The sides of a body that is no cube, with and without markers; () for a cube."""

    @classmethod
    def load(cls, name_or_path: str | Path) -> Self:
        """Read a bundled cube or the TOML file of one.

        Parameters
        ----------
        name_or_path
            "locomotion", "companion", or the path of a TOML file. "locomotion-2" is the same cube
            for a second player, with markers of its own.

        Raises
        ------
        TrackingError
            The file is missing, is not TOML, or does not describe a printable cube.
        """
        path = Path(name_or_path)
        if path.suffix == ".toml":
            return cls.from_document(read(path, CUBE_FILE), str(path), path.stem)
        name = str(name_or_path).removesuffix(SECOND)
        path = CUBES_FOLDER / f"{name}.toml"
        if not is_there(path):
            known = ", ".join(bundled_cubes())
            raise TrackingError(
                f"no cube is called '{name_or_path}': choose {known}, or give a .toml file"
            )
        cube = cls.from_document(read(path, CUBE_FILE), str(path), name)
        if name == str(name_or_path):
            return cube
        faces = (replace(each, marker_id=each.marker_id + SECOND_IDS) for each in cube.faces)
        return replace(cube, name=f"{name}{SECOND}", faces=tuple(faces))

    @classmethod
    def from_document(cls, document: dict[str, Any], where: str, name: str) -> Self:
        """Make a cube from the tables of its TOML file. `where` names the file in errors."""
        table = TomlTable(document, where, error=TrackingError)
        table.only(*FILE_KEYS)
        marker = table.number("marker_mm", 1, 1000) / 1000
        capacity = _capacity(table)
        rows = table.rows("face")
        if not rows:
            raise table.wrong("face", "a cube needs at least one [[face]] table")
        sides = _sides(table, rows, marker)
        edge = 2 * float(np.mean([side.height for side in sides]))
        # A cube as it is printed here: its sides follow from its edge.
        plain = "edge_mm" in table and not any({"marker", "at_mm"} & set(row) for row in rows)
        by_name = {side.name: side for side in sides}
        keys = FACE_KEYS if {"edge_mm", "size_mm"} & set(table) else (*FACE_KEYS, *SIDE_KEYS)
        faces = tuple(face for row in rows for face in _faces(row, keys, capacity, marker, by_name))
        if not faces:
            raise table.wrong("face", "none of them has a marker_id")
        cube = cls(
            table.line("name", "") or name,
            table.text("dictionary"),
            edge,
            marker,
            faces,
            table.line("hint", ""),
            () if plain else sides,
        )
        if marker >= cube.paper:
            raise table.wrong(
                "marker_mm",
                f"the marker ({marker * 1000:g} mm) does not fit its face "
                f"({cube.paper * 1000:g} mm); leave a white border of at least one marker cell",
            )
        for key in ("name", "marker_id"):
            values = [getattr(face, key) for face in faces]
            if twice := [value for value in values if values.count(value) > 1]:
                raise table.wrong("face", f"two have the {key} {twice[0]!r}; each must differ")
        return cube

    @property
    def sides(self) -> tuple[Side, ...]:
        """All sides, with and without markers."""
        return self.body or box_sides(self.edge, self.edge, self.edge)

    @cached_property
    def vertices(self) -> Array:
        """Corners of all sides, each once, (N, 3) [m]."""
        return np.unique(np.concatenate([side.corners for side in self.sides]), axis=0)

    @cached_property
    def paper(self) -> float:
        """Side of the square around the middle of each marker that has no other print [m]."""
        return self._least(Side.room) if self.body else self.edge

    @cached_property
    def white(self) -> float:
        """Side of the square around the middle of each marker that is white [m].

        Its corners may lie beyond a side that is no square.
        """
        if not self.body:
            return self.edge
        cells = aruco_dictionary(self.dictionary).markerSize + 2
        most = self.marker_size * (1 + 2 * WHITE_CELLS / cells)
        return max(self.paper, min(self._least(Side.breadth), most))

    def _least(self, room_of: Callable[[Side, tuple[float, float]], float]) -> float:
        """Return the least room of all markers: on their sides, and between those of one side."""
        sides = {side.name: side for side in self.body}
        room = [room_of(sides[face.side], face.at) for face in self.faces]
        for number, one in enumerate(self.faces):
            for other in self.faces[:number]:
                if one.side == other.side:
                    apart = np.abs(np.subtract(one.at, other.at)).max()
                    room.append(2 * float(apart) - self.marker_size)
        return min(room)

    def designed_corners(self, face: Face) -> Array:
        """Where the corners of a face would be on a body without errors, as `Face.corners`."""
        side = next(side for side in self.sides if side.name == face.side)
        return side.square(self.marker_size, face.at, face.roll_deg)

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
        faces = tuple(
            replace(
                face,
                corners=face.corners * factor,
                at=(face.at[0] * factor, face.at[1] * factor),
            )
            for face in self.faces
        )
        body = tuple(side.scale(factor) for side in self.body)
        size = self.marker_size * factor
        return replace(self, edge=edge, marker_size=size, faces=faces, body=body)

    def face(self, name: str) -> Face:
        """Return the face with a name: on a cube, one of `FACE_AXES`.

        Raises
        ------
        KeyError
            No face of the cube with this name has a marker.
        """
        for face in self.faces:
            if face.name == name:
                return face
        raise KeyError(name)


FILE_KEYS = ("name", "hint", "dictionary", "edge_mm", "size_mm", "marker_mm", "face")
"""The keys of a cube's file: a cube has `edge_mm`, a box `size_mm`, any other body neither."""

MARKER_KEYS = ("marker_id", "at_mm", "roll_deg", "corners_mm")
"""The keys of a marker, in its [[face]] table or in one of several [[face.marker]] tables."""

FACE_KEYS = ("name", *MARKER_KEYS, "role", "icon", "marker")
"""The keys of each of its [[face]] tables, besides `SIDE_KEYS` of a body."""

WHITE_CELLS = 1.5
"""How far around a marker the white of a body's side is used [cells], as much as cubes have."""

BORDER_CELLS = 1.0
"""White border around the marker of a side that has no outline [cells]."""

SECOND, SECOND_IDS = "-2", 24
"""What the name of a second player's bundled cube ends with, and by how much its marker ids are
larger: so all bundled cubes differ, and all ids are in their dictionary."""

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
    side = next(side for side in box_sides(edge, edge, edge) if side.name == name)
    return side.square(marker, roll_deg=roll_deg)


def _capacity(table: TomlTable) -> int:
    """Return how many markers a cube's dictionary has."""
    name = table.text("dictionary")
    if not name.startswith("DICT_") or not isinstance(getattr(cv2.aruco, name, None), int):
        raise table.unlike("dictionary", "one of OpenCV's, such as DICT_4X4_50")
    return len(aruco_dictionary(name).bytesList)


def _sides(table: TomlTable, rows: tuple[TomlTable, ...], marker: float) -> tuple[Side, ...]:
    """Return the sides of a cube, a box, or any other body, with or without markers."""
    if "edge_mm" in table and "size_mm" in table:
        raise table.wrong("size_mm", "a cube has edge_mm, a box size_mm, and no body both")
    if "size_mm" in table:
        width, height, depth = (each / 1000 for each in table.numbers("size_mm", 3, 1, 1000))
        return box_sides(width, height, depth)
    if "edge_mm" in table or not any("center_mm" in row for row in rows):
        edge = table.number("edge_mm", 1, 1000) / 1000
        return box_sides(edge, edge, edge)
    cells = aruco_dictionary(table.text("dictionary")).markerSize + 2
    border = marker / 2 * (1 + 2 * BORDER_CELLS / cells)
    sides = []
    for row in rows:
        name = row.line("name")
        if not name or "/" in name:
            raise row.unlike("name", "a name without /")
        sides.append(read_side(row, name, border))
    names = [side.name for side in sides]
    if twice := [name for name in names if names.count(name) > 1]:
        raise table.wrong("face", f"two have the name {twice[0]!r}; each must differ")
    if pair := shared_plane(sides):
        raise table.wrong(
            "face",
            f"'{pair[0]}' and '{pair[1]}' lie in one plane: give one of them both markers, in "
            "[[face.marker]] tables with marker_id and at_mm",
        )
    return tuple(sides)


def _faces(
    table: TomlTable, keys: tuple[str, ...], capacity: int, marker: float, sides: dict[str, Side]
) -> tuple[Face, ...]:
    """Return the markers of one [[face]] table with `keys`; a side that it places may be bare."""
    table.only(*keys)
    name = table.choice("name", sides)
    role, icon = table.line("role", ""), table.choice("icon", ("", *ICON_COLOURS), "")
    rows = table.rows("marker", *MARKER_KEYS)
    if not rows and ("marker_id" in table or "center_mm" not in table):
        rows = (table,)
    faces = []
    for number, row in enumerate(rows, 1):
        roll = int(row.number("roll_deg", default=0))
        if roll not in (0, 90, 180, 270):
            raise row.unlike("roll_deg", "0, 90, 180 or 270")
        x, y = (each / 1000 for each in row.numbers("at_mm", 2, -1000, 1000, default=(0.0, 0.0)))
        corners = sides[name].square(marker, (x, y), roll)
        if "corners_mm" in row:
            corners = measured_corners(row, corners, marker)
        marker_id = row.whole("marker_id", 0, capacity - 1)
        title = name if len(rows) == 1 else f"{name}/{number}"
        faces.append(Face(title, marker_id, corners, role, icon, roll, (x, y)))
    return tuple(faces)
