"""The black and white edges of a cube's markers, as points in space."""

import itertools
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from cubeling.tracking.cube.marker import marker_cells
from cubeling.tracking.cube.model import CubeModel, Face
from cubeling.tracking.geometry.arrays import Array, Flags, Indices

POINTS_PER_CELL, STRIDE = 15, 3
"""Points along an edge for each cell: a pixel apart at arm's length. Of two and more faces, which
tell their lean more surely than one, every third point is enough."""


@dataclass(frozen=True)
class EdgeModel:
    """Points on every border between black and white of every marker, outer and inner ones.

    All arrays have the same length N.
    """

    points: Array
    """Points in the cube frame, (N, 3) [m]."""

    along: Array
    """Vector along the edge, one cell long, (N, 3) [m]."""

    across: Array
    """Vector across the edge from black to white, one cell long, (N, 3) [m]."""

    to_end: Array
    """Distance along the edge to its nearer end, (N,) [cells]."""

    outline: Flags
    """Whether the edge is the outer border of its marker, with white paper on one side, (N,)."""

    face: Indices
    """Index of the face in `CubeModel.faces`, (N,)."""

    line: Indices
    """Index of the straight line of the edge, with white on one side of it, (N,), ascending."""

    def of_faces(self, faces: tuple[int, ...]) -> "EdgeModel":
        """Return the edges of some faces, by their indices; with fewer points where these share."""
        found = np.flatnonzero(np.isin(self.face, faces))
        return self._of(found if len(faces) == 1 else found[STRIDE // 2 :: STRIDE])

    def _of(self, chosen: Indices) -> "EdgeModel":
        return EdgeModel(
            points=self.points[chosen],
            along=self.along[chosen],
            across=self.across[chosen],
            to_end=self.to_end[chosen],
            outline=self.outline[chosen],
            face=self.face[chosen],
            line=self.line[chosen],
        )

    @classmethod
    def of(cls, cube: CubeModel) -> "EdgeModel":
        """Place points on the edges of a cube."""
        parts = [_face_edges(cube, face) for face in cube.faces]
        points, along, across, to_end, outline = (
            np.concatenate(columns) for columns in zip(*parts, strict=True)
        )
        numbers = np.repeat(np.arange(len(parts)), [len(part[0]) for part in parts])
        # Within a face, a line is identified by the direction of its white side and its distance.
        places = np.einsum("ij,ij->i", points, across)
        keys = np.column_stack([numbers, np.round(np.column_stack([across, places]), 9)])
        order = np.lexsort(keys.T[::-1])  # by face first; it keeps the order within a line
        begins = np.any(np.diff(keys[order], axis=0) != 0, axis=1)
        line = np.empty(len(order), np.intp)
        line[order] = np.concatenate([[0], np.cumsum(begins)])
        edges = EdgeModel(points, along, across, to_end, outline, numbers, line)
        return edges._of(order)


def _face_edges(cube: CubeModel, face: Face) -> tuple[Array, Array, Array, Array, Flags]:
    flat, count = _marker_edges(cube.dictionary, face.marker_id)
    top_left, top_right, _, bottom_left = face.corners
    axes = np.stack([top_right - top_left, bottom_left - top_left]) / count
    points = top_left + flat[:, 0:2] @ axes
    outline = np.asarray(np.isclose(flat[:, :2] % count, 0).any(axis=1))
    return points, flat[:, 2:4] @ axes, flat[:, 4:6] @ axes, flat[:, 6], outline


@lru_cache(maxsize=64)
def _marker_edges(dictionary: str, marker_id: int) -> tuple[Array, int]:
    """Return the points on the edges of a marker, and how many cells it has along a side.

    They are kept, as the print is measured by cubes whose markers have several sizes.
    """
    cells = marker_cells(dictionary, marker_id)
    return edge_points(cells, POINTS_PER_CELL), len(cells)


def edge_points(cells: Flags, per_cell: int) -> Array:
    """Place points on the edges of a marker with these black cells, (N, 8) [cells].

    From the top left, x right and y down: position (2), one cell along the edge (2), one across it
    from black to white (2), distance to its nearer end, and index of the edge.
    """
    white = np.pad(~cells, 1, constant_values=True)
    # Vertical edges (between columns), then horizontal ones.
    vertical, horizontal = _vertical_edges(white, per_cell), _vertical_edges(white.T, per_cell)
    points = np.concatenate([vertical, horizontal[:, [1, 0, 3, 2, 5, 4, 6, 7]]])
    points[len(vertical) :, 7] += vertical[:, 7].max() + 1
    return points


def _vertical_edges(white: Flags, per_cell: int) -> Array:
    parts: list[Array] = []
    for column in range(1, white.shape[1]):
        # +1 where white is on the right, −1 where on the left, 0 where there is no edge.
        polarity = white[:, column].astype(int) - white[:, column - 1]
        bounds = [0, *(np.flatnonzero(np.diff(polarity)) + 1), len(white)]
        for first, end in itertools.pairwise(bounds):
            if polarity[first] == 0:
                continue
            length = int(end - first)
            places = (np.arange(length * per_cell) + 0.5) / per_cell
            points = np.zeros((len(places), 8))
            points[:, 0] = column - 1
            points[:, 1] = first - 1 + places
            points[:, 3] = 1
            points[:, 4] = polarity[first]
            points[:, 6] = np.minimum(places, length - places)
            points[:, 7] = len(parts)
            parts.append(points)
    return np.concatenate(parts)
