"""Directions of the texels of a cube map, and filling those that nothing is known of."""

from functools import cache
from typing import TypeVar

import cv2
import numpy as np
from numpy.typing import NDArray

from cubeling.tracking.geometry.arrays import Array, Floats, Indices

Number = TypeVar("Number", np.uint8, np.float32)

FACES = 6
"""Faces of a cube map, in OpenGL's order: +x, −x, +y, −y, +z, −z."""

COARSE_PX = 8
"""Side of a face in which unknown directions are filled [texels]: each is 11° wide."""

NEARNESS = 0.05
"""How sharply what is known nearby outweighs what is known elsewhere: the scale of one less the
cosine of the angle between, as 18°."""

# Rows: what s and t of a face are multiplied by, and what is added, for x, y and z (OpenGL 4.6
# core, table 8.19): s grows to the right, t downwards.
_ACROSS = np.array([(0, 0, -1), (0, 0, 1), (1, 0, 0), (1, 0, 0), (1, 0, 0), (-1, 0, 0)], float)
_DOWN = np.array([(0, -1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1), (0, -1, 0), (0, -1, 0)], float)
_AXES = np.array([(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)], float)


def face_points(side: int, rim: int = 0) -> Array:
    """Return the centres of the texels of a cube of half-length 1, (6, side, side, 3).

    With a rim, texels of so many rows and columns beyond each edge of a face are there too, in its
    plane.

    >>> face_points(1)[:, 0, 0].tolist() == _AXES.tolist()
    True
    """
    along = (np.arange(-rim, side + rim) + 0.5) * (2.0 / side) - 1.0
    t, s = np.meshgrid(along, along, indexing="ij")
    return np.asarray(
        _AXES[:, None, None]
        + s[..., None] * _ACROSS[:, None, None]
        + t[..., None] * _DOWN[:, None, None]
    )


@cache
def directions(side: int) -> Array:
    """Return the unit vectors of all texels, (6 · side², 3)."""
    points = face_points(side).reshape(-1, 3)
    return np.asarray(points / np.linalg.norm(points, axis=1, keepdims=True))


def solid_angles(side: int) -> Array:
    """Return how much of the sphere each texel covers, (6 · side²,); the sum is 1.

    >>> float(solid_angles(4).sum().round(9))
    1.0
    """
    points = face_points(side).reshape(-1, 3)
    share = (points * points).sum(axis=1) ** -1.5
    return np.asarray(share / share.sum())


def texels_at(vectors: Array, side: int) -> Indices:
    """Return the numbers of the texels in directions (n, 3), which need not be unit vectors.

    >>> bool((texels_at(directions(5), 5) == np.arange(150)).all())
    True
    """
    axis = np.abs(vectors).argmax(axis=1)
    longest = np.take_along_axis(vectors, axis[:, None], axis=1)[:, 0]
    face = 2 * axis + (longest < 0)
    flat = vectors / np.abs(longest)[:, None]
    s, t = ((flat * table[face]).sum(axis=1) for table in (_ACROSS, _DOWN))
    column, row = (
        np.clip((0.5 + 0.5 * each) * side, 0, side - 1).astype(np.intp) for each in (s, t)
    )
    return np.asarray((face * side + row) * side + column, np.intp)


def filled(light: Floats, known: Floats) -> Floats:
    """Return the light that is guessed of all directions from those that are known.

    A guess is a mean of what is known, weighted by how near it is (Shepard, "A two-dimensional
    interpolation function for irregularly-spaced data", 1968): next to it, it is that, blurred.

    Parameters
    ----------
    light
        Linear light of coarse texels, (6 · COARSE_PX², 3).
    known
        How well it is known, 0…1, (6 · COARSE_PX², 1): not 0 everywhere.

    Returns
    -------
    The same everywhere, (6 · COARSE_PX², 3).
    """
    sums = _nearness() @ np.column_stack([known * light, known])
    return np.asarray(sums[:, :3] / sums[:, 3:], np.float32)


def enlarged(faces: NDArray[Number], side: int) -> NDArray[Number]:
    """Return coarse texels as finer ones, without seams between faces.

    (6 · COARSE_PX², 3) → (6 · side, side, 3), where `side` is a multiple of `COARSE_PX`.
    """
    step, rimmed = side // COARSE_PX, faces[_rimmed_texels()]
    wide = (COARSE_PX + 2) * step
    stacked = np.concatenate(rimmed)
    large = cv2.resize(stacked, (wide, FACES * wide), interpolation=cv2.INTER_LINEAR)
    # What is mixed of two faces, one above the other, is cut off with the rims.
    inner = large.reshape(FACES, wide, wide, 3)[:, step:-step, step:-step]
    return np.asarray(inner.reshape(-1, side, 3), faces.dtype)


@cache
def _nearness() -> Floats:
    """Return how near each coarse texel is to each other one."""
    unit = directions(COARSE_PX)
    near = NEARNESS / (NEARNESS + 1.0 - unit @ unit.T)
    return np.asarray(near * near, np.float32)


@cache
def _rimmed_texels() -> Indices:
    """Return the numbers of the texels of each face with a rim of its neighbours'."""
    points = face_points(COARSE_PX, rim=1)
    return texels_at(points.reshape(-1, 3), COARSE_PX).reshape(points.shape[:3])
