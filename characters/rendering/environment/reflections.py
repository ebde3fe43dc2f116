"""The light from all around as surfaces of some roughness mirror it, in one texture.

Each roughness has a square of the texture, in which a direction is a place (octahedral maps:
Engelhardt and Dachsbacher, 2008), with a rim of one texel for the filter of the graphics card:
moderngl writes no smaller levels of a cube map, and a software driver samples flat textures faster.
"""

import itertools
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

Image = NDArray[np.uint8]


@dataclass(frozen=True)
class Tile:
    """The square of one roughness."""

    roughness: float

    side: int
    """Its side, without the rim [texels]."""

    column: int
    row: int
    """Its first texel in the texture, without the rim."""

    samples: int
    """Directions that each texel takes the mean of, of those that a surface mirrors."""

    @property
    def box(self) -> tuple[slice, slice]:
        """Rows and columns in the texture, with the rim."""
        return (
            slice(self.row - 1, self.row + self.side + 1),
            slice(self.column - 1, self.column + self.side + 1),
        )


ROUGHNESS_TILES = (
    Tile(0.0, 80, 1, 1, 1),
    Tile(0.25, 48, 1, 83, 16),
    Tile(0.375, 32, 51, 83, 16),
    Tile(0.5, 24, 1, 133, 24),
    Tile(0.75, 16, 27, 133, 48),
    Tile(1.0, 16, 45, 133, 48),
)
"""The squares, in rows. A surface has the nearest one: two for each texel that is drawn would cost
more than all else there. Of roughness ⅛, what is mirrored is no wider than a texel of the first."""

TILE_ROWS_PX = (0, 82, 132, 158)
"""First row of the texture of each row of squares, and the end of the last."""

HEIGHT, WIDTH = TILE_ROWS_PX[-1], 84
"""Size of the texture."""

STEPS_TO_ONE = 8
"""Steps of roughness that surfaces tell apart, from 0 to 1."""

PARTS = 6
"""A map is filtered in so many steps, one a picture."""

_STEPS = [
    min(ROUGHNESS_TILES, key=lambda each: abs(each.roughness - step / STEPS_TO_ONE))
    for step in range(STEPS_TO_ONE + 1)
]


def tiles_by_roughness() -> Array:
    """Return side, first column and first row of the square of each step, (STEPS_TO_ONE + 1, 3).

    >>> tiles_by_roughness()[[0, 1, 2]].tolist()
    [[80.0, 1.0, 1.0], [80.0, 1.0, 1.0], [48.0, 1.0, 83.0]]
    """
    return np.array([(each.side, each.column, each.row) for each in _STEPS], float)


@cache
def rows_between(least: float, most: float) -> slice:
    """Return the rows of the texture that surfaces of a range of roughness need.

    >>> rows_between(0.25, 0.3)
    slice(82, 132, None)
    """
    first, last = (_STEPS[int(STEPS_TO_ONE * each + 0.5)].row for each in (least, most))
    return slice(
        max(each for each in TILE_ROWS_PX if each < first),
        min(each for each in TILE_ROWS_PX if each > last),
    )


@dataclass(frozen=True)
class _Taps:
    """Of which texels of a pyramid the texels of a square are means."""

    parts: tuple[NDArray[np.intp], ...]
    """(samples, texels) of each of `PARTS` of the square."""

    weights: Floats
    """(samples,); the sum is 1."""


class ReflectionFilter:
    """Filters one pyramid for some rows of the texture, a part in each step.

    So no picture takes long.
    """

    def __init__(self, light: Floats, rows: slice) -> None:
        self._rows = rows
        self._texels = light.view(np.complex128)[:, 0]  # four floats are taken as one number
        self._tiles = [
            (tile, taps, np.empty((tile.side**2, 4), np.float32))
            for tile, taps in zip(ROUGHNESS_TILES, _taps(), strict=True)
            if rows.start < tile.row < rows.stop
        ]
        self.done = 0
        """How many of `PARTS` are filtered."""

    def step(self) -> None:
        """Filter the next part."""
        for _, taps, filtered in self._tiles:
            first = len(filtered) * self.done // PARTS
            end = len(filtered) * (self.done + 1) // PARTS
            taken = self._texels.take(taps.parts[self.done]).view(np.float32)
            np.matmul(taps.weights, taken, out=filtered[first:end].reshape(-1))
        self.done += 1

    @property
    def texture(self) -> Image:
        """The rows, (rows, WIDTH, 4), of squares with their rims: valid when all is done.

        Of linear light, it has the square root, as bytes: a software driver reads them several
        times as fast as floats.
        """
        texels = np.zeros((self._rows.stop, WIDTH, 4), np.uint8)
        for tile, _, light in self._tiles:
            values = np.float32(255.0) * np.sqrt(light) + np.float32(0.5)
            texels[tile.box] = _rimmed(values.astype(np.uint8).reshape(tile.side, tile.side, 4))
        return texels[self._rows.start :]


def filter_at_once(light: Floats, rows: slice = slice(0, HEIGHT)) -> Image:
    """Return rows of squares of a pyramid, as `ReflectionFilter.texture`."""
    steps = ReflectionFilter(light, rows)
    for _ in range(PARTS):
        steps.step()
    return steps.texture


def octahedral_directions(side: int) -> Array:
    """Return unit vectors of the texels of a square, (side², 3).

    >>> octahedral_directions(1)[0].tolist()
    [0.0, 1.0, 0.0]
    """
    along = (np.arange(side) + 0.5) * (2.0 / side) - 1.0
    z, x = np.meshgrid(along, along, indexing="ij")
    y = 1.0 - np.abs(x) - np.abs(z)
    below = np.maximum(-y, 0.0)
    points = np.stack([x - np.copysign(below, x), y, z - np.copysign(below, z)], axis=-1)
    points /= np.linalg.norm(points, axis=-1, keepdims=True)
    return points.reshape(-1, 3)


def _rimmed(square: Image) -> Image:
    """Return a square with a rim: beyond an edge, an octahedral map goes on at the same edge."""
    rows = np.concatenate([square[:1, ::-1], square, square[-1:, ::-1]])
    ends = rows[::-1, :1], rows[::-1, -1:]
    return np.concatenate([ends[0], rows, ends[1]], axis=1)


@cache
def _taps() -> tuple[_Taps, ...]:
    """Return the taps of each square."""
    return tuple(_taps_of(octahedral_directions(tile.side), tile) for tile in ROUGHNESS_TILES)


def _taps_of(towards: Array, tile: Tile) -> _Taps:
    """Return taps of what a surface mirrors into directions that it faces, (n, 3).

    Samples are as dense as the lobe is bright (GGX; Karis, "Real shading in Unreal Engine 4",
    2013), and each is of the faces whose texels are as large as what it stands for (Křivánek and
    Colbert, "Real-time shading with filtered importance sampling", 2008).
    """
    alpha, samples = max(tile.roughness**2, 1e-4), tile.samples
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
    vectors = np.einsum("kl,nlc->knc", local, frames)
    solid_angle = 1.0 / (samples * density[kept])
    wanted = np.sqrt(4.0 * np.pi / (6.0 * solid_angle))
    # Finer by half, as the nearest texel is taken.
    level = np.clip(np.ceil(np.log2(SIDES[0] / wanted) - 0.5), 0, len(SIDES) - 1).astype(int)
    texels = np.empty(vectors.shape[:2], np.intp)
    for each, (side, start) in enumerate(zip(SIDES, pyramid_starts(), strict=True)):
        texels[level == each] = start + texels_at(vectors[level == each], side)
    parts = (np.arange(PARTS + 1) * len(towards) // PARTS).tolist()
    return _Taps(
        tuple(
            np.ascontiguousarray(texels[:, first:end]) for first, end in itertools.pairwise(parts)
        ),
        (cos[kept] / cos[kept].sum()).astype(np.float32),
    )
