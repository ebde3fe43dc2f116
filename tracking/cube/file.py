"""Writing a cube as the TOML file that `CubeModel.load` reads."""

import json
from pathlib import Path

import numpy as np

from cubeling.files import write_whole
from cubeling.tracking.cube.model import CubeModel, Face, face_corners
from cubeling.tracking.errors import TrackingError


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
    lines = [
        f"name = {_quote(cube.name)}",
        *([f"hint = {_quote(cube.hint)}"] if cube.hint else []),
        f"dictionary = {_quote(cube.dictionary)}",
        f"edge_mm = {cube.edge * 1000:.10g}",
        f"marker_mm = {cube.marker_size * 1000:.10g}",
        *(line for face in cube.faces for line in _face(cube, face)),
    ]
    write_whole(path, "\n".join(lines) + "\n", TrackingError)


def _face(cube: CubeModel, face: Face) -> list[str]:
    lines = ["", "[[face]]", f"name = {_quote(face.name)}", f"marker_id = {face.marker_id}"]
    if face.roll_deg:
        lines.append(f"roll_deg = {face.roll_deg}")
    lines += [
        f"{key} = {_quote(text)}"
        for key, text in (("role", face.role), ("icon", face.icon))
        if text
    ]
    ideal = face_corners(face.name, face.roll_deg, cube.marker_size, cube.edge)
    if np.abs(face.corners - ideal).max() > 1e-9:
        rows = ", ".join(
            "[" + ", ".join(f"{value * 1000:.4f}" for value in corner) + "]"
            for corner in face.corners
        )
        lines.append(f"corners_mm = [{rows}]")
    return lines


def _quote(text: str) -> str:
    # The escapes of JSON strings are those of TOML's basic strings.
    return json.dumps(text, ensure_ascii=False)
