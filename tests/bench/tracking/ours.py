"""Cubeling's tracker as an entry of the benchmark."""

from importlib.metadata import version
from typing import Any

import cv2
import numpy as np

from cubeling.tracking import CubeModel, CubeState, CubeTracker, Frame, Intrinsics
from tests.bench.tracking.optics import LensModel
from tests.bench.tracking.rivals.serving import Array, Picture, Scene, serve
from tests.bench.tracking.scoring import PREDICTION_S

MEASURED_FOCAL, NOMINAL_FOCAL = 0.002, 0.005
"""What the tracker is told of the doubt of a focal length, of a lens that was calibrated and of one
that claims no distortion: in the drawn pictures it is right."""


def told_camera(lens: Scene | LensModel) -> Intrinsics:
    """Return a lens as `CubeTracker` is told it."""
    deviation = MEASURED_FOCAL if np.any(lens.distortion) else NOMINAL_FOCAL
    return Intrinsics(lens.matrix, lens.distortion, lens.size, deviation)


class CubelingEntry:
    """`CubeTracker` through its public API."""

    def __init__(self, scene: Scene) -> None:
        self._tracker = CubeTracker(CubeModel.load(scene.cube), told_camera(scene))
        self._state: CubeState | None = None
        self._count = 0

    def track(self, image: Picture, timestamp: float) -> Array | None:
        """Return the pose if the tracker trusts it; a first picture is searched to the end."""
        first = self._state is None
        while True:
            self._state = self._tracker.update(Frame(image, timestamp, self._count))
            self._count += 1
            if not (first and self._state.verdict == "searching"):
                break
        return self._state.camera_from_cube if self._state.visible else None

    def notes(self) -> dict[str, Any]:
        """Return further fields of its state, and its prediction."""
        state = self._state
        assert state is not None
        notes: dict[str, Any] = {"source": state.source, "refused": state.refused}
        if not state.visible:
            return notes
        notes |= {"covariance": state.covariance.tolist(), "velocity": state.velocity.tolist()}
        expected = self._tracker.predict(state.timestamp + PREDICTION_S).camera_from_cube
        return notes | {"expected": None if expected is None else np.asarray(expected).tolist()}


if __name__ == "__main__":
    serve(CubelingEntry, {"cubeling": version("cubeling"), "opencv": cv2.__version__})
