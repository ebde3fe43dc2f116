"""A cube near an expected pose, found by the edges of its markers and proved by their cells."""

from dataclasses import dataclass

import numpy as np

from cubeling.tracking.cube.faces import FacePlanes
from cubeling.tracking.cube.model import CubeModel
from cubeling.tracking.detection.marker_check import CellReader, CellReading
from cubeling.tracking.geometry.arrays import Array
from cubeling.tracking.geometry.image_region import Patch
from cubeling.tracking.geometry.projection import Projection
from cubeling.tracking.refinement.candidate import Candidate
from cubeling.tracking.refinement.edges.edge_refinement import (
    BlurMotion,
    EdgeRefinement,
    EdgeRefiner,
    at_rest,
)
from cubeling.tracking.refinement.footprint import Footprint

MIN_EDGE_SUPPORT, MIN_EDGE_SUPPORT_WITH_MARKERS = 0.55, 0.25
"""Share of the edges in view that must be found for the edges alone to prove the cube, and where
the markers can be read as well; fingers cover the rest."""

MIN_SHARPNESS_RATIO = 0.65
"""Below this ratio of the dullest to the sharpest edges, the cube moved in an unexpected way."""

MAX_RESIDUAL_PX, MAX_RESIDUAL_SHARE = 0.5, 0.0063
"""Edges of a rigid cube lie within this of their places, or within this share of its edge,
whichever is more: a cube folded 1 mm askew does, a cube on a screen seen from the side does not."""

MIN_FACE_AGREEMENT = 0.6
"""Share of a face's cells that must be as expected for its edges to count as its own."""

MIN_READ_AGREEMENT, MIN_SUPPORTED_AGREEMENT = 0.95, 0.75
"""Share of a face's cells that must be as expected for its marker to count as read, and where the
edges of the cube are found too."""

COVARIANCE_FACTOR, DOUBLING_BLUR_EXTENT = 1.5, 0.25
"""By how much the variance exceeds what the residuals tell, at rest, and the blur extent [cells]
that doubles it. Measured as the coverage that `make bench-tracking` prints."""

COMMON_ERROR_PX = (0.01, 0.002, 0.005)
"""Error that all edges have in common by lens, paper and light: sideways, in size and in tilt, at
the cube's border."""


@dataclass(frozen=True)
class EdgeMatch:
    """A pose refined on edges, and whether it is the cube's."""

    refinement: EdgeRefinement
    """The pose with its residuals."""

    covariance: Array
    """Of a pose delta, (6, 6), with the errors that no residual shows."""

    reading: CellReading
    """What the cells say at this pose; nothing where too few edges were found."""

    rigid: bool
    """Whether the edges lie as those of one rigid cube, and not as on a picture of one."""

    proved: bool
    """Whether edges and cells prove that this is the cube."""


class EdgeSearch:
    """Refines poses of one cube on its edges, and tells whether they prove that it is the cube."""

    def __init__(self, cube: CubeModel, projection: Projection) -> None:
        self._faces = FacePlanes(cube)
        self._refiner = EdgeRefiner(cube, projection)
        self._reader = CellReader(cube, projection)
        self._footprint = Footprint(cube, projection)

    def match(
        self,
        patch: Patch,
        start: Array,
        blur_motion: BlurMotion = at_rest,
        readout_share: float = 0.0,
    ) -> EdgeMatch | None:
        """Refine a pose as `EdgeRefiner.refine` does, and tell whether it is the cube's."""
        found = self._refiner.refine(patch, start, blur_motion, readout_share)
        if found is None:
            return None
        reading = CellReading({})
        if found.support >= MIN_EDGE_SUPPORT_WITH_MARKERS:
            reading = self._reader.read(patch, found.camera_from_cube)
        covariance = self._inflate_covariance(found)
        rigid = self._is_rigid(found)
        return EdgeMatch(found, covariance, reading, rigid, rigid and _prove(found, reading))

    def search(
        self,
        patch: Patch,
        start: Array,
        blur_motion: BlurMotion = at_rest,
        readout_share: float = 0.0,
    ) -> Candidate | None:
        """Refine a pose as `match` does; None where the edges do not prove that it is the cube."""
        match = self.match(patch, start, blur_motion, readout_share)
        if match is None or not match.proved:
            return None
        found, reading = match.refinement, match.reading
        return Candidate(
            camera_from_cube=found.camera_from_cube,
            covariance=match.covariance,
            source="markers" if reading.best >= MIN_READ_AGREEMENT else "image",
            faces=tuple(
                face
                for face, share in found.face_support.items()
                if share > MIN_EDGE_SUPPORT_WITH_MARKERS
                and reading.agreement.get(face, 1.0) > MIN_FACE_AGREEMENT
            ),
            error=found.residual,
            residual=found.residual / found.support,
            certain=True,
            measurements=found.line_count,
            edges=found.edges,
        )

    def mirrored_pose(self, candidate: Candidate) -> Array:
        """Return the pose of a candidate of one face, tilted the other way, (4, 4), not refined."""
        face = self._faces.names.index(candidate.faces[0])
        return self._faces.mirror(candidate.camera_from_cube, face)

    def _inflate_covariance(self, found: EdgeRefinement) -> Array:
        """Covariance of a refined pose, (6, 6), with the errors that all edges have in common."""
        pose = found.camera_from_cube
        extent = self._footprint.blur_extent(found.edges.profiles.blur_motion)
        half_edge = self._footprint.half_edge
        pixel = self._footprint.metres_per_pixel(pose)
        side, size, tilt = np.array(COMMON_ERROR_PX) * pixel
        size, tilt = size * float(pose[2, 3]) / half_edge, tilt / half_edge
        floor = np.square([side, side, size, tilt, tilt, tilt])
        factor = 1 + (extent / DOUBLING_BLUR_EXTENT) ** 2
        inflated = found.covariance * COVARIANCE_FACTOR * factor
        return np.asarray(inflated + np.diag(floor), np.float64)

    def _is_rigid(self, found: EdgeRefinement) -> bool:
        """Whether the edges lie as those of one rigid cube, and not as on a picture of one."""
        pixel = self._footprint.metres_per_pixel(found.camera_from_cube)
        edge = 2 * self._footprint.half_edge
        return found.residual < max(MAX_RESIDUAL_PX, MAX_RESIDUAL_SHARE * edge / pixel)


def _prove(found: EdgeRefinement, reading: CellReading) -> bool:
    if found.sharpness_ratio < MIN_SHARPNESS_RATIO or reading.others:
        return False
    if found.support <= MIN_EDGE_SUPPORT:
        return reading.best >= MIN_READ_AGREEMENT
    inner = found.inner_support > MIN_EDGE_SUPPORT
    return reading.best > (MIN_FACE_AGREEMENT if inner else MIN_SUPPORTED_AGREEMENT)
