"""The texels of a cube map, in OpenGL's order, and how light from all of them falls on a surface.

Light is (texels, 4) of float32, of the faces +x, −x, +y, −y, +z, −z, row by row: linear RGB, and 0,
so that a texel is found at once.
"""

from functools import cache

import cv2
import numpy as np
from numpy.typing import NDArray

from cubeling.characters.rendering.camera_picture.light import LINEAR_FROM_SRGB
from cubeling.characters.skeleton.pose import Array

Floats = NDArray[np.float32]

FACES, FACE_PX = 6, 64
"""Faces of a cube map, and the side of the finest ones [texels]."""

SIDES = (64, 32, 16, 8)
"""Sides of the faces of a pyramid of cube maps [texels]."""

HARMONIC_SIDE = 8
"""Side of the faces that harmonics are made of [texels]: they know nothing smaller than 45°."""

_LINEAR = LINEAR_FROM_SRGB.astype(np.float32)

# What s (to the right) and t (down) of a face are, and the face itself (OpenGL 4.6, table 8.19).
_ACROSS = np.array([(0, 0, -1), (0, 0, 1), (1, 0, 0), (1, 0, 0), (1, 0, 0), (-1, 0, 0)], float)
_DOWN = np.array([(0, -1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1), (0, -1, 0), (0, -1, 0)], float)
_AXES = np.array([(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)], float)


def directions(side: int) -> Array:
    """Return the unit vectors of all texels, (6 · side², 3).

    >>> directions(1).tolist() == _AXES.tolist()
    True
    """
    along = (np.arange(side) + 0.5) * (2.0 / side) - 1.0
    t, s = np.meshgrid(along, along, indexing="ij")
    points = _AXES[:, None, None] + s[..., None] * _ACROSS[:, None, None]
    points = (points + t[..., None] * _DOWN[:, None, None]).reshape(-1, 3)
    return np.asarray(points / np.linalg.norm(points, axis=1, keepdims=True))


def texels_at(vectors: Array, side: int) -> NDArray[np.intp]:
    """Return the numbers of the texels in directions (…, 3), which need not be unit vectors.

    >>> bool((texels_at(directions(5), 5) == np.arange(150)).all())
    True
    """
    axis = np.abs(vectors).argmax(axis=-1)
    longest = np.take_along_axis(vectors, axis[..., None], axis=-1)[..., 0]
    face = 2 * axis + (longest < 0)
    flat = vectors / np.abs(longest)[..., None]
    s, t = ((flat * table[face]).sum(axis=-1) for table in (_ACROSS, _DOWN))
    column, row = (
        np.clip((0.5 + 0.5 * each) * side, 0, side - 1).astype(np.intp) for each in (s, t)
    )
    return np.asarray((face * side + row) * side + column, np.intp)


def pyramid(planes: NDArray[np.uint8]) -> Floats:
    """Return the linear light of an environment map in faces of all `SIDES`, (texels, 4).

    `planes` are those of `RoomMap`. Each square of four texels has one of their mean in the next
    faces.
    """
    red, green, blue = planes.reshape(3, FACES * FACE_PX, FACE_PX)
    levels = [cv2.LUT(cv2.merge([red, green, blue, np.zeros_like(red)]), _LINEAR)]
    for side in SIDES[1:]:
        smaller = (side, FACES * side)
        levels.append(cv2.resize(levels[-1], smaller, interpolation=cv2.INTER_AREA))
    return np.concatenate([np.asarray(each, np.float32).reshape(-1, 4) for each in levels])


def pyramid_starts() -> tuple[int, ...]:
    """Return where the texels of each of `SIDES` begin in a pyramid."""
    counts = [FACES * side**2 for side in SIDES]
    return tuple(np.cumsum([0, *counts[:-1]]).tolist())


def irradiance(light: Floats) -> Array:
    """Return the light that falls on surfaces, as coefficients of `harmonics`, (9, 3).

    A surface turned to n gets harmonics(n) @ result: 1 of white light from everywhere. Light is a
    `pyramid`. Ravi Ramamoorthi and Pat Hanrahan, "An efficient representation for irradiance
    environment maps", SIGGRAPH 2001: the error is 1 % on average.
    """
    start = pyramid_starts()[SIDES.index(HARMONIC_SIDE)]
    return np.asarray(_projection() @ light[start : start + FACES * HARMONIC_SIDE**2, :3], float)


def harmonics(normals: Array) -> Array:
    """Return the nine polynomials of unit vectors (n, 3) that `irradiance` is a sum of, (n, 9)."""
    x, y, z = normals.T
    one = np.ones(len(normals))
    rows = [one, y, z, x, x * y, y * z, 3 * z * z - 1, x * z, x * x - y * y]
    return np.stack(rows, axis=1)


@cache
def _projection() -> Array:
    """Return the map from texels to coefficients, (9, texels)."""
    unit = directions(HARMONIC_SIDE)
    share = np.abs(unit).max(axis=1) ** 3  # of the sphere, times a constant: dω = cos³ dA
    basis = harmonics(unit) * (share / share.sum())[:, None]
    # 4π times the squares of the harmonics' constants, times π, 2π/3, π/4 over π for a cosine.
    first, second, third = 1.0, 3.0 * 2 / 3, 15.0 / 4
    scales = [first, second, second, second, third, third, third / 12, third, third / 4]
    return np.asarray(np.array(scales)[:, None] * basis.T)
