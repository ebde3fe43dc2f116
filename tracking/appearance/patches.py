"""The white paper of a tracked cube: its light on each face that the camera sees."""

from dataclasses import dataclass

import cv2
import numpy as np

from cubeling.tracking.appearance.colour_space import LINEAR_FROM_SRGB
from cubeling.tracking.cube.faces import FacePlanes, face_frame
from cubeling.tracking.cube.icons import FOLD_GAP_SHARE, ICON_SHARE
from cubeling.tracking.cube.marker import cell_size, marker_cells
from cubeling.tracking.cube.model import CubeModel, Face
from cubeling.tracking.geometry.arrays import Array, Flags, Image, Indices
from cubeling.tracking.geometry.intrinsics import Intrinsics
from cubeling.tracking.geometry.projection import MIN_DEPTH, Projection

PAPER_ALBEDO = 0.82
"""Share of the light that printing paper reflects."""

POINTS_PER_FACE = 32
"""Sample points on the white of a face."""

TEXELS_PER_CELL = 12
"""Resolution at which places for them are searched on a face."""

MIN_COSINE = 0.2
"""Cosine of the viewing angle below which paper shines and its cells run into each other."""

MIN_CLEARANCE_PX = 1.2
"""Least distance of a sample from ink, as the camera sees it."""

MAX_VALUE = 250
"""8-bit value from which on a pixel may be saturated."""

PAPER_RANK = 0.3
"""Share of a face's samples that are brighter than the one that counts as its paper: what covers or
shades paper is nearly always darker."""

PAPER_SPREAD = 0.12
"""How far a sample of the same paper is from it, as a share."""

MIN_POINTS = 8
"""Least number of samples that agree on a face."""


@dataclass(frozen=True)
class Patches:
    """Paper of known orientation in one picture."""

    normals: Array
    """Outward unit normals in the camera's frame, (N, 3)."""

    irradiance: Array
    """Light that falls on each, linear RGB, (N, 3); 1 makes a white surface just white."""


class PaperSampler:
    """Measures the light on the faces of one cube, seen by one camera."""

    def __init__(self, cube: CubeModel, intrinsics: Intrinsics) -> None:
        self._projection = Projection(intrinsics)
        self._focal = float(self._projection.matrix[0, 0])
        self._planes = FacePlanes(cube)
        self._cell = cell_size(cube)
        places = [white_points(cube, face) for face in cube.faces]
        self._points = np.stack([points for points, _ in places])
        self._clearances = np.array([clearance for _, clearance in places])

    def measure(self, image: Image, camera_from_cube: Array) -> Patches:
        """Return the light on each face whose paper can be measured.

        Parameters
        ----------
        image
            The camera's picture, (H, W, 3) BGR.
        camera_from_cube
            Pose of the cube, (4, 4) [m].
        """
        rotation, origin = camera_from_cube[:3, :3], camera_from_cube[:3, 3]
        cosines = self._planes.cosines(camera_from_cube)
        clearance_px = self._clearances * cosines * (self._focal / max(origin[2], MIN_DEPTH))
        faces = np.flatnonzero((cosines > MIN_COSINE) & (clearance_px > MIN_CLEARANCE_PX))
        normals = self._planes.normals[faces] @ rotation.T
        points = self._points[faces].reshape(-1, 3) @ rotation.T + origin
        if not len(faces) or points[:, 2].min() < MIN_DEPTH:
            return Patches(np.empty((0, 3)), np.empty((0, 3)))
        pixels = np.rint(self._projection.project(points))
        return _patches(normals, image, np.asarray(pixels, np.intp))


def white_points(cube: CubeModel, face: Face) -> tuple[Array, float]:
    """Return places on the white of a face, far from ink and folds, and from each other.

    Returns
    -------
    Points in the cube's frame, (POINTS_PER_FACE, 3) [m], and the least distance of one from ink or
    a fold [m].
    """
    texel = cell_size(cube) / TEXELS_PER_CELL
    white = _white_texels(cube, face, texel)
    distance = cv2.distanceTransform(np.pad(white, 1).astype(np.uint8), cv2.DIST_L2, 5)[1:-1, 1:-1]
    least = min(0.42 * TEXELS_PER_CELL, float(np.quantile(distance[white], 0.8)))
    rows, columns = np.nonzero(distance >= least)
    # Each next point is the one farthest from those before it.
    places = np.stack([columns, rows], axis=1).astype(float)
    chosen = [0]
    nearest = np.full(len(places), np.inf)
    while len(chosen) < POINTS_PER_FACE:
        nearest = np.minimum(nearest, np.linalg.norm(places - places[chosen[-1]], axis=1))
        chosen.append(int(nearest.argmax()))
    flat = (places[chosen] + 0.5 - len(white) / 2) * texel
    frame = face_frame(face)
    return flat @ frame[:3, :2].T + frame[:3, 3], least * texel


def _white_texels(cube: CubeModel, face: Face, texel: float) -> Flags:
    """Return where a face is bare paper, (side, side), x to the marker's right and y down."""
    side = round(cube.paper / texel)
    place = np.abs((np.arange(side) + 0.5) * texel - side * texel / 2)
    cells = marker_cells(cube.dictionary, face.marker_id)
    margin = round((cube.paper - cube.marker_size) / 2 / texel)
    inner = np.arange(side - 2 * margin) * len(cells) // (side - 2 * margin)
    white = np.ones((side, side), bool)
    white[margin : side - margin, margin : side - margin] = ~cells[inner][:, inner]
    if face.icon:  # in the middle of each margin
        size = ICON_SHARE * (cube.paper - cube.marker_size) / 2
        high = cube.paper / 2 - FOLD_GAP_SHARE * (cube.paper - cube.marker_size) / 2
        across, along = place < size / 2, (place > high - size) & (place < high)
        white &= ~(across[:, None] & along | along[:, None] & across)
    return white


def _patches(normals: Array, image: Image, pixels: Indices) -> Patches:
    """Average the samples of each face that agree; `pixels` are those of all, (faces · N, 2)."""
    columns, rows = pixels.T
    height, width = image.shape[:2]
    seen = (columns >= 0) & (rows >= 0) & (columns < width) & (rows < height)
    values = image[np.where(seen, rows, 0), np.where(seen, columns, 0)]
    seen &= values.max(axis=1) < MAX_VALUE
    light = LINEAR_FROM_SRGB[values].reshape(len(normals), -1, 3)
    luminance = np.where(seen, light.sum(axis=2).ravel(), 0).reshape(len(normals), -1)
    ordered = np.sort(luminance, axis=1)
    rank = (seen.reshape(luminance.shape).sum(axis=1) * PAPER_RANK).astype(np.intp) + 1
    paper = ordered[np.arange(len(normals)), -rank][:, None]
    same = (np.abs(luminance - paper) < PAPER_SPREAD * paper).astype(float)
    count = same.sum(axis=1)
    mean = (same[:, None] @ light)[:, 0, ::-1] / np.maximum(count, 1)[:, None]
    kept = count >= MIN_POINTS
    return Patches(normals[kept], mean[kept] / PAPER_ALBEDO)
