"""What the cubes in front of one camera tell of it: one estimate, which all of them feed."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from cubeling.tracking.cube.model import CubeModel
from cubeling.tracking.geometry.arrays import Array
from cubeling.tracking.geometry.frame import Frame
from cubeling.tracking.geometry.intrinsics import Intrinsics
from cubeling.tracking.geometry.projection import Projection
from cubeling.tracking.refinement.camera_model import CameraModelEstimator
from cubeling.tracking.refinement.edges.edge_fit import FittedEdges
from cubeling.tracking.refinement.lens_estimate import LensEstimator
from cubeling.tracking.tracker.measured_lens import MeasuredLens

if TYPE_CHECKING:
    from cubeling.tracking.detection.markers import Observation

MAX_KEPT_CHANGE = 0.05
"""Change of the logarithm of the focal length up to which what was learned of the distortion is
kept: through another lens than that, the faces were stretched by more than it explains."""


class LearnedCamera:
    """A camera, and what is learned of it in play.

    The trackers of several cubes share one, so that all look through the same lens.

    Parameters
    ----------
    intrinsics
        The camera, as far as it is known before play.
    """

    def __init__(self, intrinsics: Intrinsics) -> None:
        self.intrinsics = intrinsics
        """The camera in use; its focal length is measured in play where it was guessed."""
        self.estimator = CameraModelEstimator()
        """Exposure, tone curve and rolling shutter."""
        self._cubes: list[CubeModel] = []
        self._begun: tuple[int, float] | None = None

    def add(self, cube: CubeModel) -> int:
        """Take one more cube, before the first frame; return its number."""
        self._cubes.append(cube)
        self.measured = MeasuredLens(self._cubes, self.intrinsics)
        """The focal length."""
        self.lens = LensEstimator(self._cubes, Projection(self.intrinsics))
        """The distortion besides."""
        return len(self._cubes) - 1

    def reprint(self, number: int, cube: CubeModel) -> None:
        """Take a cube as it is printed; what it told of the distortion rests on another print."""
        self._cubes[number] = cube
        self.measured.reprint(self._cubes)
        self.lens = LensEstimator(self._cubes, Projection(self.intrinsics))

    def begin(self, frame: Frame) -> None:
        """Decide through which lens a frame is seen: once, and for all cubes."""
        # Not the frame itself: checkpoints keep all that is held here.
        moment = frame.index, frame.timestamp
        if moment == self._begun:
            return
        self._begun = moment
        better = self.measured.take_better()
        if better is None:
            return
        change = np.log(better.matrix[0, 0] / self.intrinsics.matrix[0, 0])
        self.intrinsics = better
        if abs(change) < MAX_KEPT_CHANGE:
            self.lens.look_through(Projection(better))
        else:
            self.lens = LensEstimator(self._cubes, Projection(better))

    def learn_corners(self, number: int, markers: "Sequence[Observation]") -> None:
        """Learn the focal length from the corners of a cube's markers."""
        from cubeling.tracking.refinement.face_corners import detected_faces

        self.measured.learn(detected_faces(markers), number)

    def learn_edges(
        self, number: int, camera_from_cube: Array, faces: Sequence[str], edges: FittedEdges
    ) -> None:
        """Learn the lens from the edges of some faces of a cube at a trusted pose, (4, 4)."""
        self.lens.learn(camera_from_cube, edges, number)
        if self.measured.wants(camera_from_cube, number):
            # A camera that was calibrated needs neither: loaded where the lens is measured.
            from cubeling.tracking.refinement.face_corners import fitted_faces

            cube, projection = self._cubes[number], Projection(self.intrinsics)
            found = fitted_faces(cube, projection, camera_from_cube, faces, edges)
            self.measured.learn(found, number)
