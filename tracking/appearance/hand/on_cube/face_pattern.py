"""The print of the cube's visible faces as a camera should see it at a pose."""

from dataclasses import dataclass

import cv2
import numpy as np

from cubeling.tracking.cube.faces import FacePlanes
from cubeling.tracking.cube.icons import FOLD_GAP_SHARE, ICON_SHARE, icon_mask, icons
from cubeling.tracking.cube.marker import black_texels, marker_cells
from cubeling.tracking.cube.model import CubeModel, Face
from cubeling.tracking.geometry.arrays import Array, Flags, Image
from cubeling.tracking.geometry.projection import Projection

FACE_TEXELS = 96
"""Texels along the edge of a face's print."""

PRINT_CORNERS = np.array([(0, 0), (1, 0), (1, 1), (0, 1)], np.float32) * FACE_TEXELS - 0.5
"""Corners of a face's print, (4, 2) [texels]."""

MIN_COSINE = 0.2
"""Cosine of the viewing angle from which on a face is compared."""

INK, ICON, NUMBER = 0, 1, 2
"""Channels of a print: black, near a coloured icon, and the number of the face + 1."""


NEAR_ICON = np.ones((9, 9), np.uint8)
"""Texels around an icon that may have its colour."""


@dataclass(frozen=True)
class SeenPattern:
    """The print of all faces that the camera sees well enough, in a part of the image."""

    numbers: tuple[int, ...]
    """Numbers of the faces that the camera sees well enough, + 1."""

    face: Image
    """Number of the face + 1 at each pixel, 0 outside the cube, (h, w)."""

    ink: Image
    """Share of black, 0…255, (h, w)."""

    icon: Flags
    """Where a coloured icon is near, (h, w)."""


class FacePattern:
    """Draws the print of one cube's faces for one camera."""

    def __init__(self, cube: CubeModel, projection: Projection) -> None:
        self._cube, self._projection = cube, projection
        self._planes = FacePlanes(cube)
        self._prints = [_print(cube, face, n) for n, face in enumerate(cube.faces, 1)]
        grow = cube.paper / cube.marker_size
        corners = np.stack([face.corners for face in cube.faces])
        middles = corners.mean(axis=1, keepdims=True)
        self.corners = middles + grow * (corners - middles)
        """Corners of the faces' prints, (faces, 4, 3) [m]."""

    def draw(self, camera_from_cube: Array, quads: Array, size: tuple[int, int]) -> SeenPattern:
        """Draw the faces at a pose into a part of the image.

        Parameters
        ----------
        camera_from_cube
            Pose, (4, 4).
        quads
            Where `corners` are in the part, (faces, 4, 2) [px of it].
        size
            Width and height of the part [px].
        """
        shown = np.zeros((size[1], size[0], 3), np.uint8)
        facing = self._planes.faces_towards(camera_from_cube, MIN_COSINE)
        corners = quads.astype(np.float32)
        for number in facing:
            matrix = cv2.getPerspectiveTransform(PRINT_CORNERS, corners[number])
            border = cv2.BORDER_TRANSPARENT
            cv2.warpPerspective(self._prints[number], matrix, size, shown, borderMode=border)
        ink, icon, face = (np.asarray(channel, np.uint8) for channel in cv2.split(shown))
        return SeenPattern(tuple(number + 1 for number in facing), face, ink, icon > 0)

    def nearest(self, camera_from_cube: Array, face: Image, origin: Array, scale: float) -> Array:
        """Return the nearest point along the camera's axis in some pixels of faces, (3,) [m].

        `face` is that of `SeenPattern`, 0 where a pixel does not count, one at least does; `origin`
        is the upper left corner of its part in the image, (2,) [px], of the pixel and not its
        centre; `scale` is the size of its pixels. Lens distortion hardly matters and is ignored.
        """
        rotation, shift = camera_from_cube[:3, :3], camera_from_cube[:3, 3]
        normals = self._planes.normals @ rotation.T
        offsets = (normals * (self._planes.centres @ rotation.T + shift)).sum(axis=1)
        matrix = self._projection.matrix
        focal, first = matrix[[0, 1], [0, 1]], origin + (scale - 1) / 2 - matrix[:2, 2]
        # One over the distance is linear in row and column on each face.
        slopes = normals / offsets[:, None]
        slopes[:, 2] += slopes[:, :2] @ (first / focal)
        slopes[:, :2] *= scale / focal
        rows, columns = np.nonzero(face)
        along, down, at_first = slopes[face[rows, columns] - 1].T
        inverse = along * columns + down * rows + at_first
        best = int(inverse.argmax())
        right, below = (first + scale * np.array([columns[best], rows[best]])) / focal
        return np.asarray(np.array([right, below, 1.0]) / inverse[best], np.float64)


def _print(cube: CubeModel, face: Face, number: int) -> Image:
    """Draw the print of a face, marker upright, (FACE_TEXELS, FACE_TEXELS, 3)."""
    sheet = np.zeros((FACE_TEXELS, FACE_TEXELS, 3), np.uint8)
    sheet[..., NUMBER] = number
    cells = marker_cells(cube.dictionary, face.marker_id)
    fine = black_texels(cube, cells, 8 * FACE_TEXELS, cube.paper)
    shares = cv2.resize(fine.astype(np.float32), (FACE_TEXELS,) * 2, interpolation=cv2.INTER_AREA)
    sheet[..., INK] = np.rint(255 * shares)
    margin = (cube.paper - cube.marker_size) / 2 / cube.paper * FACE_TEXELS
    size = round(ICON_SHARE * margin)
    if face.icon in icons() and size > 0:
        top = FACE_TEXELS - round(FOLD_GAP_SHARE * margin) - size
        left = (FACE_TEXELS - size) // 2
        mask = icon_mask(face.icon, size)
        for quarter_turns in range(4):
            part = np.rot90(sheet, quarter_turns)
            part[top : top + size, left : left + size, ICON] = mask
    sheet[..., ICON] = cv2.dilate(sheet[..., ICON], NEAR_ICON)
    return sheet
