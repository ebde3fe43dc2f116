"""What a pinhole camera sees: the G-buffer of a scene, by one ray for each pixel."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tools.ray_tracing.mesh import Array, Floats
from tools.ray_tracing.tracer import RayTracer

NOTHING_M = 1e3
"""Depth that stands for nothing [m]."""

STEP = 1e-5
"""How far behind a surface the next is looked for, as a share of the distance."""


@dataclass(frozen=True)
class VisibleSurfaces:
    """The surface behind each pixel, in the camera frame (x right, y down, z forward).

    Background pixels are zero in every array.
    """

    normal_id: Floats
    """Unit normal for shading and the object's number, (height, width, 4)."""

    position: Floats
    """Position and 1, (height, width, 4) [m]."""

    flat_normal: Floats
    """Unit normal of the triangle, towards the camera, (height, width, 3)."""

    @property
    def seen(self) -> NDArray[np.bool_]:
        """Pixels that are not background, (height, width)."""
        return self.normal_id[..., 3] > 0.5


def trace_camera(tracer: RayTracer, matrix: Array, size: tuple[int, int]) -> VisibleSurfaces:
    """Return what a camera at the origin sees through the centres of its pixels.

    Parameters
    ----------
    tracer
        Of a mesh in the camera frame.
    matrix
        Pinhole matrix, (3, 3) [px]; the centre of the first pixel is at (0.5, 0.5).
    size
        Width and height [px].
    """
    width, height = size
    rays = _camera_rays(matrix, size)
    hits = tracer.hits(np.zeros_like(rays), rays)
    seen = hits.triangles >= 0
    triangles = hits.triangles[seen]
    position = np.zeros((len(rays), 4), np.float32)
    position[seen, :3] = rays[seen] * hits.distances[seen, None]
    position[seen, 3] = 1.0
    flat = np.zeros_like(rays)
    flat[seen] = tracer.flat_normals(triangles)
    flat *= -np.sign(np.einsum("ij,ij->i", flat, rays))[:, None]
    u, v = hits.barycentric[seen].T
    weights = np.stack([1.0 - u - v, u, v], axis=1)
    smooth = np.einsum("nk,nkc->nc", weights, tracer.mesh.normals[tracer.mesh.corners[triangles]])
    smooth /= np.maximum(np.linalg.norm(smooth, axis=1, keepdims=True), 1e-30)
    # Shading normals of an open surface that is seen from behind point away from the camera.
    smooth *= np.where(np.einsum("ij,ij->i", smooth, flat[seen]) < 0.0, -1.0, 1.0)[:, None]
    normal_id = np.zeros((len(rays), 4), np.float32)
    normal_id[seen, :3] = smooth
    normal_id[seen, 3] = tracer.mesh.objects[triangles]
    shape = height, width
    return VisibleSurfaces(
        normal_id.reshape(*shape, 4), position.reshape(*shape, 4), flat.reshape(*shape, 3)
    )


def trace_depth_layers(tracer: RayTracer, matrix: Array, size: tuple[int, int]) -> Floats:
    """Return where what a camera sees begins and ends, and what is behind, (height, width, 4) [m].

    Four depths: where what is seen ends (the first surface behind it that looks away), the first
    surfaces behind that which look to the camera and away, and where what is seen begins.
    `NOTHING_M` where there is none. Parameters are as of `trace_camera`.
    """
    rays = _camera_rays(matrix, size)
    depths = np.full((len(rays), 4), NOTHING_M, np.float32)
    ways = np.zeros(len(rays), np.float32)
    alive, is_first = np.arange(len(rays)), True
    while len(alive):
        hits = tracer.hits(ways[alive, None] * rays[alive], rays[alive])
        found = hits.triangles >= 0
        alive, triangles = alive[found], hits.triangles[found]
        ways[alive] += hits.distances[found]
        depth = ways[alive] * rays[alive, 2]
        ways[alive] *= 1.0 + STEP
        normals = tracer.mesh.normals[tracer.mesh.corners[triangles]].sum(axis=1)
        flat = tracer.flat_normals(triangles)
        flat *= np.sign(np.einsum("ij,ij->i", flat, normals))[:, None]
        away = np.einsum("ij,ij->i", flat, rays[alive]) > 0.0
        if is_first:
            depths[alive, 3] = depth
        else:
            has_ended = depths[alive, 0] < NOTHING_M
            column = np.where(has_ended, np.where(away, 2, 1), np.where(away, 0, 3))
            depths[alive, column] = np.minimum(depths[alive, column], depth)
            alive = alive[(depths[alive, :3] == NOTHING_M).any(axis=1)]
        is_first = False
    return depths.reshape(size[1], size[0], 4)


def _camera_rays(matrix: Array, size: tuple[int, int]) -> Floats:
    """Return unit directions through the centres of all pixels, (width × height, 3)."""
    x, y = np.meshgrid(np.arange(size[0]) + 0.5, np.arange(size[1]) + 0.5)
    rays = np.stack([x, y, np.ones_like(x)], axis=-1).reshape(-1, 3) @ np.linalg.inv(matrix).T
    return np.asarray(rays / np.linalg.norm(rays, axis=1, keepdims=True), np.float32)
