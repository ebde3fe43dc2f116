"""The rival `aprilcube`: `… april filtered | unfiltered`, as it ships or without its Kalman filter.

It is told the same geometry as everybody, its corners and normals marker by marker in the format of
the `config.json` that its generator writes.
"""

import json
import sys
import tempfile
from importlib.metadata import version
from pathlib import Path
from typing import Any

import aprilcube  # type: ignore[import-not-found]  # lives in its own environment
import cv2
import numpy as np

from tests.bench.tracking.rivals.serving import Array, Picture, Scene, serve

ITS_FACES = {"right": "+X", "left": "-X", "top": "+Y", "bottom": "-Y", "front": "+Z", "back": "-Z"}
"""Our faces in its words: by the axis of the cube frame that they look along."""


class AprilCube:
    """Its estimator in one process, frame after frame, without its pictures for a viewer."""

    def __init__(self, scene: Scene, filtered: bool) -> None:
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "config.json"
            path.write_text(json.dumps(config(scene)), encoding="utf-8")
            self._estimator = aprilcube.detector(
                path, scene.matrix, dist_coeffs=scene.distortion, enable_filter=filtered
            )

    def track(self, image: Picture, timestamp: float) -> Array | None:
        """Ask it; what it predicts without seeing the cube is an answer too, as it ships."""
        result = self._estimator.process_frame(image, timestamp=timestamp, store_latest=False)
        if not result["success"]:
            return None
        pose = np.array(result["T"], np.float64)
        pose[:3, 3] /= 1000  # its lengths are millimetres
        return pose

    def notes(self) -> dict[str, Any]:
        """Nothing more is known."""
        return {}


def config(scene: Scene) -> dict[str, Any]:
    """Describe the cube in its format; lengths in millimetres."""
    markers = [
        {
            "id": number,
            "face": ITS_FACES[scene.faces[number]],
            "corners_mm": (1000 * corners).tolist(),
            "normal": (corners.mean(axis=0) / np.linalg.norm(corners.mean(axis=0))).tolist(),
        }
        for number, corners in scene.corners.items()
    ]
    square = next(iter(scene.corners.values()))
    return {
        "grid": "1x1x1",
        "dict": scene.dictionary.removeprefix("DICT_").lower(),
        "tag_ids": sorted(scene.corners),
        "tag_size_mm": 1000 * float(np.linalg.norm(square[1] - square[0])),
        "cell_size_mm": 0,
        "margin_cells": 1,
        "border_cells": 1,
        "box_dims": [1000 * scene.edge] * 3,
        "markers": markers,
        "faces": {ITS_FACES[name]: [number] for number, name in scene.faces.items()},
    }


if __name__ == "__main__":
    FILTERED = sys.argv[1] == "filtered"
    VERSIONS = {"aprilcube": version("aprilcube"), "opencv": cv2.__version__}
    serve(lambda scene: AprilCube(scene, FILTERED), VERSIONS)
