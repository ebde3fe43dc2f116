"""Thin smooth tubes along a line, with fewer triangles than a sculpted surface."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from cubeling.characters.model.mesh import Mesh
from cubeling.characters.skeleton.pose import Skeleton
from tools.authoring.modelling.lathe import bands
from tools.authoring.modelling.meshes import averaged_normals, bound_mesh
from tools.authoring.modelling.shapes import Array, Vector


def tube(
    line: ArrayLike,
    radii: float | Sequence[float],
    color: Vector,
    joints: str | Sequence[str],
    skeleton: Skeleton,
    sides: int = 6,
    rings: int = 0,
) -> Mesh:
    """Return a closed tube with rounded ends.

    Parameters
    ----------
    line : (n, 3) [m]
    radii : one, or n of them [m]
    color : linear RGB
    joints : the joint that moves it, or one for each of the n points
    sides : of its cross-section
    rings : how many; 0 for one at each point, more for a smooth curve through the points
    """
    points = np.asarray(line, float)
    count = len(points)
    names = [joints] * count if isinstance(joints, str) else list(joints)
    weights = np.zeros((count, len(skeleton.names)))
    weights[np.arange(count), [skeleton.names.index(name) for name in names]] = 1.0
    along = np.linspace(0, count - 1, rings) if rings else np.arange(float(count))
    points, radius = _through(points, along), _mixed(np.broadcast_to(radii, (count,)), along)
    weights = np.stack([_mixed(column, along) for column in weights.T], axis=-1)
    points, radius, weights = _rounded(points, radius, weights)
    vertices = (points[:, None] + radius[:, None, None] * _circles(points, sides)).reshape(-1, 3)
    triangles = bands(np.arange(len(points) - 1), sides)
    return bound_mesh(
        vertices,
        averaged_normals(vertices, triangles),
        triangles,
        np.repeat(weights, sides, axis=0),
        np.tile(np.array(color), (len(vertices), 1)),
        skeleton,
    )


def _mixed(values: Array, along: Array) -> Array:
    return np.asarray(np.interp(along, np.arange(len(values)), values))


def _through(points: Array, along: Array) -> Array:
    """Return a Catmull-Rom spline through the points at parameters 0…n − 1."""
    i = np.minimum(along.astype(int), len(points) - 2)
    u = (along - i)[:, None]
    padded = np.vstack([2 * points[0] - points[1], points, 2 * points[-1] - points[-2]])
    a, b, c, d = (padded[i + k] for k in range(4))
    cubic = (-a + 3 * b - 3 * c + d) * u**3 + (2 * a - 5 * b + 4 * c - d) * u**2
    return np.asarray(0.5 * (cubic + (c - a) * u) + b)


def _rounded(points: Array, radius: Array, weights: Array) -> tuple[Array, Array, Array]:
    """Return the line with an additional ring and pole at either end."""
    for _ in range(2):  # the far end, then the near end
        end = points[-1] - points[-2]
        end *= radius[-1] / np.linalg.norm(end)
        points = np.vstack([points, points[-1] + 0.6 * end, points[-1] + 0.9 * end])[::-1]
        radius = np.concatenate([radius, [0.75 * radius[-1], 0.0]])[::-1]
        weights = np.vstack([weights, weights[-1], weights[-1]])[::-1]
    return points, radius, weights


def _circles(points: Array, sides: int) -> Array:
    """Return unit circles across the line, (points, sides, 3), without twist."""
    tangent = np.gradient(points, axis=0)
    tangent /= np.linalg.norm(tangent, axis=1, keepdims=True)
    across = np.empty_like(points)
    guess = np.eye(3)[np.abs(tangent[0]).argmin()]
    for i, t in enumerate(tangent):
        guess = guess - t * (guess @ t)
        guess = guess / np.linalg.norm(guess)
        across[i] = guess
    other = np.cross(tangent, across)
    angle = np.linspace(0, 2 * np.pi, sides, endpoint=False)[:, None]
    return np.asarray(np.cos(angle) * across[:, None] + np.sin(angle) * other[:, None])
