"""A cube that was folded by hand: each face a little off its place, and turned."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from tracking.cube.model import CubeModel, face_corners
from tracking.geometry import se3

Array = NDArray[np.float64]


def folded(cube: CubeModel, millimetres: float, seed: int) -> CubeModel:
    """Return the cube with each face off by up to so many millimetres and degrees on each axis."""
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


def placements(cube: CubeModel) -> dict[str, tuple[Array, Array]]:
    """Return turn (3, 3) and centre (3,) of each face that is not where it should be."""
    found = {}
    for face in cube.faces:
        ideal = face_corners(face.name, face.roll_deg, cube.marker_size, cube.edge)
        if np.abs(face.corners - ideal).max() > 1e-9:
            should, does = _axes(ideal), _axes(face.corners)
            found[face.name] = does @ should.T, face.corners.mean(axis=0)
    return found


def _axes(corners: Array) -> Array:
    """Columns right, up and out of a square of corners (4, 3) in the order of `Face.corners`."""
    right, up = corners[1] - corners[0], corners[0] - corners[3]
    right, up = right / np.linalg.norm(right), up / np.linalg.norm(up)
    return np.stack([right, up, np.cross(right, up)], axis=1)
