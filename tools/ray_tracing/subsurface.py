"""Light that wanders below skin, by random walks: the truth for scattering in skin.

The skin is one even material below the surface. From where light leaves, a walk goes back: it
scatters until it is absorbed or comes to the surface, where light falls in that goes this way. What
the flat, evenly lit skin reflects is 1, so that its colours stay a matter of the surface.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tools.ray_tracing.ambient import tangents
from tools.ray_tracing.mesh import Floats
from tools.ray_tracing.tracer import RayTracer

MAX_STEPS = 400
"""Steps after which a walk counts as absorbed."""

LIFT_SHARE = 2e-3
"""How far below the surface walks begin, as a share of the shortest mean free path."""


@dataclass(frozen=True)
class Medium:
    """How light goes on below a surface, in red, green and blue, for isotropic scattering."""

    scattering: tuple[float, float, float]
    """Reduced scattering coefficients [1/m]."""

    absorption: tuple[float, float, float]
    """Absorption coefficients [1/m]."""


SKIN = Medium((740.0, 880.0, 1010.0), (32.0, 170.0, 480.0))
"""Skin of an arm (Jensen, Marschner, Levoy and Hanrahan, "A practical model for subsurface light
transport", 2001, figure 5, skin 1)."""

Numbers = NDArray[np.integer[Any]]


@dataclass(frozen=True)
class Exits:
    """Where walks came to the surface."""

    starts: Numbers
    """Number of the point where each began, (exits,)."""

    points: Floats
    """(exits, 3) [m], a little outside."""

    triangles: Numbers
    """(exits,)."""

    barycentric: Floats
    """Weights of the triangle's second and third vertex, (exits, 2)."""


def walk(
    tracer: RayTracer,
    points: Floats,
    inward: Floats,
    scattering: float,
    absorption: float,
    rng: np.random.Generator,
) -> Exits:
    """Walk once from each point (n, 3) on a surface, and return those that came out again.

    `inward` (n, 3) are unit normals of the triangles, away from the viewer.
    """
    extinction = scattering + absorption
    lift = np.float32(LIFT_SHARE / extinction)
    starts = np.arange(len(points))
    directions = _cosine(inward, rng)
    places = points + lift * inward
    found: list[tuple[Numbers, Floats, Numbers, Floats]] = []
    for _ in range(MAX_STEPS):
        if not len(starts):
            break
        lengths = rng.exponential(1.0 / extinction, len(starts)).astype(np.float32)
        hits = tracer.hits(places, directions)
        out = hits.distances < lengths
        ends = places[out] + (hits.distances[out, None] + lift) * directions[out]
        found.append((starts[out], ends, hits.triangles[out], hits.barycentric[out]))
        goes_on = ~out & (rng.random(len(starts)) < scattering / extinction)
        goes_on &= hits.triangles >= 0  # an open mesh has no inside
        places = places[goes_on] + lengths[goes_on, None] * directions[goes_on]
        starts = starts[goes_on]
        directions = _isotropic(len(starts), rng)
    columns = [np.concatenate(each) for each in zip(*found, strict=True)]
    return Exits(columns[0], columns[1], columns[2], columns[3])


def flat_reflectance(scattering: float, absorption: float, walks: int = 200_000) -> float:
    """Return the share of diffuse light that flat skin of endless depth returns.

    >>> 0.98 < flat_reflectance(1000.0, 0.01, 2000) <= 1.0
    True
    """
    return len(flat_exits(scattering, absorption, walks)) / walks


def flat_exits(scattering: float, absorption: float, walks: int, seed: int = 0) -> Floats:
    """Return how far from where it fell in light leaves flat skin, (exits,) [m]."""
    rng = np.random.default_rng(seed)
    extinction = scattering + absorption
    places = np.zeros((walks, 3))
    directions = _cosine(np.tile(np.array([0.0, 0.0, 1.0], np.float32), (walks, 1)), rng).astype(
        float
    )
    distances: list[Floats] = []
    for _ in range(20 * MAX_STEPS):
        if not len(places):
            break
        ends = places + rng.exponential(1.0 / extinction, len(places))[:, None] * directions
        out = ends[:, 2] < 0.0
        share = places[out, 2] / (places[out, 2] - ends[out, 2])
        surface = places[out] + share[:, None] * (ends[out] - places[out])
        distances.append(np.hypot(surface[:, 0], surface[:, 1]).astype(np.float32))
        goes_on = ~out & (rng.random(len(places)) < scattering / extinction)
        places = ends[goes_on]
        directions = _isotropic(len(places), rng).astype(float)
    return np.concatenate(distances)


def _cosine(axes: Floats, rng: np.random.Generator) -> Floats:
    """Return a direction around each axis (n, 3) with the density of the cosine."""
    first, second = tangents(axes)
    turn, square = 2.0 * np.pi * rng.random((len(axes), 1)), rng.random((len(axes), 1))
    across = np.sqrt(square)
    found = across * (np.cos(turn) * first + np.sin(turn) * second) + np.sqrt(1.0 - square) * axes
    return np.asarray(found, np.float32)


def _isotropic(count: int, rng: np.random.Generator) -> Floats:
    drawn = rng.standard_normal((count, 3), np.float32)
    return np.asarray(drawn / np.linalg.norm(drawn, axis=1, keepdims=True), np.float32)
