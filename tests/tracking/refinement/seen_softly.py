"""Light of a cube at rest behind a soft lens, drawn without the tracker's own code.

White grows over black, the light of a face may have a slope, and hands may cover parts.
"""

from collections.abc import Mapping

import cv2
import numpy as np
from numpy.typing import NDArray

from cubeling.tracking.cube.marker import marker_cells
from cubeling.tracking.cube.model import CubeModel, Face
from cubeling.tracking.geometry.image_region import Patch
from cubeling.tracking.geometry.intrinsics import Intrinsics

Array = NDArray[np.float64]
Light = NDArray[np.float32]
Texture = Light | NDArray[np.uint8]

CAMERA = Intrinsics(
    np.array([[600.0, 0, 159.5], [0, 600.0, 119.5], [0, 0, 1]]), np.zeros(5), (320, 240)
)
FINE = 8
"""Subsamples along a pixel."""

INK, PAPER, DESK = 0.05, 0.8, 0.25
"""Share of the light that they reflect."""

Cover = tuple[float, float, float, float]
"""Left, top, right and bottom of the covered part of a marker, 0…1 from side to side."""


def drawn(
    cube: CubeModel,
    pose: Array,
    blur: float = 0.7,
    bloom: float = 0.0,
    slope: tuple[float, float] = (0.0, 0.0),
    covers: Mapping[str, Cover] | None = None,
    skin: float = 0.35,
    blank: tuple[str, ...] = (),
) -> Light:
    """Light of a cube, (240, 320), 0…1.

    Parameters
    ----------
    cube, pose
        Every face of the model that faces the camera is drawn; (4, 4) [m].
    blur
        Of the lens, one standard deviation [px].
    bloom
        How far white grows over black [px].
    slope
        By which share the light grows from the middle of each marker to its right and lower side.
    covers
        The part of each marker that a finger covers.
    skin
        Share of the light that the finger reflects.
    blank
        Faces of paper without a marker.
    """
    window = _window(cube, pose)
    left, top, right, bottom = window
    light = np.full(((bottom - top) * FINE, (right - left) * FINE), DESK, np.float32)
    for face in cube.faces:
        corners = face.corners @ pose[:3, :3].T + pose[:3, 3]
        if (pose[:3, :3] @ face.normal) @ corners.mean(axis=0) >= 0:
            continue
        ink = np.pad(marker_cells(cube.dictionary, face.marker_id).astype(np.uint8), 1)
        if face.name in blank:
            ink[:] = 0
        plane = _plane(corners, len(ink) - 2, 1)
        ink_seen = _laid(ink, plane, window, cv2.INTER_NEAREST).astype(np.uint8)
        paper = _laid(np.ones_like(ink), plane, window, cv2.INTER_NEAREST) > 0.5
        # The first subsample of ink is at a distance of 1 from white.
        depth = cv2.distanceTransform(ink_seen, cv2.DIST_L2, cv2.DIST_MASK_PRECISE)
        share = np.clip(depth - bloom * FINE, 0, 1)
        steps = np.linspace(-1, 1, 65, dtype=np.float32)
        lit = 1 + slope[0] * steps + slope[1] * steps[:, None]
        lit = _laid(np.pad(lit, 20, "edge"), _plane(corners, 65, 20), window, cv2.INTER_LINEAR)
        light[paper] = (lit * (PAPER + (INK - PAPER) * share))[paper]
    for name, cover in (covers or {}).items():
        _cover(light, cube.face(name), pose, cover, window, skin)
    picture = np.full(CAMERA.size[::-1], DESK, np.float32)
    size = (right - left, bottom - top)
    picture[top:bottom, left:right] = cv2.resize(light, size, interpolation=cv2.INTER_AREA)
    return np.asarray(cv2.GaussianBlur(picture, (0, 0), blur), np.float32)


def patch(light: Light, noise: float = 0.8, seed: int = 1) -> Patch:
    """Light as a camera measures it, 0…255."""
    random = np.random.default_rng(seed)
    return Patch(np.asarray(255 * light + random.normal(0, noise, light.shape), np.float32), 0, 0)


def corners_off(cube: CubeModel, pose: Array, truth: Array, faces: tuple[str, ...]) -> float:
    """How far a pose moves the corners of markers in the image at most [px]."""
    points = np.concatenate([cube.face(name).corners for name in faces])
    return float(np.linalg.norm(_pixels(points, pose) - _pixels(points, truth), axis=1).max())


def _pixels(points: Array, pose: Array) -> Array:
    seen = (points @ pose[:3, :3].T + pose[:3, 3]) @ CAMERA.matrix.T
    return np.asarray(seen[:, :2] / seen[:, 2:])


def _window(cube: CubeModel, pose: Array) -> tuple[int, int, int, int]:
    signs = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    pixels = _pixels(signs * cube.edge / 2, pose)
    left, top = np.maximum(pixels.min(axis=0) - 3, 0).astype(int).tolist()
    right, bottom = np.minimum(pixels.max(axis=0) + 4, CAMERA.size).astype(int).tolist()
    return left, top, right, bottom


def _plane(corners: Array, count: int, rim: int) -> Array:
    """Point in the camera's frame for (column, row, 1) of a texel, (3, 3): `count` along a marker
    and `rim` around it."""
    right, down = (corners[1] - corners[0]) / count, (corners[3] - corners[0]) / count
    return np.stack([right, down, corners[0] - (rim - 0.5) * (right + down)], axis=1)


def _laid(texture: Texture, plane: Array, window: tuple[int, int, int, int], method: int) -> Light:
    left, top, right, bottom = window
    finer = np.array([[FINE, 0, (FINE - 1) / 2], [0, FINE, (FINE - 1) / 2], [0, 0, 1.0]])
    shifted = np.array([[1.0, 0, -left], [0, 1.0, -top], [0, 0, 1.0]])
    size = ((right - left) * FINE, (bottom - top) * FINE)
    homography = finer @ shifted @ CAMERA.matrix @ plane
    return np.asarray(cv2.warpPerspective(texture, homography, size, flags=method), np.float32)


def _cover(
    light: Light,
    face: Face,
    pose: Array,
    cover: Cover,
    window: tuple[int, int, int, int],
    skin: float,
) -> None:
    left, top, right, bottom = cover
    shares = np.array([(left, top), (right, top), (right, bottom), (left, bottom)])
    sides = np.stack([face.corners[1] - face.corners[0], face.corners[3] - face.corners[0]])
    pixels = _pixels(face.corners[0] + shares @ sides, pose) - window[:2]
    places = np.rint(FINE * pixels + (FINE - 1) / 2).astype(np.int32)
    cv2.fillConvexPoly(light, places, skin)
