"""From a signed distance function to an even, watertight triangle mesh."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Field = Callable[[Array], Array]


def polygonise(
    field: Field, low: Array, high: Array, cell: float, relax: int = 6
) -> tuple[Array, NDArray[np.int64]]:
    """Return vertices (n, 3) and counter-clockwise triangles (m, 3) of the zero set.

    Surface nets (Gibson 1998) give the topology. Vertices then move along the surface to the mean
    of their neighbours and are projected back, which makes the triangles even.

    Parameters
    ----------
    field : signed distance of points (n, 3), negative inside
    low, high : corners of a box that holds the whole surface, (3,) [m]
    cell : edge of a grid cell [m], about the edge of a triangle
    relax : rounds of relaxation
    """
    size = np.ceil((high - low) / cell).astype(int) + 3
    axes = [low[i] + cell * (np.arange(size[i]) - 1.0) for i in range(3)]
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    values = field(grid.reshape(-1, 3)).reshape(size)
    points, quads = _surface_nets(values)
    points = project(field, low - cell + cell * points, cell)
    for _ in range(relax):
        points += 0.5 * _tangential(field, points, neighbour_mean(points, quads) - points, cell)
        points = project(field, points, cell)
    return points, _split(points, quads)


def gradient(field: Field, points: Array, step: float) -> Array:
    """Return the central-difference gradient, (n, 3)."""
    offsets = step * np.eye(3)
    return np.stack([field(points + o) - field(points - o) for o in offsets], -1) / (2 * step)


def project(field: Field, points: Array, cell: float, rounds: int = 3) -> Array:
    """Return the points moved onto the surface by Newton steps of at most half a cell."""
    for _ in range(rounds):
        slope = gradient(field, points, 0.05 * cell)
        steep = np.maximum(np.sum(slope * slope, axis=1), 1e-6)
        step = slope * (field(points) / steep)[:, None]
        length = np.linalg.norm(step, axis=1, keepdims=True)
        points = points - step * np.minimum(1.0, 0.5 * cell / np.maximum(length, 1e-12))
    return points


def normals_of(field: Field, points: Array, cell: float) -> Array:
    """Return unit normals from the gradient, (n, 3)."""
    slope = gradient(field, points, 0.2 * cell)
    return np.asarray(slope / np.maximum(np.linalg.norm(slope, axis=1, keepdims=True), 1e-12))


def neighbour_mean(values: Array, faces: NDArray[np.int64]) -> Array:
    """Return the mean over the neighbours along the edges of polygons, (n, …)."""
    start, end = faces.ravel(), np.roll(faces, -1, axis=1).ravel()
    source, target = np.concatenate([start, end]), np.concatenate([end, start])
    count = np.bincount(target, minlength=len(values))[:, None]
    flat = values.reshape(len(values), -1)
    total = np.stack(
        [np.bincount(target, column[source], minlength=len(values)) for column in flat.T], -1
    )
    return np.asarray((total / np.maximum(count, 1)).reshape(values.shape))


def _surface_nets(values: Array) -> tuple[Array, NDArray[np.int64]]:
    """Return a vertex for each mixed cell, in grid units, and a quad for each crossed edge."""
    cells = tuple(n - 1 for n in values.shape)
    total, count = np.zeros((int(np.prod(cells)), 3)), np.zeros(int(np.prod(cells)))
    quads = []
    for axis in range(3):
        a = np.take(values, range(cells[axis]), axis)
        b = np.take(values, range(1, cells[axis] + 1), axis)
        edge = np.argwhere((a < 0) != (b < 0))
        va, vb = a[tuple(edge.T)], b[tuple(edge.T)]
        unit = np.eye(3, dtype=int)
        u, w = unit[(axis + 1) % 3], unit[(axis + 2) % 3]
        crossing = edge + (va / (va - vb))[:, None] * unit[axis]
        around = [edge - u - w, edge - w, edge, edge - u]  # counter-clockwise about the axis
        quad = np.stack([np.ravel_multi_index(tuple(c.T), cells) for c in around], axis=1)
        np.add.at(total, quad.ravel(), np.repeat(crossing, 4, axis=0))
        np.add.at(count, quad.ravel(), 1.0)
        quads.append(np.where((va < 0)[:, None], quad, quad[:, ::-1]))
    used = np.flatnonzero(count)
    number = np.zeros(len(count), dtype=np.int64)
    number[used] = np.arange(len(used))
    return total[used] / count[used, None], number[np.concatenate(quads)]


def _tangential(field: Field, points: Array, move: Array, cell: float) -> Array:
    normal = normals_of(field, points, cell)
    return np.asarray(move - normal * np.sum(move * normal, axis=1, keepdims=True))


def _split(points: Array, quads: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return the triangles of quads split along their shorter diagonals."""
    p = points[quads]
    ac, bd = (np.linalg.norm(p[:, i] - p[:, i + 2], axis=1) for i in (0, 1))
    first = ac < bd + 1e-6  # the same for equal diagonals on every machine
    a, b, c, d = quads.T
    along_ac = np.stack([a, b, c, a, c, d], axis=1)
    along_bd = np.stack([a, b, d, b, c, d], axis=1)
    return np.where(first[:, None], along_ac, along_bd).reshape(-1, 3)
