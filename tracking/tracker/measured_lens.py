"""The lens of a camera whose focal length was guessed, as the cube measures it in play."""

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import cv2
import numpy as np

from cubeling.tracking.cube.model import CubeModel
from cubeling.tracking.geometry import se3
from cubeling.tracking.geometry.arrays import Array
from cubeling.tracking.geometry.intrinsics import Intrinsics
from cubeling.tracking.refinement.lens_estimate import FocalLength
from cubeling.tracking.refinement.systematic_error import CORNER_ERROR_PX
from cubeling.tracking.tracker.prediction import Track, TrackedPose

if TYPE_CHECKING:  # a camera that was calibrated needs none of these
    from cubeling.tracking.refinement.face_corners import FaceCorners
    from cubeling.tracking.refinement.focal_length import FocalLengthEstimator

MAX_EDGE_DEVIATION = 0.12
"""Through a lens whose focal length is off by more than this, as a share, the edges of one face are
followed and those of another are lost, which would prove the wrong lens right."""


class MeasuredLens:
    """What is known of a lens, and through which one the tracker looks.

    A lens that was calibrated stays as it is: only one whose focal length is stated with more doubt
    than play leaves is measured.
    """

    def __init__(self, cubes: Sequence[CubeModel], intrinsics: Intrinsics) -> None:
        self._told = intrinsics
        self._begun_at = 1.0
        """Scale of the lens from which the estimator counts."""
        self._in_use = FocalLength(1.0, intrinsics.focal_deviation or 0.0)
        self._estimator = None if self._in_use.known else _estimator_of(cubes, intrinsics)

    @property
    def learns(self) -> bool:
        """Whether more pictures can tell more."""
        return self._estimator is not None and not self._estimator.done

    @property
    def trusts_edges(self) -> bool:
        """Whether the lens in use is right enough for the edges to be found where they are."""
        return self._in_use.deviation < MAX_EDGE_DEVIATION

    def wants(self, camera_from_cube: Array, cube: int) -> bool:
        """Whether the edges of a cube at a pose, (4, 4), can tell more."""
        estimator = self._estimator
        return (
            estimator is not None
            and self.learns
            and self.trusts_edges
            and estimator.wants(camera_from_cube, CORNER_ERROR_PX, cube)
        )

    @property
    def scale(self) -> float:
        """Focal length in use, as a multiple of that of the intrinsics at the beginning."""
        return self._in_use.scale

    @property
    def best(self) -> Intrinsics:
        """The lens as well as it is known."""
        found = self._found
        return self._told.lengthen(found.scale, found.deviation) if found else self._told

    def learn(self, faces: "Sequence[FaceCorners]", cube: int) -> None:
        """Learn from the faces of a cube, by its number, in one picture."""
        if self._estimator is not None:
            self._estimator.learn(faces, cube)

    def take_better(self) -> Intrinsics | None:
        """Return the lens to look through from now on; None where that stays the same."""
        found = self._found
        if found is None or not found.is_better(self._in_use):
            return None
        self._in_use = found
        return self.best

    def reprint(self, cubes: Sequence[CubeModel]) -> None:
        """Measure on with another print of the cubes, from what is known so far."""
        if self._estimator is not None:
            best = self.best
            self._begun_at *= self._estimator.estimate.scale
            self._estimator = _estimator_of(cubes, best)

    @property
    def _found(self) -> FocalLength | None:
        """What was measured, None where nothing is."""
        if self._estimator is None:
            return None
        found = self._estimator.estimate
        return replace(found, scale=self._begun_at * found.scale)


def _estimator_of(cubes: Sequence[CubeModel], intrinsics: Intrinsics) -> "FocalLengthEstimator":
    from cubeling.tracking.refinement.focal_length import FocalLengthEstimator

    return FocalLengthEstimator(cubes, intrinsics)


def track_through(track: Track, cube: CubeModel, before: Intrinsics, after: Intrinsics) -> Track:
    """Return the track as another lens would have seen it, in the same pictures."""
    points = np.concatenate([face.corners for face in cube.faces])
    longer = after.matrix[0, 0] / before.matrix[0, 0]

    def see_again(each: TrackedPose) -> TrackedPose:
        velocity = each.velocity * [1, 1, longer, 1, 1, 1]
        pose = _pose_through(each.camera_from_cube, points, before, after)
        return replace(each, camera_from_cube=pose, velocity=velocity)

    return Track(tuple(see_again(each) for each in track.poses))


def _pose_through(pose: Array, points: Array, before: Intrinsics, after: Intrinsics) -> Array:
    """Return the pose, (4, 4), at which another lens shows points of the cube nearly alike."""
    turn, shift = cv2.Rodrigues(pose[:3, :3])[0], pose[:3, 3:]
    pixels = cv2.projectPoints(points, turn, shift, before.matrix, before.distortion)[0]
    start = shift * [[1], [1], [after.matrix[0, 0] / before.matrix[0, 0]]]
    found = cv2.solvePnPRefineLM(points, pixels, after.matrix, after.distortion, turn, start)
    return se3.pose(se3.rotation(np.ravel(found[0])), np.ravel(found[1]))
