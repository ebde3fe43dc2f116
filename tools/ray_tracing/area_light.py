"""Light of an area, past opaque meshes and through coloured panes: the truth for soft shadows."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from tools.ray_tracing.ambient import RAYS_AT_ONCE, radical_inverse
from tools.ray_tracing.mesh import Array, Floats
from tools.ray_tracing.tracer import RayTracer


@dataclass(frozen=True)
class AreaLight:
    """A parallelogram that shines evenly from every point."""

    corner: Array
    """One corner, (3,) [m]."""

    sides: Array
    """The two sides that meet there, (2, 3) [m]."""


@dataclass(frozen=True)
class Pane:
    """A thin sheet of coloured glass: a parallelogram, without reflection and refraction."""

    corner: Array
    """One corner, (3,) [m]."""

    sides: Array
    """The two sides that meet there, (2, 3) [m]."""

    transmittance: tuple[float, float, float]
    """Share of the light that passes, by channel, 0…1."""


def light_fraction(
    tracer: RayTracer,
    points: Floats,
    light: AreaLight,
    panes: Sequence[Pane] = (),
    rays: int = 256,
    seed: int = 0,
) -> Floats:
    """Return the share of an area light that reaches each point, by channel, (points, 3).

    Every part of the area counts the same: the cosines are the shading's matter. The points
    (points, 3) must lie above their surface, or they shade themselves.
    """
    shifts = np.random.default_rng(seed).random((len(points), 1, 2), np.float32)
    base = np.stack([(np.arange(rays) + 0.5) / rays, radical_inverse(rays)], axis=1)
    shares = np.empty((len(points), 3), np.float32)
    step = max(RAYS_AT_ONCE // rays, 1)
    for start in range(0, len(points), step):
        part = slice(start, start + step)
        places = (base + shifts[part]) % 1.0 @ light.sides + light.corner
        origins = np.repeat(points[part], rays, axis=0)
        ways = places.reshape(-1, 3) - origins
        lengths = np.linalg.norm(ways, axis=1)
        directions = (ways / lengths[:, None]).astype(np.float32)
        open_way = tracer.distances(origins, directions) > lengths
        passed = pane_transmittance(origins, directions, lengths, panes) * open_way[:, None]
        shares[part] = passed.reshape(-1, rays, 3).mean(axis=1)
    return shares


def pane_transmittance(
    origins: Floats, directions: Floats, lengths: Array, panes: Sequence[Pane]
) -> Array:
    """Return what the panes on each ray let through, by channel, (rays, 3)."""
    passed = np.ones((len(origins), 3))
    for pane in panes:
        # origin + t direction = corner + u side + v side, solved for (t, u, v) of each ray.
        first, second = pane.sides
        normal = np.cross(first, second)
        facing = directions @ normal
        with np.errstate(divide="ignore", invalid="ignore"):
            t = (pane.corner - origins) @ normal / facing
            place = origins + t[:, None] * directions - pane.corner
            u = place @ np.cross(second, normal) / (first @ np.cross(second, normal))
            v = place @ np.cross(first, normal) / (second @ np.cross(first, normal))
            crossed = (t > 0) & (t < lengths) & (u >= 0) & (u <= 1) & (v >= 0) & (v <= 1)
        passed[crossed] *= pane.transmittance
    return passed
