"""Measured corners of the markers of a hand-folded cube: `corners_mm` in its file."""

import numpy as np

from cubeling.toml_file import TomlTable
from cubeling.tracking.geometry.arrays import Array

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
