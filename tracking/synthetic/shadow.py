"""The shadow of a cube on the table."""

import cv2
import numpy as np

from cubeling.tracking.geometry.arrays import Array, Floats
from cubeling.tracking.synthetic.camera_rays import CameraRays
from cubeling.tracking.synthetic.paper_cube import TO_LIGHT


def cast_shadow(image: Floats, camera: CameraRays, corners: Array) -> None:
    """Darken the table in an image (H, W, 3), in place.

    `corners` are the cube's in the table frame, (8, 3) [m].
    """
    height = max(0.0, float(corners[:, 1].min()))
    away = -TO_LIGHT[[0, 2]] / TO_LIGHT[1]
    foot = corners * (1.0, 0.0, 1.0)
    cast = foot.copy()
    cast[:, [0, 2]] += 0.55 * np.maximum(corners[:, 1:2], 0.0) * away
    soft = 5.0 + 260.0 * height
    _darken(image, camera, cast, 0.40 / (1.0 + 9.0 * height), soft)
    _darken(image, camera, foot, 0.42 / (1.0 + 60.0 * height), 2.5 + 120.0 * height)


def _darken(image: Floats, camera: CameraRays, points: Array, depth: float, soft: float) -> None:
    in_camera = camera.from_table(points)
    if (in_camera[:, 2] < 0.05).any():
        return
    pixels = camera.pixels(in_camera)
    region = camera.region_around(pixels, 3.2 * soft)
    if region.empty:
        return
    hull = cv2.convexHull(np.round((pixels - (region.x, region.y)) * 16).astype(np.int32))
    mask = np.zeros((region.height, region.width), np.float32)
    cv2.fillConvexPoly(mask, hull, 1.0, cv2.LINE_AA, 4)
    image[region.index] *= (1.0 - depth * cv2.GaussianBlur(mask, (0, 0), soft))[..., None]
