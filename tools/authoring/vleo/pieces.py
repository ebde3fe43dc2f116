"""Geometry that moves with Vleo's skin: the skin mesh, patches on it, and parts attached to it."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.model.mesh import Mesh
from cubeling.characters.skeleton.pose import Skeleton
from tools.authoring.modelling.lathe import frame_toward
from tools.authoring.modelling.meshes import bound_mesh, strongest_joints
from tools.authoring.modelling.shapes import Array, Vector
from tools.authoring.modelling.surface import normals_of, project
from tools.authoring.vleo.body import body_shape
from tools.authoring.vleo.skin import SkinSurface


def skin_mesh(skin: SkinSurface, bound: Skeleton) -> Mesh:
    """Return the skin as a mesh bound to the skeleton."""
    return bound_mesh(skin.points, skin.normals, skin.triangles, skin.weights, skin.colors, bound)


def patches(
    near: Array, radii: Array, colors: list[Vector], skin: SkinSurface, bound: Skeleton
) -> list[Mesh]:
    """Return round patches near points (n, 3), just above the skin."""
    field = body_shape().distance
    centers = project(field, near, 0.05, 8)
    normals = normals_of(field, centers, 0.006)
    frames = np.stack([frame_toward(n, c) for n, c in zip(normals, centers, strict=True)])
    disc, triangles, lift = _disc()
    flat = disc * radii[:, None, None]
    points = flat @ frames[:, :3, :3].swapaxes(1, 2) + centers[:, None]
    points = project(field, points.reshape(-1, 3), 0.01, 4)
    normals = normals_of(field, points, 0.006)
    lifted = points + np.tile(lift, len(near))[:, None] * normals
    meshes = []
    for rows, color in zip(np.split(np.arange(len(points)), len(near)), colors, strict=True):
        weights, paint = _skin_weights(points[rows], skin), np.tile(color, (len(rows), 1))
        meshes.append(bound_mesh(lifted[rows], normals[rows], triangles, weights, paint, bound))
    return meshes


def _disc() -> tuple[Array, NDArray[np.int64], Array]:
    """Return a unit disc facing +z, its triangles, and each vertex's height over the skin [m]."""
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


def attached(mesh: Mesh, points: Array, skin: SkinSurface) -> Mesh:
    """Return a mesh whose vertices move with the skin at points, (n, 3)."""
    joints, weights = strongest_joints(_skin_weights(points, skin))
    return replace(mesh, joints=joints, weights=weights)


def _skin_weights(points: Array, skin: SkinSurface) -> Array:
    """Return skin weights, (n, joints), interpolated from the four nearest skin vertices."""
    distance = np.linalg.norm(points[:, None] - skin.points[None], axis=2)
    nearest = np.argsort(distance, axis=1, kind="stable")[:, :4]
    share = 1 / (np.take_along_axis(distance, nearest, axis=1) + 1e-4)
    share /= share.sum(axis=1, keepdims=True)
    return np.asarray(np.einsum("vk,vkj->vj", share, skin.weights[nearest]))
