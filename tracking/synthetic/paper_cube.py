"""The printed cube, drawn exactly: every sample looks along its ray at the plane of a face."""

import cv2
import numpy as np
from numpy.typing import NDArray

from tracking.cube.icons import ICONS, INK, icon_mask
from tracking.cube.marker import marker_cells
from tracking.cube.model import FACE_AXES, CubeModel, Face
from tracking.synthetic.folding import placements
from tracking.synthetic.lens import Lens, Region, averaged

Array = NDArray[np.float64]
Picture = NDArray[np.float32]

TEXELS = 640
"""Samples along the edge of a face's picture."""

LEVELS = 4
"""How many times a face is kept, each half as fine as the one before."""

WHITE, BLACK = 232.0, 26.0
"""Paper and toner in the camera's grey levels at full light."""

TO_LIGHT = np.array([-0.42, 0.82, 0.40])
"""Direction from the table to the lamp, in the table frame."""

AMBIENT = 0.60
"""Share of the light that comes from everywhere."""


class PaperCube:
    """Draws one cube.

    Parameters
    ----------
    cube
        The cube.
    lens
        The camera.
    seed
        Of the paper's grain.
    """

    def __init__(self, cube: CubeModel, lens: Lens, seed: int) -> None:
        self.cube = cube
        self._lens = lens
        random = np.random.default_rng(seed)
        by_name = {face.name: face for face in cube.faces}
        self._askew = placements(cube)
        self._pictures = {
            name: _halved(face_picture(cube, by_name.get(name), random)) for name in FACE_AXES
        }

    def corners(self, camera_from_cube: Array) -> Array:
        """Return the cube's eight corners in the camera frame, (8, 3)."""
        half = self.cube.edge / 2
        signs = np.array(np.meshgrid([-1, 1], [-1, 1], [-1, 1])).reshape(3, -1).T
        return half * signs @ camera_from_cube[:3, :3].T + camera_from_cube[:3, 3]

    def region(self, camera_from_cube: Array, margin: float = 4.0) -> Region:
        """Return the part of the picture that the cube covers."""
        corners = self.corners(camera_from_cube)
        if (corners[:, 2] < 0.02).any():
            return Region(0, 0, 0, 0)
        if self._askew:  # a face may stick out by some millimetres
            margin += 0.1 * float(np.ptp(self._lens.pixels(corners), axis=0).max())
        return self._lens.around(self._lens.pixels(corners), margin)

    def depth(self, region: Region, camera_from_cube: Array) -> Picture:
        """Return how far the cube's surface is, (h, w) [m]; infinite where there is no cube."""
        rays = self._lens.rays(region, 1)
        enters = np.zeros(rays.shape[:2], np.float32)
        leaves = np.full(rays.shape[:2], np.inf, np.float32)
        for axis in range(3):
            for sign in (1.0, -1.0):
                normal = sign * camera_from_cube[:3, axis]
                offset = float(normal @ camera_from_cube[:3, 3]) + self.cube.edge / 2
                slope = rays @ normal[:2].astype(np.float32) + np.float32(normal[2])
                reach = np.float32(offset) / np.where(slope == 0, np.float32(1e-9), slope)
                np.maximum(enters, np.where(slope < 0, reach, 0.0), out=enters)
                np.minimum(leaves, np.where(slope < 0, np.inf, reach), out=leaves)
        return np.where(enters < leaves, enters, np.float32(np.inf))

    def draw(
        self, region: Region, poses: list[Array], up: Array, finer: int
    ) -> tuple[Picture, Picture]:
        """Draw the cube as seen while the shutter is open.

        Parameters
        ----------
        region
            Which part of the picture.
        poses
            `camera_from_cube` at moments spread evenly over the exposure.
        up
            Direction to the lamp in the camera frame, (3,).
        finer
            Samples along a pixel.

        Returns
        -------
        Colour (h, w, 3) BGR, times coverage; and coverage (h, w, 1), 0…1.
        """
        rays = self._lens.rays(region, finer)
        sums = np.zeros((region.height, region.width, 4), np.float32)
        for pose in poses:
            sums += averaged(self._samples(rays, pose, up, finer), finer)
        sums /= len(poses)
        return sums[..., :3], sums[..., 3:]

    def _samples(self, rays: Picture, pose: Array, to_light: Array, finer: int) -> Picture:
        shown = np.zeros((*rays.shape[:2], 4), np.float32)
        for name, (right, up) in FACE_AXES.items():
            axes = pose[:3, :3] @ np.array([right, up, np.cross(right, up)], float).T
            center = pose[:3, 3] + axes[:, 2] * self.cube.edge / 2
            if name in self._askew:
                turn, place = self._askew[name]
                axes = pose[:3, :3] @ turn @ np.array([right, up, np.cross(right, up)], float).T
                center = pose[:3, 3] + pose[:3, :3] @ place
            if axes[:, 2] @ center >= 0:
                continue  # it looks away
            self._face(shown, rays, axes, center, self._chosen(name, center, finer), to_light)
        return shown

    def _chosen(self, name: str, center: Array, finer: int) -> Picture:
        """Pick the picture of a face that has about one texel for each sample.

        A finer one would be sampled between its edges, which then snap to the samples.
        """
        focal = self._lens.intrinsics.matrix[0, 0] * finer
        samples = focal * self.cube.edge / float(np.linalg.norm(center))
        level = int(np.clip(np.ceil(np.log2(TEXELS / samples)), 0, LEVELS - 1))
        return self._pictures[name][level]

    def _face(
        self, shown: Picture, rays: Picture, axes: Array, center: Array, face: Picture, light: Array
    ) -> None:
        """Add one face: texel = homography · ray."""
        plane = np.column_stack([axes[:, 0], -axes[:, 1], center])
        texels = len(face)
        scale, middle = texels / self.cube.edge, texels / 2 - 0.5
        to_texel = np.array([[scale, 0, middle], [0, scale, middle], [0, 0, 1]])
        matrix = (to_texel @ np.linalg.inv(plane)).astype(np.float32)
        flat = rays @ matrix[:, :2].T + matrix[:, 2]
        with np.errstate(divide="ignore", invalid="ignore"):  # rays along the face's plane
            x, y = flat[..., 0] / flat[..., 2], flat[..., 1] / flat[..., 2]
        end = texels - 0.5
        inside = (x >= -0.5) & (x < end) & (y >= -0.5) & (y < end)
        rows = np.flatnonzero(inside.any(axis=1))
        if not len(rows):
            return
        columns = np.flatnonzero(inside.any(axis=0))
        box = np.s_[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1]
        seen = cv2.remap(face, x[box], y[box], cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
        normal = axes[:, 2]
        brightness = AMBIENT + (1 - AMBIENT) * max(0.0, float(normal @ light))
        mask = inside[box]
        part = shown[box]
        part[mask, :3] = seen[mask] * np.float32(brightness)
        part[mask, 3] = 1.0


def face_picture(cube: CubeModel, face: Face | None, random: np.random.Generator) -> Picture:
    """Draw what is printed on a face, (TEXELS, TEXELS, 3) BGR grey levels; None is blank paper."""
    grain = random.standard_normal((TEXELS // 8, TEXELS // 8)).astype(np.float32)
    paper = cv2.resize(grain, (TEXELS, TEXELS), interpolation=cv2.INTER_CUBIC) * 1.2 + WHITE
    tint = np.array([0.985, 0.995, 1.0], np.float32)
    picture = np.asarray(np.asarray(paper)[..., None] * tint, np.float32)
    if face is not None:
        _print_marker(picture, cube, face)
        _print_icon(picture, cube, face)
    # Folded edges catch the light unevenly: a thin darker rim.
    rim = max(1, TEXELS // 160)
    for side in (np.s_[:rim], np.s_[-rim:], np.s_[:, :rim], np.s_[:, -rim:]):
        picture[side] *= 0.90
    return picture


def _halved(picture: Picture) -> list[Picture]:
    levels = [picture]
    for level in range(1, LEVELS):
        size = (TEXELS >> level, TEXELS >> level)
        small = cv2.resize(picture, size, interpolation=cv2.INTER_AREA)
        levels.append(np.asarray(small, np.float32))
    return levels


def _print_marker(picture: Picture, cube: CubeModel, face: Face) -> None:
    cells = np.rot90(marker_cells(cube.dictionary, face.marker_id), -(face.roll_deg // 90))
    texel = (np.arange(TEXELS) + 0.5) / TEXELS * cube.edge - cube.edge / 2
    place = (texel + cube.marker_size / 2) / cube.marker_size * len(cells)
    inside = (place >= 0) & (place < len(cells))
    index = np.clip(place.astype(int), 0, len(cells) - 1)
    black = cells[index][:, index] & inside[:, None] & inside
    picture[black] = BLACK


def _print_icon(picture: Picture, cube: CubeModel, face: Face) -> None:
    margin = (cube.edge - cube.marker_size) / 2 / cube.edge * TEXELS
    size = int(0.72 * margin)
    if face.icon not in ICONS or size < 8:
        return
    ink = np.array(INK.get(face.icon, (60, 60, 60))[::-1], np.float32)
    mask = icon_mask(face.icon, size).astype(np.float32)[..., None] / 255
    top, left = TEXELS - int((margin + size) / 2), (TEXELS - size) // 2
    part = picture[top : top + size, left : left + size]
    part += (ink - part) * mask
