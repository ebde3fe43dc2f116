"""Where a cube at a pose appears in the image, and how large."""

import math

import numpy as np

from cubeling.tracking.cube.marker import cell_size
from cubeling.tracking.cube.model import CubeModel
from cubeling.tracking.geometry.arrays import Array, Floats, Image
from cubeling.tracking.geometry.image_region import Patch, Region
from cubeling.tracking.geometry.projection import MIN_DEPTH, Projection

MARGIN_SHARE, MARGIN_PX = 0.15, 12
"""Margin for the acceleration of a hand: a share of the cube's size, and [px] besides."""

MIN_REGION_PX = 32
"""The cube is not searched in a region narrower or lower than this."""


class Footprint:
    """The image region and the image scale of one cube seen by one camera."""

    def __init__(self, cube: CubeModel, projection: Projection) -> None:
        self._projection = projection
        self._focal_px = float(projection.matrix[0, 0])
        corners = cube.vertices
        markers = [face.corners for face in cube.faces]
        outside = np.abs(np.concatenate(markers)).max() > np.abs(corners).max()
        self._corners = np.concatenate([corners, *markers]) if outside else corners
        self.half_edge = cube.edge / 2
        """Half the edge of the cube [m]."""
        self.cell = cell_size(cube)
        """Edge of a marker's cell [m]."""

    def metres_per_pixel(self, camera_from_cube: Array) -> float:
        """Length at the cube's distance that one pixel covers [m]."""
        return float(camera_from_cube[2, 3]) / self._focal_px

    def pixels_per_cell(self, camera_from_cube: Array) -> float:
        """Size of a marker's cell that faces the camera [px]."""
        return self.cell * self._focal_px / float(camera_from_cube[2, 3])

    def blur_extent(self, blur_motion: Array) -> float:
        """Return how far an edge of the cube moves at most during the exposure [cells]."""
        x, y, z, *turn = blur_motion.tolist()
        return (math.hypot(x, y, z) + self.half_edge * math.hypot(*turn)) / self.cell

    def crop(self, image: Image, camera_from_cube: Array, tone: Floats) -> Patch | None:
        """Do `Patch.crop` with the region of the cube at a pose; None where it is not in view."""
        region = self.region(camera_from_cube)
        return Patch.crop(image, region, tone) if region else None

    def region(self, camera_from_cube: Array) -> Region | None:
        """Bounds of the cube at a pose with a margin; None where it is not in view."""
        points = self._corners @ camera_from_cube[:3, :3].T + camera_from_cube[:3, 3]
        if points[:, 2].min() < MIN_DEPTH:
            return None
        pixels = self._projection.project(points)
        low, high = pixels.min(axis=0), pixels.max(axis=0)
        margin = MARGIN_SHARE * float((high - low).max()) + MARGIN_PX
        width, height = self._projection.size
        left, top = max(0, int(low[0] - margin)), max(0, int(low[1] - margin))
        right = min(width, int(high[0] + margin + 1))
        bottom = min(height, int(high[1] + margin + 1))
        if right - left < MIN_REGION_PX or bottom - top < MIN_REGION_PX:
            return None
        return left, top, right, bottom
