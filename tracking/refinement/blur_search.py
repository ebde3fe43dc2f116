"""A cube found by its motion-blurred image, where its edges are smeared too far."""

import numpy as np

from cubeling.tracking.cube.model import CubeModel
from cubeling.tracking.geometry.arrays import Array
from cubeling.tracking.geometry.image_region import Patch
from cubeling.tracking.geometry.projection import Projection
from cubeling.tracking.refinement.camera_model import CameraModel
from cubeling.tracking.refinement.candidate import Candidate
from cubeling.tracking.refinement.edge_search import EdgeSearch
from cubeling.tracking.refinement.footprint import Footprint
from cubeling.tracking.refinement.photometry.motion_blur_alignment import MotionBlurAligner
from cubeling.tracking.refinement.photometry.photometric_fit import Alignment

MAX_EDGE_BLUR_CELLS, VISIBLE_EDGE_BLUR_CELLS = 0.6, 0.3
"""Blur extents up to which edges can be measured, and below which they must be found."""

MIN_CORRELATION, MIN_CORRELATION_ALONE = 0.85, 0.95
"""Correlation of a blurred image with the rendered one from which on it shows the cube: with other
evidence, and without."""

MOTION_SPREAD, FIRST_MOTION_SPREAD = (0.12, 0.0025, 0.04), (0.35, 0.004, 0.06)
"""Standard deviation of an expected blur motion with a known and an unknown exposure: a share of
it, and [m, rad] besides."""

UNKNOWN_MOTION_SPREAD = (1.5, 0.15)
"""Standard deviation of the motion of a cube without a past [cells, rad]."""

BLUR_DIRECTIONS = 4
"""Directions in which a cube without a past is taken to move, evenly spread over half a turn: a
motion and its reverse blur alike."""

COVARIANCE_FACTORS = (2.5, 5.0)
"""By how much the variance exceeds what the residuals tell: without blur, and more for each cell of
blur extent. Measured as the coverage that `make bench-tracking` prints."""


class BlurSearch:
    """Aligns the image of one moving cube, and tells whether it shows the cube."""

    def __init__(self, cube: CubeModel, projection: Projection, edges: EdgeSearch) -> None:
        self._aligner = MotionBlurAligner(cube, projection)
        self._footprint = Footprint(cube, projection)
        self._edges = edges

    def align(
        self,
        patch: Patch,
        start: Array,
        blur_motion: Array,
        camera: CameraModel,
        coarse: bool | None = None,
    ) -> Alignment | None:
        """Align the image of a cube at an expected pose and motion; None if it shows no cube.

        `coarse` searches coarsely first; None does so only where the fine search fails.
        """
        share, shift, turn = MOTION_SPREAD if camera.exposure_known else FIRST_MOTION_SPREAD
        sizes = [np.linalg.norm(blur_motion[:3]), np.linalg.norm(blur_motion[3:])]
        prior = np.hypot(share * np.repeat(sizes, 3), np.repeat([shift, turn], 3))
        found = None
        if not coarse:
            found = self._aligner.align(patch, start, blur_motion, prior, coarse=False)
        if coarse is None and not (found and found.min_correlation > MIN_CORRELATION_ALONE):
            again = self._aligner.align(patch, start, blur_motion, prior)
            if again and not (found and found.correlation > again.correlation):
                found = again
        return found if found and _shows_cube(found) else None

    def align_unknown_motion(
        self, patch: Patch, start: Array, direction: int, best: Alignment | None
    ) -> Alignment | None:
        """Align a cube without a past, of which only corners were read, in one direction.

        Directions are numbers below `BLUR_DIRECTIONS`; `best` is the best of those before.
        """
        shift, turn = UNKNOWN_MOTION_SPREAD
        prior = np.repeat([shift * self._footprint.cell, turn], 3)
        angle = direction * np.pi / BLUR_DIRECTIONS
        ahead = np.array([np.cos(angle), np.sin(angle), 0, 0, 0, 0])
        found = self._aligner.align(patch, start, self._footprint.cell * ahead, prior)
        least = max(MIN_CORRELATION_ALONE, best.correlation if best else 0.0)
        return found if found and found.correlation > least and _shows_cube(found) else best

    def candidate(self, patch: Patch, aligned: Alignment) -> Candidate | None:
        """Refine an alignment on the edges; where those are not smeared they must be found."""
        extent = self._footprint.blur_extent(aligned.blur_motion)
        if extent < MAX_EDGE_BLUR_CELLS:
            found = self._edges.search(
                patch, aligned.camera_from_cube, lambda _: aligned.blur_motion
            )
            if found is not None or extent < VISIBLE_EDGE_BLUR_CELLS:
                return found
        at_rest, per_cell = COVARIANCE_FACTORS
        return Candidate(
            camera_from_cube=aligned.camera_from_cube,
            covariance=aligned.covariance[:6, :6] * (at_rest + per_cell * extent),
            source="image",
            faces=tuple(
                face for face, share in aligned.face_correlations.items() if share > MIN_CORRELATION
            ),
            error=float("nan"),
            residual=aligned.residual,
            certain=True,
            blur_motion=aligned.blur_motion,
            measurements=8,
        )


def _shows_cube(aligned: Alignment) -> bool:
    """Whether all faces in view correlate with the image, or two do so beyond doubt."""
    if aligned.min_correlation > MIN_CORRELATION:
        return True
    sure = sum(share > MIN_CORRELATION_ALONE for share in aligned.face_correlations.values())
    return aligned.correlation > MIN_CORRELATION and sure >= 2
