"""Closed surfaces through rings of points: lids, lips, whatever is drawn line by line."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from characters.model.mesh import Mesh
from characters.skeleton.pose import Skeleton
from tools.authoring.modelling.sculpt import bands, bound_mesh
from tools.authoring.modelling.shapes import Array


def ringed(rings: Array, colors: Array, joint: "str | Array", skeleton: Skeleton) -> Mesh:
    """Return a closed surface.

    Parameters
    ----------
    rings : (rings, points, 3), from one pole to the other; all points of the first and of the last
        ring are one [m]. Two rings at one place make a crisp border of colour. Going along the
        points, the next ring lies to the left, seen from outside.
    colors : linear RGB of each point, (rings, points, 3)
    joint : what moves it, or the weight of every joint on every point, (rings, points, joints)
    """
    segments = rings.shape[1]
    points = np.asarray(rings, float).reshape(-1, 3)
    same = np.all(rings[1:] == rings[:-1], axis=(1, 2))
    triangles = bands(np.flatnonzero(~same), segments)
    if isinstance(joint, str):
        bones = np.zeros((len(points), len(skeleton.names)))
        bones[:, skeleton.names.index(joint)] = 1.0
    else:
        bones = joint.reshape(len(points), -1)
    normals = averaged_normals(points, triangles)
    return bound_mesh(points, normals, triangles, bones, colors.reshape(-1, 3), skeleton)


def averaged_normals(vertices: Array, triangles: NDArray[np.int64]) -> Array:
    """Return the mean normal of the triangles around each place, by their areas, (n, 3)."""
    corners = vertices[triangles]
    flat = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    _, same = np.unique(vertices.round(7), axis=0, return_inverse=True)  # a pole is one place
    total = np.zeros((same.max() + 1, 3))
    np.add.at(total, same[triangles.ravel()], np.repeat(flat, 3, axis=0))
    normal = total[same]
    return np.asarray(normal / np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-15))


def with_normals(mesh: Mesh, normals: Array, share: Array) -> Mesh:
    """Return a mesh whose normals are drawn to others, by a share a vertex, (n,)."""
    mixed = mesh.normals * (1 - share[:, None]) + normals * share[:, None]
    mixed /= np.maximum(np.linalg.norm(mixed, axis=1, keepdims=True), 1e-12)
    return replace(mesh, normals=mixed.astype(np.float32))
