"""Ambient occlusion by rays over the hemisphere: the truth for `AmbientOcclusion`."""

import numpy as np

from tools.ray_tracing.camera import VisibleSurfaces
from tools.ray_tracing.mesh import Floats
from tools.ray_tracing.tracer import RayTracer

LIFT = 2e-5
"""How far rays start above the surface, as a share of the distance to the camera; float32 positions
are exact to a hundredth of it."""

RAYS_AT_ONCE = 4_000_000
"""Rays that are cast in one call: more need memory without being faster."""


def wendland(distances: Floats, radius: float) -> Floats:
    """Return how much an occluder counts: 1 at distance 0, 0 from `radius` on (Wendland 1995).

    Examples
    --------
    >>> [round(float(w), 4) for w in wendland(np.float32([0.0, 0.5, 1.0, 2.0]), 1.0)]
    [1.0, 0.1875, 0.0, 0.0]
    """
    share = np.minimum(distances / np.float32(radius), np.float32(1.0))
    return np.asarray((1.0 - share) ** 4 * (4.0 * share + 1.0), np.float32)


def ambient_occlusion(
    tracer: RayTracer, surfaces: VisibleSurfaces, radius: float, rays: int = 256, seed: int = 0
) -> Floats:
    """Return the open share of the hemisphere above each pixel, (height, width); 1 is open.

    1 − 1/π ∫ w(d(ω)) (n·ω) dω, with the distance d of the first hit and Wendland's weight w
    (Huang 2013, ch. 3.3). Directions are drawn with the density of the cosine, from a Hammersley
    set that is shifted by a random amount for each pixel (Cranley and Patterson 1976). Directions
    below the triangle itself, which smooth normals allow, do not count.

    Parameters
    ----------
    tracer, surfaces
        A scene, and what the camera sees of it.
    radius
        Occluders farther away do not count [m].
    rays
        For each pixel.
    seed
        Of the shifts.
    """
    rng = np.random.default_rng(seed)
    seen = surfaces.seen
    points, flat = surfaces.position[seen][:, :3], surfaces.flat_normal[seen]
    normals = surfaces.normal_id[seen][:, :3]
    lift = LIFT * np.linalg.norm(points, axis=1, keepdims=True).astype(np.float32)
    shifts = rng.random((len(points), 2), np.float32)
    occluded = np.empty(len(points), np.float32)
    step = max(RAYS_AT_ONCE // rays, 1)
    for start in range(0, len(points), step):
        part = slice(start, start + step)
        directions = cosine_directions(normals[part], shifts[part], rays)
        above = np.einsum("prc,pc->pr", directions, flat[part]) > 0.0
        origins = np.repeat(points[part] + lift[part] * flat[part], rays, axis=0)
        distances = tracer.distances(origins, directions.reshape(-1, 3), radius)
        weights = wendland(distances, radius).reshape(-1, rays) * above
        occluded[part] = weights.sum(axis=1) / np.maximum(above.sum(axis=1), 1)
    result = np.ones(seen.shape, np.float32)
    result[seen] = 1.0 - occluded
    return result


def cosine_directions(normals: Floats, shifts: Floats, rays: int) -> Floats:
    """Return directions around each normal with the density of the cosine, (points, rays, 3).

    `shifts` (points, 2), 0…1, move the same Hammersley set for each point.
    """
    index = np.arange(rays)
    u = (((index + 0.5) / rays).astype(np.float32) + shifts[:, :1]) % 1.0
    v = (radical_inverse(rays) + shifts[:, 1:]) % 1.0
    angle, distance = 2.0 * np.pi * u, np.sqrt(v)
    x, y, z = distance * np.cos(angle), distance * np.sin(angle), np.sqrt(1.0 - v)
    first, second = tangents(normals)
    axes = first[:, None], second[:, None], normals[:, None]
    local = x[..., None], y[..., None], z[..., None]
    return np.asarray(sum(a * b for a, b in zip(axes, local, strict=True)), np.float32)


def radical_inverse(count: int) -> Floats:
    """Return the radical inverse in base 2 of 0…count − 1 (van der Corput 1935), (count,).

    Examples
    --------
    >>> radical_inverse(4).tolist()
    [0.0, 0.5, 0.25, 0.75]
    """
    index, value, digit = np.arange(count), np.zeros(count), 0.5
    while index.any():
        value += digit * (index & 1)
        index >>= 1
        digit *= 0.5
    return value.astype(np.float32)


def tangents(normals: Floats) -> tuple[Floats, Floats]:
    """Return two unit vectors for each unit normal that complete a frame, (n, 3) each."""
    helper = np.where(np.abs(normals[:, :1]) > 0.7, [[0.0, 1.0, 0.0]], [[1.0, 0.0, 0.0]])
    first = np.cross(normals, helper).astype(np.float32)
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    return first, np.cross(normals, first).astype(np.float32)
