"""Writing a cube as the TOML file that `CubeModel.load` reads."""

import json
from pathlib import Path

import numpy as np

from cubeling.files import write_whole
from cubeling.tracking.cube.model import CubeModel, Face
from cubeling.tracking.cube.sides import Side
from cubeling.tracking.errors import TrackingError
from cubeling.tracking.geometry.arrays import Array


def write_cube(cube: CubeModel, path: str | Path) -> None:
    """Write a cube as the TOML file that `CubeModel.load` reads.

    Parameters
    ----------
    cube
        The cube; corners of markers that are off their ideal places are written, too.
    path
        The file, which must end in .toml; it is written completely or not at all.

    Raises
    ------
    TrackingError
        The path does not end in .toml, or cannot be written.
    """
    if Path(path).suffix != ".toml":
        raise TrackingError(f"a cube is written to a .toml file, not to '{path}'")
    size = [] if cube.body else [f"edge_mm = {cube.edge * 1000:.10g}"]
    lines = [
        f"name = {_quote(cube.name)}",
        *([f"hint = {_quote(cube.hint)}"] if cube.hint else []),
        f"dictionary = {_quote(cube.dictionary)}",
        *size,
        f"marker_mm = {cube.marker_size * 1000:.10g}",
    ]
    placed = {side.name: _side(side) for side in cube.body}
    for name in placed or dict.fromkeys(face.side for face in cube.faces):
        faces = [face for face in cube.faces if face.side == name]
        lines += ["", "[[face]]", f"name = {_quote(name)}", *placed.get(name, [])]
        lines += (
            [
                f"{key} = {_quote(text)}"
                for key, text in (("role", faces[0].role), ("icon", faces[0].icon))
                if text
            ]
            if faces
            else []
        )
        for face in faces:
            if len(faces) > 1:
                lines += ["", "[[face.marker]]"]
            lines += _marker(cube, face)
    write_whole(path, "\n".join(lines) + "\n", TrackingError)


def _side(side: Side) -> list[str]:
    centre, normal, up = (side.cube_from_side[:3, column] for column in (3, 2, 1))
    return [
        f"center_mm = {_numbers(centre * 1000)}",
        f"normal = {_numbers(normal, 9)}",
        f"up = {_numbers(up, 9)}",
        f"outline_mm = {_rows(side.outline)}",
    ]


def _marker(cube: CubeModel, face: Face) -> list[str]:
    lines = [f"marker_id = {face.marker_id}"]
    if face.at != (0.0, 0.0):
        lines.append(f"at_mm = {_numbers(np.array(face.at) * 1000)}")
    if face.roll_deg:
        lines.append(f"roll_deg = {face.roll_deg}")
    if np.abs(face.corners - cube.designed_corners(face)).max() > 1e-9:
        lines.append(f"corners_mm = {_rows(face.corners)}")
    return lines


def _rows(points: Array) -> str:
    """Return points [m] as rows of millimetres."""
    return f"[{', '.join(_numbers(point * 1000) for point in points)}]"


def _numbers(values: Array, digits: int = 4) -> str:
    return f"[{', '.join(f'{value:.{digits}f}' for value in values)}]"


def _quote(text: str) -> str:
    # The escapes of JSON strings are those of TOML's basic strings.
    return json.dumps(text, ensure_ascii=False)
