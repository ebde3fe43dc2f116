"""The pose of the cube from the corners of all its markers, as users of OpenCV find it."""

from collections.abc import Sequence

import cv2
import numpy as np
from numpy.typing import ArrayLike

from tests.bench.tracking.rivals.serving import Array, Scene


def cube_pose(scene: Scene, ids: Sequence[int], corners: Sequence[ArrayLike]) -> Array | None:
    """Solve for the pose from all corners at once: SQPNP, then Levenberg and Marquardt.

    Parameters
    ----------
    scene
        The camera and the cube.
    ids
        Of the markers found; those that are not on the cube are left out.
    corners
        Of each marker, (4, 2) [px].

    Returns
    -------
    camera_from_cube, (4, 4) [m]; None where no marker of the cube was found.
    """
    known = [(number, square) for number, square in zip(ids, corners, strict=True)
             if number in scene.corners]  # fmt: skip
    if not known:
        return None
    places = np.concatenate([scene.corners[number] for number, _ in known])
    pixels = np.concatenate([np.reshape(square, (4, 2)) for _, square in known]).astype(np.float64)
    camera = (scene.matrix, scene.distortion)
    solved, turn, shift = cv2.solvePnP(places, pixels, *camera, flags=cv2.SOLVEPNP_SQPNP)
    if not solved:
        return None
    turn, shift = cv2.solvePnPRefineLM(places, pixels, *camera, turn, shift)
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = cv2.Rodrigues(turn)[0], np.ravel(shift)
    return pose
