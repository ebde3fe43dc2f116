"""The light from all around as surfaces of some roughness mirror it, in one texture.

Each roughness has a square of the texture, in which a direction is a place (octahedral maps:
Engelhardt and Dachsbacher, 2008), with a rim of one texel for the filter of the graphics card:
moderngl writes no smaller levels of a cube map, and a software driver samples flat textures faster.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.rendering.environment.cube_map import (
    SIDES,
    Floats,
    pyramid_starts,
    texels_at,
)
from cubeling.characters.skeleton.pose import Array

TILE_SIDES = (96, 48, 24, 16, 16)
"""Sides of the squares for the roughness 0, ¼, ½, ¾ and 1 [texels], without their rims."""

SAMPLE_COUNTS = (1, 16, 24, 48, 48)
"""Directions that each texel takes the mean of, of those that a surface of a roughness mirrors."""

PARTS = 6
"""A map is filtered in so many steps, one a picture."""

WIDTH = TILE_SIDES[0] + 2
HEIGHT = sum(side + 2 for side in TILE_SIDES)
"""Size of the texture."""

TILES = tuple(
    (side, sum(before + 2 for before in TILE_SIDES[:number]) + 1)
    for number, side in enumerate(TILE_SIDES)
)
"""Side and first row of each square, without its rim."""


Image = NDArray[np.uint8]


@dataclass(frozen=True)
class _Taps:
    """Of which texels of a pyramid the texels of a square are means."""

    texels: NDArray[np.intp]
    """(side², samples)."""

    weights: Floats
    """(samples,); the sum is 1."""


class ReflectionFilter:
    """Filters one pyramid, a part in each step, so that no picture takes long."""

    def __init__(self, light: Floats) -> None:
        self._light = light
        self._tiles = [np.empty((3, side * side), np.float32) for side in TILE_SIDES]
        self._steps = self._filter()
        self.done = 0
        """How many of `PARTS` are filtered."""

    def step(self) -> None:
        """Filter the next part."""
        next(self._steps)
        self.done += 1

    def _filter(self) -> Iterator[None]:
        for part in range(PARTS):
            for tile, taps in zip(self._tiles, _taps(), strict=True):
                count = tile.shape[1]
                rows = slice(count * part // PARTS, count * (part + 1) // PARTS)
                for channel, plane in zip(self._light, tile, strict=True):
                    plane[rows] = np.take(channel, taps.texels[rows], mode="clip") @ taps.weights
            yield

    @property
    def texture(self) -> Image:
        """All squares with their rims, (HEIGHT, WIDTH, 4): valid when all is done.

        Of linear light, it has the square root, as bytes: a software driver reads them several
        times as fast as floats.
        """
        texels = np.zeros((HEIGHT, WIDTH, 4), np.uint8)
        for tile, (side, first) in zip(self._tiles, TILES, strict=True):
            square = np.sqrt(tile).reshape(3, side, side).transpose(1, 2, 0)
            values = np.asarray(np.float32(255.0) * square + np.float32(0.5), np.uint8)
            texels[first - 1 : first + side + 1, : side + 2, :3] = _rimmed(values)
        return texels


def filtered(light: Floats) -> Image:
    """Return all squares of a pyramid at once, as `ReflectionFilter.texture`."""
    steps = ReflectionFilter(light)
    for _ in range(PARTS):
        steps.step()
    return steps.texture


def octahedral_directions(side: int, fineness: int = 1) -> Array:
    """Return unit vectors in the texels of a square, (side², fineness², 3).

    >>> octahedral_directions(1)[0, 0].tolist()
    [0.0, 1.0, 0.0]
    """
    along = (np.arange(side * fineness) + 0.5) * (2.0 / (side * fineness)) - 1.0
    z, x = np.meshgrid(along, along, indexing="ij")
    y = 1.0 - np.abs(x) - np.abs(z)
    below = np.maximum(-y, 0.0)
    points = np.stack([x - np.copysign(below, x), y, z - np.copysign(below, z)], axis=-1)
    points /= np.linalg.norm(points, axis=-1, keepdims=True)
    blocks = points.reshape(side, fineness, side, fineness, 3).transpose(0, 2, 1, 3, 4)
    return blocks.reshape(side * side, fineness * fineness, 3)


def _rimmed(square: Image) -> Image:
    """Return a square with a rim: beyond an edge, an octahedral map goes on at the same edge."""
    rows = np.concatenate([square[:1, ::-1], square, square[-1:, ::-1]])
    ends = rows[::-1, :1], rows[::-1, -1:]
    return np.concatenate([ends[0], rows, ends[1]], axis=1)


@cache
def _taps() -> tuple[_Taps, ...]:
    """Return the taps of each square."""
    mirror = texels_at(octahedral_directions(TILE_SIDES[0], math.isqrt(SAMPLE_COUNTS[0])), SIDES[0])
    quarters = np.full(mirror.shape[1], 1.0 / mirror.shape[1], np.float32)
    taps = [_Taps(mirror, quarters)]
    for number, side in enumerate(TILE_SIDES[1:], 1):
        roughness = number / (len(TILE_SIDES) - 1)
        taps.append(
            _rough_taps(octahedral_directions(side)[:, 0], roughness, SAMPLE_COUNTS[number])
        )
    return tuple(taps)


def _rough_taps(towards: Array, roughness: float, samples: int) -> _Taps:
    """Return taps of what a surface mirrors into a direction that it faces, (n, 3).

    Samples are as dense as the lobe is bright (GGX; Karis, "Real shading in Unreal Engine 4",
    2013), and each is of the faces whose texels are as large as what it stands for (Křivánek and
    Colbert, "Real-time shading with filtered importance sampling", 2008).
    """
    alpha = roughness**2
    number = np.arange(samples) + 0.5
    angle, share = np.pi * (1.0 + np.sqrt(5.0)) * number, number / samples
    cos2 = (1.0 - share) / (1.0 + (alpha**2 - 1.0) * share)
    cos_half, sin_half = np.sqrt(cos2), np.sqrt(1.0 - cos2)
    density = alpha**2 / (np.pi * (cos2 * (alpha**2 - 1.0) + 1.0) ** 2) / 4.0
    # Mirrored at the half vector: twice its angle from the direction.
    cos, sin = 2.0 * cos2 - 1.0, 2.0 * cos_half * sin_half
    kept = cos > 0.0
    local = np.stack([sin * np.cos(angle), sin * np.sin(angle), cos], axis=1)[kept]
    least = np.eye(3)[np.abs(towards).argmin(axis=1)]
    across = np.cross(least, towards)
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    frames = np.stack([across, np.cross(towards, across), towards], axis=1)
    vectors = np.einsum("kl,nlc->nkc", local, frames)
    solid_angle = 1.0 / (samples * density[kept])
    wanted = np.sqrt(4.0 * np.pi / (6.0 * solid_angle))
    # Finer by half, as the nearest texel is taken.
    level = np.clip(np.ceil(np.log2(SIDES[0] / wanted) - 0.5), 0, len(SIDES) - 1).astype(int)
    texels = np.empty(vectors.shape[:2], np.intp)
    for each, (side, start) in enumerate(zip(SIDES, pyramid_starts(), strict=True)):
        texels[:, level == each] = start + texels_at(vectors[:, level == each], side)
    weights = (cos[kept] / cos[kept].sum()).astype(np.float32)
    return _Taps(texels, weights)
