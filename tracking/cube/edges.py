"""The black and white edges of a cube's markers, as points in space."""

from dataclasses import dataclass

import numpy as np

from tracking.cube.marker import marker_cells
from tracking.cube.model import CubeModel, Face
from tracking.geometry.arrays import Array, Flags, Indices

POINTS_PER_CELL = 5
"""Points along an edge for each cell: 2 to 3 px apart at arm's length, for independent noise."""


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
        """Return the edges of some faces, by their indices."""
        return self._of(np.flatnonzero(np.isin(self.face, faces)))

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
        line = np.unique(keys, axis=0, return_inverse=True)[1].reshape(-1)
        edges = EdgeModel(points, along, across, to_end, outline > 0, numbers, line)
        return edges._of(np.argsort(line, kind="stable"))


def _face_edges(cube: CubeModel, face: Face) -> tuple[Array, ...]:
    white = ~marker_cells(cube.dictionary, face.marker_id)
    cells = np.pad(white, 1, constant_values=True)
    count = len(cells) - 2
    # Vertical edges (between columns), then horizontal ones, in cells from the top left.
    vertical, horizontal = _vertical_edges(cells), _vertical_edges(cells.T)
    flat = np.concatenate([vertical, horizontal[:, [1, 0, 3, 2, 5, 4, 6]]])
    top_left, top_right, _, bottom_left = face.corners
    axes = np.stack([top_right - top_left, bottom_left - top_left]) / count
    points = top_left + flat[:, 0:2] @ axes
    outline = np.isclose(flat[:, :2] % count, 0).any(axis=1)
    return points, flat[:, 2:4] @ axes, flat[:, 4:6] @ axes, flat[:, 6], outline


def _vertical_edges(cells: Flags) -> Array:
    """Place points on the vertical edges of a padded pattern, (N, 7) [cells].

    Position (2), one cell along the edge (2), one across it (2), distance to its nearer end.
    """
    rows = []
    for column in range(1, cells.shape[1]):
        # +1 where white is on the right, −1 where on the left, 0 where there is no edge.
        polarity = cells[:, column].astype(int) - cells[:, column - 1]
        breaks = np.flatnonzero(np.diff(polarity)) + 1
        for run in np.split(np.arange(len(cells)), breaks):
            white = polarity[run[0]]
            if white == 0:
                continue
            places = (np.arange(len(run) * POINTS_PER_CELL) + 0.5) / POINTS_PER_CELL
            for place in places:
                rows.append(
                    (column - 1, run[0] - 1 + place, 0, 1, white, 0, min(place, len(run) - place))
                )
    return np.array(rows, np.float64).reshape(-1, 7)
