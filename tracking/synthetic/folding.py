"""Folding errors of a hand-made cube: each face is slightly shifted and rotated."""

from dataclasses import replace

import numpy as np

from cubeling.tracking.cube.model import CubeModel
from cubeling.tracking.geometry import se3
from cubeling.tracking.geometry.arrays import Array


def fold_cube(cube: CubeModel, millimetres: float, seed: int) -> CubeModel:
    """Return the cube with each face off by up to this many mm and degrees about each axis."""
    if millimetres == 0:
        return cube
    random = np.random.default_rng([seed, 11])
    faces = []
    for face in cube.faces:
        shift = random.uniform(-1, 1, 3) * millimetres / 1000
        turn = se3.rotation(np.deg2rad(random.uniform(-1, 1, 3) * millimetres))
        centre = face.corners.mean(axis=0)
        corners = (face.corners - centre) @ turn.T + centre + shift
        faces.append(replace(face, corners=corners))
    return replace(cube, faces=tuple(faces))


def face_poses(cube: CubeModel) -> dict[str, tuple[Array, Array]]:
    """Return rotation (3, 3) and centre (3,) of each face that is off its nominal pose."""
    found = {}
    for face in cube.faces:
        ideal = cube.designed_corners(face)
        if np.abs(face.corners - ideal).max() > 1e-9:
            nominal, actual = _axes(ideal), _axes(face.corners)
            found[face.name] = actual @ nominal.T, face.corners.mean(axis=0)
    return found


def _axes(corners: Array) -> Array:
    """Return columns right, up and out of a square, corners (4, 3) as in `Face.corners`."""
    right, up = corners[1] - corners[0], corners[0] - corners[3]
    right, up = right / np.linalg.norm(right), up / np.linalg.norm(up)
    return np.stack([right, up, np.cross(right, up)], axis=1)
