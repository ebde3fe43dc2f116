"""What a picture is about, and where it is seen: the cube with the hand, and the character."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from cubeling.app.pipeline.cube_window import Interior
from cubeling.app.pipeline.step import Rect
from cubeling.app.pipeline.table.props import PosedBody
from cubeling.tracking import CubeState

HAND_EDGES = 0.6
"""How far a hand reaches around the cube, in edges of it."""

MIN_DEPTH_M = 0.05
"""Points nearer to the camera than this are not projected."""

Array = NDArray[np.float64]


def picture_regions(
    cubes: Sequence[tuple[CubeState, float]],
    table: Array | None,
    cast: Sequence[PosedBody],
    interior: Interior | None,
    matrix: Array,
) -> tuple[tuple[Rect, ...], tuple[Rect | None, ...]]:
    """Return where the cubes, and each of the characters on the table are seen [px].

    `cubes` are those of the players with their edges [m], `table` is `camera_from_table`,
    `cast` is first who may be in the cube, then all others; `matrix` is the camera's, (3, 3) [px],
    and `interior` what is seen in the cube, None for a closed one.
    """
    regions: list[Rect | None] = []
    for state, edge in cubes:
        if state.camera_from_cube is not None:
            regions.append(_cube_region(state.camera_from_cube, edge, matrix))
    inside = interior is not None and interior.left_on_table <= 0.0
    figures = tuple(
        _region(table @ body.posed.table_from_character, body.bounds, matrix)
        if table is not None and body.posed.visible and not (inside and number == 0)
        else None
        for number, body in enumerate(cast)
    )
    return tuple(region for region in regions if region is not None), figures


def _cube_region(camera_from_cube: Array, edge: float, matrix: Array) -> Rect | None:
    """Return where a cube and the hand that holds it are seen [px]; None behind the camera."""
    reach = edge * (0.5 + HAND_EDGES)
    return _region(camera_from_cube, np.array([[-reach] * 3, [reach] * 3]), matrix)


def _region(camera_from_box: Array, bounds: Array, matrix: Array) -> Rect | None:
    """Return the rectangle around a box, lowest and highest corner (2, 3) [m], in the picture."""
    corners = np.stack(np.meshgrid(*bounds.T, indexing="ij"), axis=-1).reshape(-1, 3)
    points = corners @ camera_from_box[:3, :3].T + camera_from_box[:3, 3]
    if points[:, 2].min() < MIN_DEPTH_M:
        return None
    pixels = (points @ matrix.T)[:, :2] / points[:, 2:]
    (left, top), (right, bottom) = pixels.min(axis=0).tolist(), pixels.max(axis=0).tolist()
    return left, top, right, bottom
