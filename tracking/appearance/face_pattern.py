"""The print of the cube's visible faces as a camera should see it at a pose."""

from dataclasses import dataclass

import cv2
import numpy as np

from tracking.cube.faces import FacePlanes
from tracking.cube.icons import FOLD_GAP_SHARE, ICON_SHARE, icon_mask, icons
from tracking.cube.marker import black_texels, marker_cells
from tracking.cube.model import CubeModel, Face
from tracking.geometry.arrays import Array, Flags, Floats, Image
from tracking.geometry.projection import Projection

FACE_TEXELS = 96
"""Texels along the edge of a face's print."""

MIN_COSINE = 0.2
"""Cosine of the viewing angle from which on a face is compared."""

INK, ICON, PAPER = 0, 1, 2
"""Channels of a print: black, coloured icon, and the whole face."""


@dataclass(frozen=True)
class SeenPattern:
    """The print of all visible faces in a window of the image."""

    face: Image
    """Number of the face + 1 at each pixel, 0 outside the cube, (h, w)."""

    ink: Floats
    """Share of black, 0…1, (h, w)."""

    icon: Flags
    """Where a coloured icon is near, (h, w)."""

    def cropped(self, box: tuple[slice, slice]) -> "SeenPattern":
        """Return some rows and columns of it."""
        return SeenPattern(self.face[box], self.ink[box], self.icon[box])


class FacePattern:
    """Draws the print of one cube's faces for one camera."""

    def __init__(self, cube: CubeModel, projection: Projection) -> None:
        self._cube, self._projection = cube, projection
        self._planes = FacePlanes(cube)
        self._prints = [_print(cube, face) for face in cube.faces]
        grow = cube.edge / cube.marker_size
        middles = [face.corners.mean(axis=0) for face in cube.faces]
        self._quads = [
            middle + grow * (face.corners - middle)
            for face, middle in zip(cube.faces, middles, strict=True)
        ]

    def seen(
        self, camera_from_cube: Array, origin: Array, scale: float, size: tuple[int, int]
    ) -> SeenPattern:
        """Draw the faces at a pose into a window.

        Parameters
        ----------
        camera_from_cube
            Pose, (4, 4).
        origin
            Upper left corner of the window in the image [px], (2,): of the pixel, not its centre.
        scale
            Pixels of the image per pixel of the window.
        size
            Width and height of the window [px of the window].
        """
        width, height = size
        label = np.zeros((height, width), np.uint8)
        shown = np.zeros((height, width, 3), np.uint8)
        corners = np.array([(0, 0), (1, 0), (1, 1), (0, 1)], np.float32) * FACE_TEXELS - 0.5
        for number in self._planes.facing(camera_from_cube, MIN_COSINE):
            points = self._quads[number] @ camera_from_cube[:3, :3].T + camera_from_cube[:3, 3]
            pixels = (self._projection.project(points) + 0.5 - origin) / scale - 0.5
            low = np.maximum(np.floor(pixels.min(axis=0)).astype(int) - 1, 0)
            high = np.minimum(np.ceil(pixels.max(axis=0)).astype(int) + 2, size)
            if (high <= low).any():
                continue
            flat = (pixels - low).astype(np.float32)
            matrix = cv2.getPerspectiveTransform(corners, flat)
            box = np.s_[low[1] : high[1], low[0] : high[0]]
            print_ = cv2.warpPerspective(self._prints[number], matrix, tuple((high - low).tolist()))
            inside = print_[..., PAPER] > 127
            shown[box][inside] = print_[inside]
            label[box][inside] = number + 1
        near_icon = cv2.dilate(shown[..., ICON], np.ones((5, 5), np.uint8)) > 12
        return SeenPattern(label, np.asarray(shown[..., INK] / 255, np.float32), near_icon)

    def distance(self, camera_from_cube: Array, face: Image, origin: Array, scale: float) -> float:
        """Return the least distance along the camera's axis of some pixels of faces [m].

        `face` is that of `SeenPattern`, 0 where a pixel does not count, one at least does; the
        others are as in `seen`. Lens distortion hardly matters and is ignored.
        """
        rows, columns = np.nonzero(face)
        pixels = (np.stack([columns, rows], axis=1) + 0.5) * scale + origin - 0.5
        matrix = self._projection.matrix
        rays = np.ones((len(pixels), 3))
        rays[:, :2] = (pixels - matrix[:2, 2]) / matrix[[0, 1], [0, 1]]
        number = face[rows, columns].astype(np.intp) - 1
        rotation, shift = camera_from_cube[:3, :3], camera_from_cube[:3, 3]
        normals = self._planes.normals @ rotation.T
        offsets = (normals * (self._planes.centres @ rotation.T + shift)).sum(axis=1)
        slopes = (rays * normals[number]).sum(axis=1)
        return float((offsets[number] / slopes).min())


def _print(cube: CubeModel, face: Face) -> Image:
    """Draw the print of a face, marker upright, (FACE_TEXELS, FACE_TEXELS, 3)."""
    sheet = np.zeros((FACE_TEXELS, FACE_TEXELS, 3), np.uint8)
    sheet[..., PAPER] = 255
    fine = black_texels(cube, marker_cells(cube.dictionary, face.marker_id), 8 * FACE_TEXELS)
    shares = cv2.resize(fine.astype(np.float32), (FACE_TEXELS,) * 2, interpolation=cv2.INTER_AREA)
    sheet[..., INK] = np.rint(255 * shares)
    margin = (cube.edge - cube.marker_size) / 2 / cube.edge * FACE_TEXELS
    size = round(ICON_SHARE * margin)
    if face.icon in icons() and size > 0:
        top = FACE_TEXELS - round(FOLD_GAP_SHARE * margin) - size
        left = (FACE_TEXELS - size) // 2
        mask = icon_mask(face.icon, size)
        for quarter_turns in range(4):
            part = np.rot90(sheet, quarter_turns)
            part[top : top + size, left : left + size, ICON] = mask
    return sheet
