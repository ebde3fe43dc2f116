"""Quadric errors of what varies over a surface: its shape, and values at its vertices.

The quadric of Garland and Heckbert ("Surface simplification using quadric error metrics", SIGGRAPH
1997) with the terms of Hoppe for the values ("New quadric metric for simplifying meshes with
appearance attributes", Visualization 1999): on a triangle, a value is a linear function of the
position, and its error is the difference from that function. The error of a vertex is the sum of
products of its coefficients and of the terms of the vertex that takes its place.
"""

import numpy as np
from numpy.typing import NDArray

Indices = NDArray[np.intp]
Floats = NDArray[np.float64]
Coefficients = NDArray[np.float32]

BORDER_WEIGHT = 4.0
"""Weight of the distance from a border, or from a seam of colours, over that from the surface."""


def triangle_normals(corners: Floats) -> Floats:
    """Return the normals of triangles (n, 3, 3), twice as long as their areas."""
    return np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])


def error_terms(positions: Floats, features: Floats) -> Coefficients:
    """Return the products of the coordinates that quadrics weight, (vertices, terms)."""
    x, y, z = positions.T
    squares = np.stack([x * x, y * y, z * z, 2 * x * y, 2 * y * z, 2 * z * x], axis=1)
    crossed = [-2.0 * feature[:, None] * np.column_stack([positions, np.ones(len(x))])
               for feature in features.T]  # fmt: skip
    constant = np.column_stack([np.ones(len(x)), (features**2).sum(axis=1)])
    return np.hstack([squares, 2.0 * positions, *crossed, constant], dtype=np.float32)


def _plane_terms(planes: Floats) -> Floats:
    """Return the coefficients of the squares of linear functions (n, 4), (n, 10)."""
    a, b, c, d = planes.T
    return np.stack([a * a, b * b, c * c, a * b, b * c, c * a, a * d, b * d, c * d, d * d], axis=1)


def vertex_quadrics(positions: Floats, features: Floats, triangles: Indices) -> Coefficients:
    """Return the quadric of each vertex, (vertices, terms), the last column its area [m²]."""
    corners = positions[triangles]
    normals = triangle_normals(corners)
    double = np.linalg.norm(normals, axis=1, keepdims=True)
    area = double / 6.0  # a third for each corner
    unit = normals / np.maximum(double, 1e-20)
    plane = np.column_stack([unit, -np.einsum("ij,ij->i", unit, corners[:, 0])])
    sums = _plane_terms(plane)
    crossed = []
    first, second = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    # The in-plane vectors whose products with both sides are 1 and 0, or 0 and 1.
    along = np.cross(second, unit) / np.maximum(double, 1e-12)
    across = np.cross(unit, first) / np.maximum(double, 1e-12)
    for feature in features.T:
        start, one, two = feature[triangles].T
        slope = (one - start)[:, None] * along + (two - start)[:, None] * across
        function = np.column_stack([slope, start - np.einsum("ij,ij->i", slope, corners[:, 0])])
        sums = sums + _plane_terms(function)
        crossed.append(function)
    terms = np.hstack([sums[:, :9], *crossed, sums[:, 9:], np.ones_like(area)], dtype=np.float32)
    terms *= area.astype(np.float32)
    borders, border_vertices = _border_planes(corners, unit, triangles)
    found = np.zeros((len(positions), terms.shape[1]), np.float32)
    for corner in range(3):
        _add(found, triangles[:, corner], terms)
    plane_terms = np.zeros((len(borders), terms.shape[1]), np.float32)
    squares = _plane_terms(borders)
    plane_terms[:, :9], plane_terms[:, -2] = squares[:, :9], squares[:, 9]
    for end in border_vertices.T:
        _add(found, end, plane_terms)
    return found


def _add(sums: Coefficients, rows: Indices, terms: Coefficients) -> None:
    """Add terms (n, k) to rows of sums; `numpy.add.at` takes three times as long."""
    order = np.argsort(rows, kind="stable")
    starts = np.flatnonzero(np.diff(rows[order], prepend=-1))
    if len(starts):
        sums[rows[order][starts]] += np.add.reduceat(terms[order], starts, axis=0)


def _border_planes(corners: Floats, unit: Floats, triangles: Indices) -> tuple[Floats, Indices]:
    """Return weighted planes (n, 4) through edges of one triangle, across it, and their vertices.

    Along a seam, each side has vertices, and so triangles, of its own.
    """
    ends = np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=-1).reshape(-1, 2)
    keys = np.sort(ends, axis=1) @ [int(triangles.max(initial=0)) + 1, 1]
    _, first, uses = np.unique(keys, return_index=True, return_counts=True)
    alone = first[uses == 1]
    along = (np.roll(corners, -1, axis=1) - corners).reshape(-1, 3)[alone]
    origin = corners.reshape(-1, 3)[alone]
    across = np.cross(along, np.repeat(unit, 3, axis=0)[alone])
    # |across| is the length of the edge: the square of the plane is weighted with its square.
    planes = np.column_stack([across, -np.einsum("ij,ij->i", across, origin)])
    return np.sqrt(BORDER_WEIGHT / 2.0) * planes, ends[alone]
