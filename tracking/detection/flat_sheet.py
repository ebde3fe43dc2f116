"""Whether the markers of a cube lie on flat paper, as on its sheet before it is folded."""

from collections.abc import Sequence

import cv2
import numpy as np

from cubeling.tracking.detection.markers import Observation
from cubeling.tracking.geometry.arrays import Array

MIN_FLAT_FACES = 3
"""Markers that lie in one plane and belong to as many sides of the cube are on a sheet. Two sides
of a cube look like that, too, where both lean alike and are far away."""

MAX_MISFIT = 0.1
"""A marker lies in the plane of another one if, seen square on with that, it is a square of its
size to this share of the side. Three sides of a cube miss that by 0.29, of a dodecahedron by 0.13.
"""

MIN_FOLD_COSINE = np.cos(np.deg2rad(50))
"""Faces whose normals are closer than this count as one side: those of an icosahedron, 42°
apart, look nearly flat when it is whole."""

SQUARE = np.array([(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)])
"""A marker seen square on, in the order of `Observation.corners`, with a side of 1."""


def lie_flat(observations: Sequence[Observation]) -> bool:
    """Whether markers of several sides of a cube lie in one plane, which no folded cube shows."""
    if len({seen.face.name for seen in observations}) < MIN_FLAT_FACES:
        return False
    normals = np.stack([seen.face.normal for seen in observations])
    corners = np.concatenate([seen.corners for seen in observations])
    return any(
        _side_count(normals[_misfits(seen, corners) < MAX_MISFIT]) >= MIN_FLAT_FACES
        for seen in observations
    )


def _misfits(seen: Observation, corners: Array) -> Array:
    """How far markers, (N · 4, 2), are from squares of the same size in the plane of one, (N,)."""
    plane = cv2.getPerspectiveTransform(seen.corners.astype(np.float32), SQUARE.astype(np.float32))
    flat = np.c_[corners, np.ones(len(corners))] @ plane.T
    # What lies behind the horizon of that plane is not in it.
    ahead = (flat[:, 2] > 1e-9).reshape(-1, 4).all(axis=1)
    x, y = (flat[:, :2] / np.where(flat[:, 2:] > 1e-9, flat[:, 2:], 1.0)).reshape(-1, 4, 2).T
    # As complex numbers, a turn is a factor of length 1.
    places = (x + 1j * y).T
    places -= places.mean(axis=1)[:, None]
    wanted = SQUARE @ (1, 1j)
    turn = places @ wanted.conj()
    turn /= np.maximum(np.abs(turn), 1e-9)
    away = np.abs(places - turn[:, None] * wanted)
    return np.where(ahead, np.sqrt(np.square(away).mean(axis=1)), np.inf)


def _side_count(normals: Array) -> int:
    """Count the directions of normals, (N, 3)."""
    kept: list[Array] = []
    for normal in normals:
        if not any(normal @ other > MIN_FOLD_COSINE for other in kept):
            kept.append(normal)
    return len(kept)
