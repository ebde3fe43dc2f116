"""OpenCV's own detector on the whole picture: `… opencv SUBPIX | APRILTAG | ARUCO3`."""

import sys
import time
from typing import Any

import cv2

from tests.bench.tracking.rivals.pnp import cube_pose
from tests.bench.tracking.rivals.serving import Array, Picture, Scene, serve


class OpenCv:
    """`ArucoDetector` with one kind of corner refinement, and no past."""

    def __init__(self, scene: Scene, kind: str) -> None:
        self._scene = scene
        parameters = cv2.aruco.DetectorParameters()
        if kind == "ARUCO3":
            parameters.useAruco3Detection = True
            parameters.minSideLengthCanonicalImg = 16
            parameters.minMarkerLengthRatioOriginalImg = 0.03
        refinement = "APRILTAG" if kind == "APRILTAG" else "SUBPIX"
        parameters.cornerRefinementMethod = getattr(cv2.aruco, f"CORNER_REFINE_{refinement}")
        dictionary = cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, scene.dictionary))
        self._detector = cv2.aruco.ArucoDetector(dictionary, parameters)
        self._detection = 0.0

    def track(self, image: Picture, timestamp: float) -> Array | None:
        """Detect, then solve."""
        start = time.perf_counter()
        corners, ids, _ = self._detector.detectMarkers(image)
        self._detection = time.perf_counter() - start
        if ids is None or not len(ids):
            return None
        return cube_pose(self._scene, [int(number) for number in ids.ravel()], corners)

    def notes(self) -> dict[str, Any]:
        """Tell what of the time was the detection."""
        return {"detection_ms": 1000 * self._detection}


if __name__ == "__main__":
    serve(lambda scene: OpenCv(scene, sys.argv[1]), {"opencv": cv2.__version__})
