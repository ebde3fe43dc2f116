"""The rival `rapidtag`: its detector with sub-pixel corners, then the pose as for OpenCV."""

from importlib.metadata import version
from typing import Any

import cv2
import numpy as np
import rapidtag  # type: ignore[import-not-found]  # lives in its own environment

from tests.bench.tracking.rivals.pnp import cube_pose
from tests.bench.tracking.rivals.serving import Array, Picture, Scene, serve


class RapidTag:
    """Its own detector, no past."""

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        self._parameters = rapidtag.DetectorParameters()
        self._parameters.corner_refinement_method = rapidtag.CORNER_REFINE_SUBPIX

    def track(self, image: Picture, timestamp: float) -> Array | None:
        """Detect, then solve."""
        grey = cv2.cvtColor(image, cv2.COLOR_BGR2GRAY)  # 1 ms faster than its own conversion
        found, ids = rapidtag.detect_markers(grey, self._scene.dictionary, self._parameters)
        return cube_pose(self._scene, ids, [np.asarray(square, np.float32) for square in found])

    def notes(self) -> dict[str, Any]:
        """Nothing more is known."""
        return {}


if __name__ == "__main__":
    serve(RapidTag, {"rapidtag": version("rapidtag"), "opencv": cv2.__version__})
