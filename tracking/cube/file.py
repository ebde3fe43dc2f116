"""Writing a cube as the TOML file that `CubeModel.load` reads."""

import json
import os
from pathlib import Path

import numpy as np

from tracking.cube.model import CubeModel, Face, face_corners
from tracking.errors import TrackingError


def write_cube(cube: CubeModel, path: str | Path) -> None:
    """Write a cube, with the measured corners of the faces that are not where they should be.

    The file appears whole or not at all.

    Raises
    ------
    TrackingError
        The path does not end in .toml, or nothing can be written there.
    """
    target = Path(path)
    if target.suffix != ".toml":
        raise TrackingError(f"a cube is kept in a .toml file, not in '{path}'")
    lines = [
        f"name = {_quoted(cube.name)}",
        *([f"hint = {_quoted(cube.hint)}"] if cube.hint else []),
        f"dictionary = {_quoted(cube.dictionary)}",
        f"edge_mm = {cube.edge * 1000:.10g}",
        f"marker_mm = {cube.marker_size * 1000:.10g}",
        *(line for face in cube.faces for line in _face(cube, face)),
    ]
    partial = target.with_name(target.name + ".partial")
    try:
        partial.write_text("\n".join(lines) + "\n", encoding="utf-8")
        os.replace(partial, target)
    except OSError as error:
        partial.unlink(missing_ok=True)
        raise TrackingError(f"cannot write the cube '{path}': {error.strerror}") from error


def _face(cube: CubeModel, face: Face) -> list[str]:
    lines = ["", "[[face]]", f"name = {_quoted(face.name)}", f"marker_id = {face.marker_id}"]
    if face.roll_deg:
        lines.append(f"roll_deg = {face.roll_deg}")
    lines += [
        f"{key} = {_quoted(text)}"
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


def _quoted(text: str) -> str:
    # What JSON escapes, TOML's basic strings escape alike.
    return json.dumps(text, ensure_ascii=False)
