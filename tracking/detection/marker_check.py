"""Reading of marker cells at a given pose, to check that it shows the cube."""

from dataclasses import dataclass

import numpy as np

from cubeling.tracking.cube.faces import FacePlanes
from cubeling.tracking.cube.marker import marker_cells
from cubeling.tracking.cube.model import CubeModel
from cubeling.tracking.geometry.arrays import Array, Flags, Floats
from cubeling.tracking.geometry.image_region import Patch
from cubeling.tracking.geometry.projection import Projection
from cubeling.tracking.geometry.robust_statistics import quantile

MIN_FACING_COSINE = 0.2
"""Cosine of the viewing angle below which a marker's cells are too foreshortened to be read."""

MIN_CONTRAST = 3.0
"""A marker with less contrast than this [grey levels] is not read."""

UNREAD_BAND = 0.12
"""A cell closer to the middle between black and white than this share of the contrast is unread."""


@dataclass(frozen=True)
class CellReading:
    """The cells of the markers at a pose."""

    agreement: dict[str, float]
    """Share of the cells of each face in view that are black or white as expected, 0…1."""

    @property
    def best(self) -> float:
        """The greatest share of any face; 0 where no face is in view."""
        return max(self.agreement.values(), default=0.0)


class CellReader:
    """Reads the marker cells of one cube seen by one camera."""

    def __init__(self, cube: CubeModel, projection: Projection) -> None:
        self._faces = FacePlanes(cube)
        self._projection = projection
        patterns = [marker_cells(cube.dictionary, face.marker_id) for face in cube.faces]
        self._white = np.stack([~pattern.ravel() for pattern in patterns])
        count = len(patterns[0])
        steps = (np.arange(count) + 0.5) / count
        x, y = (axis.ravel()[:, None] for axis in np.meshgrid(steps, steps))
        self._centres = np.stack(
            [
                corners[0] + x * (corners[1] - corners[0]) + y * (corners[3] - corners[0])
                for corners in (face.corners for face in cube.faces)
            ]
        )

    def read(self, patch: Patch, camera_from_cube: Array) -> CellReading:
        """Read all markers that face the camera."""
        facing = list(self._faces.faces_towards(camera_from_cube, MIN_FACING_COSINE))
        if not facing:
            return CellReading({})
        points = self._centres[facing].reshape(-1, 3)
        points = points @ camera_from_cube[:3, :3].T + camera_from_cube[:3, 3]
        pixels = self._projection.project(points)
        count = len(self._white[0])
        values = patch.sample(pixels[:, None])[:, 0].reshape(-1, count)
        inside = (patch.border_distance(pixels) > 0).reshape(-1, count)
        return CellReading(
            {
                self._faces.names[number]: _agreement(value[seen], self._white[number][seen])
                for number, value, seen in zip(facing, values, inside, strict=True)
                if np.count_nonzero(seen) > count // 2
            }
        )


def _agreement(value: Floats, white: Flags) -> float:
    bright, dark = value[white], value[~white]
    if not len(bright) or not len(dark):
        return 0.0
    high, low = quantile(bright, 0.5), quantile(dark, 0.5)
    middle, band = (high + low) / 2, UNREAD_BAND * (high - low)
    if high - low < MIN_CONTRAST:
        return 0.0
    right = np.count_nonzero(bright > middle + band) + np.count_nonzero(dark < middle - band)
    return right / len(value)
