"""The planes of the cube's faces, and which of them face the camera."""

import numpy as np

from cubeling.tracking.cube.model import CubeModel, Face
from cubeling.tracking.geometry import se3
from cubeling.tracking.geometry.arrays import Array


class FacePlanes:
    """The planes of the cube's faces, by their measured corners."""

    def __init__(self, cube: CubeModel) -> None:
        self.names = tuple(face.name for face in cube.faces)
        self.normals = np.stack([face.normal for face in cube.faces])
        """Outward unit normals, (faces, 3)."""
        self.centres = np.stack([face.corners.mean(axis=0) for face in cube.faces])
        """Centres of the markers, (faces, 3) [m]."""

    def cosines(self, camera_from_cube: Array) -> Array:
        """Cosine between each face's normal and its line of sight, (faces,): 1 is square on."""
        rotation, origin = camera_from_cube[:3, :3], camera_from_cube[:3, 3]
        sights = self.centres @ rotation.T + origin
        towards = -((self.normals @ rotation.T) * sights).sum(axis=1)
        return np.asarray(towards / np.sqrt((sights * sights).sum(axis=1)), np.float64)

    def faces_towards(self, camera_from_cube: Array, min_cosine: float) -> tuple[int, ...]:
        """Return the indices of the faces whose cosine is greater than `min_cosine`."""
        return tuple(np.flatnonzero(self.cosines(camera_from_cube) > min_cosine).tolist())

    def mirror(self, camera_from_cube: Array, face: int) -> Array:
        """Pose of the cube with one face tilted to the other side of its line of sight, (4, 4).

        The centre of the face stays where it is.
        """
        rotation = camera_from_cube[:3, :3]
        centre = rotation @ self.centres[face] + camera_from_cube[:3, 3]
        normal, back = rotation @ self.normals[face], -centre / np.linalg.norm(centre)
        axis = np.cross(normal, back)
        sine = float(np.linalg.norm(axis))
        angle = 2 * float(np.arctan2(sine, normal @ back))
        mirrored = se3.rotation(axis / max(sine, 1e-9) * angle) @ rotation
        return se3.pose(mirrored, centre - mirrored @ self.centres[face])


def face_frame(face: Face) -> Array:
    """Frame of a face, `cube_from_face` (4, 4): x to the marker's right, y down, z inward."""
    top_left, top_right, bottom_right, bottom_left = face.corners
    inward = -face.normal
    right = (top_right - top_left) + (bottom_right - bottom_left)
    right -= inward * (inward @ right)
    right /= np.linalg.norm(right)
    frame = np.eye(4)
    frame[:3, :3] = np.stack([right, np.cross(inward, right), inward], axis=1)
    frame[:3, 3] = face.corners.mean(axis=0)
    return frame
