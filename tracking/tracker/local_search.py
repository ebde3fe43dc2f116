"""The search for a cube near its predicted pose: by its edges, else by its blurred image."""

from dataclasses import dataclass

from cubeling.tracking.cube.model import CubeModel
from cubeling.tracking.geometry.arrays import Array, Image
from cubeling.tracking.geometry.image_region import Patch
from cubeling.tracking.geometry.projection import Projection
from cubeling.tracking.refinement.blur_search import (
    MAX_EDGE_BLUR_CELLS,
    MIN_CORRELATION_ALONE,
    BlurSearch,
)
from cubeling.tracking.refinement.camera_model import BlurObservation, CameraModel, shows_exposure
from cubeling.tracking.refinement.candidate import Candidate
from cubeling.tracking.refinement.cell_search import CellSearch
from cubeling.tracking.refinement.edge_search import EdgeSearch
from cubeling.tracking.refinement.footprint import Footprint
from cubeling.tracking.refinement.photometry.photometric_fit import Alignment
from cubeling.tracking.tracker.prediction import Prediction, Track

MAX_MOTION_SURPRISE_CELLS = 0.07
"""The edges are measured again where the measured blur motion differs by more from the expected."""

MAX_WHOLE_CELL_PX = 3.0
"""Smaller cells have no single edges to measure, and are compared as a whole."""


@dataclass(frozen=True)
class LocalMatch:
    """What the search near the predicted pose found."""

    candidate: Candidate | None = None
    """The cube; None where it was not found there."""

    blur: BlurObservation | None = None
    """Measurements of the camera from its blur, where it is blurred enough."""

    studied: bool = False
    """Whether a sharp image was aligned only to learn the camera from it."""


class LocalTracker:
    """Finds one cube near its predicted pose, by `edges` or by `blur`."""

    def __init__(
        self,
        cube: CubeModel,
        projection: Projection,
        edges: EdgeSearch,
        cells: CellSearch,
        blur: BlurSearch,
    ) -> None:
        self._footprint = Footprint(cube, projection)
        self._cells = cells
        self._edges = edges
        self._blur = blur

    def search(
        self,
        image: Image,
        track: Track,
        prediction: Prediction,
        camera: CameraModel,
        *,
        crisp: bool = False,
    ) -> LocalMatch:
        """Find the cube in an image, (H, W, 3) BGR, near its predicted pose.

        `crisp` is whether a marker was read there: then nothing is gained by aligning blur.
        """
        patch = self._footprint.crop(image, prediction.camera_from_cube, camera.tone)
        if patch is None:
            return LocalMatch()
        found = self._by_edges(patch, track, prediction, camera)
        if found is not None:
            return self._study_blur(patch, found, track, prediction.timestamp, camera)
        if self._footprint.pixels_per_cell(prediction.camera_from_cube) < MAX_WHOLE_CELL_PX:
            match = self._cells.search(image, prediction.camera_from_cube, camera.tone)
            if match is not None and match.proved:
                return LocalMatch(match.candidate)
        if crisp:
            return LocalMatch()
        return self._by_blur(patch, track, prediction, camera)

    def _by_edges(
        self, patch: Patch, track: Track, prediction: Prediction, camera: CameraModel
    ) -> Candidate | None:
        """Refine on the edges; once more where the cube moves otherwise than was assumed."""
        last = track.poses[-1].covariance

        def blur_motion(pose: Array, covariance: Array = last) -> Array:
            return track.motion(pose, covariance, prediction.timestamp)[0] * camera.exposure

        start = prediction.camera_from_cube
        # Blur wider than that has no edge profile to fit; the image is aligned as a whole.
        if self._footprint.blur_extent(blur_motion(start)) >= MAX_EDGE_BLUR_CELLS:
            return None
        found = self._edges.search(patch, start, blur_motion, camera.readout_share)
        if found is None or found.edges is None:
            return None
        pose, assumed = found.camera_from_cube, found.edges.profiles.blur_motion
        measured = blur_motion(pose, found.covariance)
        if self._footprint.blur_extent(measured) > MAX_EDGE_BLUR_CELLS:
            return None
        if self._footprint.blur_extent(measured - assumed) < MAX_MOTION_SURPRISE_CELLS:
            return found
        # The first result where the second search fails: it was good, if not the best.
        again = self._edges.search(patch, pose, lambda _: measured, camera.readout_share)
        return again or found

    def _by_blur(
        self, patch: Patch, track: Track, prediction: Prediction, camera: CameraModel
    ) -> LocalMatch:
        """Align the blurred image, which also measures the camera."""
        expected = prediction.velocity * camera.exposure
        aligned = self._blur.align(patch, prediction.camera_from_cube, expected, camera)
        if aligned is None:
            return LocalMatch()
        pose, covariance = aligned.camera_from_cube, aligned.covariance[:6, :6]
        velocity = track.motion(pose, covariance, prediction.timestamp)[0]
        return LocalMatch(
            self._blur.candidate(patch, aligned), self._observation(aligned, velocity)
        )

    def _study_blur(
        self, patch: Patch, found: Candidate, track: Track, timestamp: float, camera: CameraModel
    ) -> LocalMatch:
        """Align a slightly blurred image, too, while the camera is not known well."""
        if not camera.worth_studying:
            return LocalMatch(found)
        pose = found.camera_from_cube
        velocity = track.motion(pose, found.covariance, timestamp)[0]
        motion = velocity * camera.sought_exposure
        extent = self._footprint.blur_extent(motion)
        if not shows_exposure(extent, self._footprint.pixels_per_cell(pose)):
            return LocalMatch(found)
        aligned = self._blur.align(patch, pose, motion, camera, coarse=False)
        return LocalMatch(found, self._observation(aligned, velocity) if aligned else None, True)

    def _observation(self, aligned: Alignment, velocity: Array) -> BlurObservation | None:
        """Return the measurements of the camera in an alignment; None where it may be wrong."""
        # `not >=` instead of `<`, so that NaN is refused too.
        if not aligned.correlation >= MIN_CORRELATION_ALONE:
            return None
        return BlurObservation(
            aligned,
            velocity,
            self._footprint.blur_extent(aligned.blur_motion),
            self._footprint.pixels_per_cell(aligned.camera_from_cube),
        )
