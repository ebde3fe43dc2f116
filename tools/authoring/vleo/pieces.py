"""Pieces of geometry that ride on Vleo's skin: patches, and whatever is stuck to it."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from characters.model.mesh import Mesh
from characters.skeleton.pose import Skeleton
from tools.authoring.modelling.shapes import Array, Vector
from tools.authoring.modelling.surface import normals_of, project
from tools.authoring.vleo.body import whole
from tools.authoring.vleo.skin import Body


def skin_mesh(body: Body, bound: Skeleton) -> Mesh:
    """Return the skin itself as a mesh bound to the skeleton."""
    bare = _mesh(body.points, body.normals, body.triangles, (1.0, 1.0, 1.0), body)
    colors = np.column_stack([body.colors, np.ones(len(body.colors))]).astype(np.float32)
    inverse_bind = np.asarray(np.linalg.inv(bound.rest.globals(bound)), np.float64)
    return replace(_skinned(bare, body.weights), colors=colors, inverse_bind=inverse_bind)


def patches(near: Array, radii: Array, colors: list[Vector], body: Body) -> list[Mesh]:
    """Return round patches on the skin next to points (n, 3), half a millimetre proud of it."""
    field = whole().distance
    centers = project(field, near, 0.05, 8)
    normals = normals_of(field, centers, 0.006)
    frames = np.stack([facing(n, c) for n, c in zip(normals, centers, strict=True)])
    disc, triangles, lift = _disc()
    flat = disc * radii[:, None, None]
    points = flat @ frames[:, :3, :3].swapaxes(1, 2) + centers[:, None]
    points = project(field, points.reshape(-1, 3), 0.01, 4)
    normals = normals_of(field, points, 0.006)
    proud = points + np.tile(lift, len(near))[:, None] * normals
    made = []
    for rows, color in zip(np.split(np.arange(len(points)), len(near)), colors, strict=True):
        bare = _mesh(proud[rows], normals[rows], triangles, color, body)
        made.append(carried(bare, points[rows], body))
    return made


def _disc() -> tuple[Array, NDArray[np.int64], Array]:
    """Return a unit disc facing +z, its triangles, and how far each vertex is off the skin [m]."""
    sides = 12
    angle = np.linspace(0, 2 * np.pi, sides, endpoint=False)
    circle = np.stack([np.cos(angle), np.sin(angle), np.zeros(sides)], axis=1)
    points = np.vstack([np.zeros((1, 3)), 0.6 * circle, circle])
    i = 1 + np.arange(sides)
    j = 1 + (np.arange(sides) + 1) % sides
    fan = np.stack([0 * i, i, j], axis=1)
    rim = np.stack([i, sides + i, sides + j, i, sides + j, j], axis=1)
    lift = np.where(np.arange(1 + 2 * sides) <= sides, 0.0007, 0.0003)
    return points, np.vstack([fan, rim.reshape(-1, 3)]), lift


def carried(mesh: Mesh, points: Array, body: Body) -> Mesh:
    """Return a piece that moves with the skin at points (one a vertex)."""
    away = np.linalg.norm(points[:, None] - body.points[None], axis=2)
    nearest = np.argsort(away, axis=1, kind="stable")[:, :4]
    share = 1 / (np.take_along_axis(away, nearest, axis=1) + 1e-4)
    share /= share.sum(axis=1, keepdims=True)
    return _skinned(mesh, np.einsum("vk,vkj->vj", share, body.weights[nearest]))


def _skinned(mesh: Mesh, weights: Array) -> Mesh:
    """Return a piece with the four largest of weights (vertices, joints)."""
    joints = np.argsort(-weights, axis=1, kind="stable")[:, :4]
    four = np.take_along_axis(weights, joints, axis=1)
    four[four < 0.01] = 0.0
    four /= four.sum(axis=1, keepdims=True)
    joints = np.where(four > 0, joints, 0)
    return replace(mesh, joints=joints.astype(np.uint16), weights=four.astype(np.float32))


def _mesh(
    points: Array, normals: Array, triangles: NDArray[np.int64], color: Vector, body: Body
) -> Mesh:
    """Return an unskinned piece of one colour."""
    return Mesh(
        name="",
        positions=points.astype(np.float32),
        normals=normals.astype(np.float32),
        triangles=triangles.astype(np.uint32),
        joints=np.zeros((len(points), 4), np.uint16),
        weights=np.tile(np.array([1, 0, 0, 0], np.float32), (len(points), 1)),
        inverse_bind=np.zeros((body.weights.shape[1], 4, 4)),
        colors=np.tile(np.array([*color, 1.0], np.float32), (len(points), 1)),
    )


def facing(axis: Array, place: Array) -> Array:
    """Return the (4, 4) frame at a place whose +z is the axis and whose +y is as high as can be."""
    z = axis / np.linalg.norm(axis)
    hint = np.array([0.0, 1.0, 0.0]) if abs(z[1]) < 0.95 else np.array([0.0, 0.0, -1.0])
    x = np.cross(hint, z)
    x /= np.linalg.norm(x)
    frame = np.eye(4)
    frame[:3, :3] = np.stack([x, np.cross(z, x), z], axis=1)
    frame[:3, 3] = place
    return frame
