"""Reading of marker cells at a given pose, to check that it shows the cube."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cubeling.tracking.cube.faces import FacePlanes
from cubeling.tracking.cube.marker import marker_cells, turned_markers
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

MIN_LIKENESS, MIN_OTHER = 0.6, 0.95
"""A face that agrees by less than the first share of its cells is covered, or is none. By the
second one of its cells, it is a marker: two of a dictionary agree by up to nine tenths of them."""

Readings = NDArray[np.int8]
"""What is read of cells: 1 for white, 0 for black, −1 for neither."""


@dataclass(frozen=True)
class CellReading:
    """The cells of the markers at a pose."""

    agreement: dict[str, float]
    """Share of the cells of each face in view that are black or white as expected, 0…1."""

    others: frozenset[str] = frozenset()
    """Names of the faces where another marker of the dictionary is read: this is another cube."""

    @property
    def best(self) -> float:
        """The greatest share of any face; 0 where no face is in view."""
        return max(self.agreement.values(), default=0.0)


class CellReader:
    """Reads the marker cells of one cube seen by one camera."""

    def __init__(self, cube: CubeModel, projection: Projection) -> None:
        self._faces = FacePlanes(cube)
        self._projection = projection
        self._cube = cube
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
        agreement, others = {}, set()
        for number, value, seen in zip(facing, values, inside, strict=True):
            if np.count_nonzero(seen) <= count // 2:
                continue
            name = self._faces.names[number]
            read = _read_cells(value[seen], self._white[number][seen])
            agreement[name] = share = float((read == self._white[number][seen]).mean())
            if MIN_LIKENESS <= share < MIN_OTHER and seen.all() and self._is_other(number, read):
                others.add(name)
        return CellReading(agreement, frozenset(others))

    def _is_other(self, face: int, read: Readings) -> bool:
        """Whether what is read on a face is another marker, or its own one turned."""
        black = turned_markers(self._cube.dictionary)
        alike = (read == ~black).mean(axis=2)
        alike[self._cube.faces[face].marker_id, 0] = 0.0
        return bool(alike.max() >= MIN_OTHER)


def _read_cells(value: Floats, white: Flags) -> Readings:
    """Read cells by the grey values of those that should be white: 1, 0 for black, −1 for none."""
    read = np.full(len(value), -1, np.int8)
    bright, dark = value[white], value[~white]
    if not len(bright) or not len(dark):
        return read
    high, low = quantile(bright, 0.5), quantile(dark, 0.5)
    middle, band = (high + low) / 2, UNREAD_BAND * (high - low)
    if high - low >= MIN_CONTRAST:
        read[value > middle + band] = 1
        read[value < middle - band] = 0
    return read
