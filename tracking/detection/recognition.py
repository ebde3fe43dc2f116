"""Which of several cubes an image shows."""

from collections.abc import Sequence

import cv2
import numpy as np

from cubeling.tracking.cube.model import CubeModel
from cubeling.tracking.detection.markers import MarkerDetector
from cubeling.tracking.geometry.arrays import Image


class CubeRecognizer:
    """Recognises cubes by their markers. Those that share all their markers cannot be told apart.

    Parameters
    ----------
    cubes
        The cubes to tell apart.
    """

    def __init__(self, cubes: Sequence[CubeModel]) -> None:
        self._cubes = tuple(cubes)
        self._detectors = {name: MarkerDetector(name) for name in {c.dictionary for c in cubes}}

    def recognize(self, image: Image) -> CubeModel | None:
        """Return the cube of which an image, (H, W, 3) BGR, shows most markers; None for none.

        Slower than tracking, for all windows are tried: for a look now and then.
        """
        grey = np.asarray(cv2.cvtColor(image, cv2.COLOR_BGR2GRAY), np.uint8)
        seen = {
            (name, marker.marker_id)
            for name, detector in self._detectors.items()
            for marker in detector.detect_strictly(grey)
        }
        counts = [len(seen & cube.markers) for cube in self._cubes]
        most = max(counts, default=0)
        return self._cubes[counts.index(most)] if most and counts.count(most) == 1 else None
