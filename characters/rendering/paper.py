"""The real cubes as light meters: white paper whose place in the picture is known."""

import numpy as np
from numpy.typing import NDArray

from characters.rendering.light import DECODED, LUMA
from characters.rendering.projection import NEAR, is_rigid
from characters.rendering.scene import Box, View

Array = NDArray[np.float64]

GRID = 12
"""Places to look at along each side of a face."""

WHITEST = 0.9
"""Quantile of a face's brightness that is its paper: most of a face is a black marker."""

_AXIS = (np.arange(GRID) + 0.5) / GRID - 0.5
_FLAT = np.stack([*np.meshgrid(_AXIS, _AXIS), np.full((GRID, GRID), 0.5)], axis=-1).reshape(-1, 3)
FACES = np.stack([sign * np.roll(_FLAT, axis, axis=1) for axis in range(3) for sign in (1, -1)])
"""Places on the six faces of a cube of edge one, (6, places, 3)."""


def paper_of(picture: NDArray[np.uint8], matrix: Array, view: View) -> Array | None:
    """Return the linear RGB (3,) of the brightest visible face of a cube, or None.

    Parameters
    ----------
    picture
        Straightened, (height, width, 3) BGR.
    matrix
        Its pinhole matrix, (3, 3) [px].
    view
        Whose occluders are the cubes.
    """
    faces = [face for box in view.occluders for face in _faces(picture, matrix, box)]
    return max(faces, key=lambda face: float(face @ LUMA), default=None)


def _faces(picture: NDArray[np.uint8], matrix: Array, box: Box) -> list[Array]:
    """Return the paper of each face of a cube that is turned to the camera and wholly in view."""
    if not is_rigid(box.camera_from_box) or not np.isfinite(box.edge):
        return []
    pose = np.asarray(box.camera_from_box, float)
    places = box.edge * FACES @ pose[:3, :3].T + pose[:3, 3]
    outward = places.mean(axis=1) - pose[:3, 3]
    facing = np.einsum("ij,ij->i", outward, places.mean(axis=1)) < 0.0
    seen = places[facing & (places[:, :, 2] > NEAR).all(axis=1)]
    at = np.rint((seen / seen[..., 2:]) @ matrix[:2].T).astype(int)
    inside = ((at >= 0) & (at < [picture.shape[1], picture.shape[0]])).all(axis=(1, 2))
    papers = []
    for column, row in at[inside].transpose(0, 2, 1):
        colors = DECODED[picture[row, column, ::-1]]
        bright = colors @ LUMA
        papers.append(colors[bright >= np.quantile(bright, WHITEST)].mean(axis=0))
    return papers
