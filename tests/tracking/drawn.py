"""Pictures of cubes, at rest or in motion, drawn without the tracker's own code.

Light is mixed as during an exposure, before the camera converts it to grey values.
"""

import itertools
from collections.abc import Callable, Sequence

import cv2
import numpy as np
from numpy.typing import NDArray

from cubeling.tracking.cube.marker import marker_cells
from cubeling.tracking.cube.model import CubeModel, Face
from cubeling.tracking.geometry import se3
from cubeling.tracking.geometry.intrinsics import Intrinsics

Array = NDArray[np.float64]
Light = NDArray[np.float32]
Picture = NDArray[np.uint8]

CAMERA = Intrinsics(
    np.array([[600.0, 0, 319.5], [0, 600.0, 239.5], [0, 0, 1]]), np.zeros(5), (640, 480)
)
WIDE = Intrinsics(
    np.array([[900.0, 0, 639.5], [0, 900.0, 359.5], [0, 0, 1]]), np.zeros(5), (1280, 720)
)
SUBSAMPLES_PER_PIXEL, TEXELS_PER_CELL = 3, 20
"""Subsamples along a pixel, and texels along a cell."""

BLACK, WHITE, DESK = 0.04, 0.75, 0.2
"""Share of the light that ink, paper and the desk reflect."""

SHADE = {"front": 1.0, "back": 1.0, "left": 0.8, "right": 0.85, "top": 0.95, "bottom": 0.7}
"""Light that falls on each face."""


def held(
    x: float = 0.5, y: float = 0.6, z: float = 0.1, at: tuple[float, float, float] = (0, 0, 0.4)
) -> Array:
    """Pose (4, 4) of an upright cube turned about y, then x, then z [rad]; seen at three faces."""
    turns = [se3.rotation(angle * axis) for angle, axis in zip((x, y, z), np.eye(3), strict=True)]
    return se3.pose(turns[2] @ turns[0] @ turns[1] @ np.diag([1.0, -1.0, -1.0]), np.array(at))


def scene(
    *cubes: tuple[CubeModel, Array], camera: Intrinsics = CAMERA, sweep: Array | None = None
) -> Light:
    """Light of cubes at their poses, all moving by one pose delta, (H, W).

    Parameters
    ----------
    cubes
        Each with its pose in the middle of the exposure; a later one covers those before.
    camera
        It must have no distortion.
    sweep
        Pose delta of every cube during the exposure, (6,).
    """
    width, height = camera.size
    light = np.full((height, width), DESK, np.float32)
    for cube, pose in cubes:
        way = np.zeros(6) if sweep is None else sweep
        count = 1 if sweep is None else 24
        poses = [se3.apply_delta(pose, ((n + 0.5) / count - 0.5) * way) for n in range(count)]
        left, top, right, bottom = window(cube, poses, camera)
        part = light[top:bottom, left:right]
        drawn = [_drawn(cube, each, camera, part, (left, top)) for each in poses]
        light[top:bottom, left:right] = np.mean(drawn, axis=0)
    return np.asarray(cv2.GaussianBlur(light, (0, 0), 0.6), np.float32)


def photograph(light: Light, exponent: float = 2.2, noise: float = 1.0, seed: int = 1) -> Picture:
    """Grey values of a camera whose light is the grey value to the power `exponent`, (H, W, 3)."""
    return digitised(grey_values(light, exponent), noise, seed)


def rolled(
    cube: CubeModel, pose_at: Callable[[float], Array], readout: float, bands: int, seed: int
) -> Picture:
    """A picture whose rows are exposed one after the other, its middle row at the time 0.

    `pose_at` is where the cube is at a time [s]; each of the `bands` of rows is drawn at once.
    """
    height = CAMERA.size[1]
    starts = np.linspace(0, height, bands + 1).astype(int).tolist()
    parts = []
    for start, end in itertools.pairwise(starts):
        when = readout * ((start + end) / 2 / height - 0.5)
        parts.append(scene((cube, pose_at(when)))[start:end])
    return photograph(np.concatenate(parts), seed=seed)


def grey_values(light: Light, exponent: float = 2.2) -> Light:
    """Grey values of a camera without noise, not yet rounded, (H, W)."""
    return np.asarray(255 * np.clip(light, 0, 1) ** (1 / exponent), np.float32)


def digitised(grey: Light, noise: float = 1.0, seed: int = 1) -> Picture:
    """Grey values with the noise of one frame, rounded, (H, W, 3)."""
    if noise:
        grey = grey.copy()
        grey += np.random.default_rng(seed).normal(0, noise, grey.shape)
    levels = np.clip(np.rint(grey), 0, 255).astype(np.uint8)
    return np.repeat(levels[..., None], 3, axis=2)


def window(cube: CubeModel, poses: Sequence[Array], camera: Intrinsics) -> tuple[int, ...]:
    """Left, top, right and bottom of the pixels around a cube at its poses, with a rim."""
    points = np.concatenate([cube.vertices @ p[:3, :3].T + p[:3, 3] for p in poses])
    seen = points @ camera.matrix.T
    pixels = seen[:, :2] / seen[:, 2:]
    low, high = np.maximum(pixels.min(axis=0) - 4, 0), pixels.max(axis=0) + 5
    right, bottom = np.minimum(high, camera.size).astype(int).tolist()
    left, top = low.astype(int).tolist()
    return left, top, right, bottom


def off(pose: Array | None, truth: Array) -> tuple[float, float]:
    """Errors of a pose [mm, °]."""
    assert pose is not None
    step = se3.delta(pose, truth)
    return float(1000 * np.linalg.norm(step[:3])), float(np.rad2deg(np.linalg.norm(step[3:])))


def _drawn(
    cube: CubeModel, pose: Array, camera: Intrinsics, behind: Light, origin: tuple[int, int]
) -> Light:
    """Draw a sharp cube over what is behind it in a window of the picture, (h, w)."""
    height, width = behind.shape
    canvas = np.repeat(
        np.repeat(behind, SUBSAMPLES_PER_PIXEL, axis=0), SUBSAMPLES_PER_PIXEL, axis=1
    )
    finer = np.array(
        [
            [SUBSAMPLES_PER_PIXEL, 0, (SUBSAMPLES_PER_PIXEL - 1) / 2],
            [0, SUBSAMPLES_PER_PIXEL, (SUBSAMPLES_PER_PIXEL - 1) / 2],
            [0, 0, 1.0],
        ]
    )
    shifted = np.array([[1, 0, -origin[0]], [0, 1, -origin[1]], [0, 0, 1.0]])
    for side in cube.body:
        corners = side.corners @ pose[:3, :3].T + pose[:3, 3]
        if (pose[:3, :3] @ side.normal) @ corners[0] < 0:
            seen = corners @ (finer @ shifted @ camera.matrix).T
            grey = WHITE * SHADE.get(side.name, 0.9)
            points = np.rint(16 * seen[:, :2] / seen[:, 2:]).astype(np.int32)
            cv2.fillConvexPoly(canvas, points, grey, shift=4)
    for face in cube.faces:
        centre = pose[:3, :3] @ face.corners.mean(axis=0) + pose[:3, 3]
        if (pose[:3, :3] @ face.normal) @ centre >= 0:
            continue
        texture = _paper(cube, face)
        homography = finer @ shifted @ camera.matrix @ _plane(cube, face, len(texture), pose)
        size = (SUBSAMPLES_PER_PIXEL * width, SUBSAMPLES_PER_PIXEL * height)
        seen = cv2.warpPerspective(texture, homography, size, flags=cv2.INTER_LINEAR)
        solid = np.ones_like(texture)
        inside = cv2.warpPerspective(solid, homography, size, flags=cv2.INTER_NEAREST) > 0
        canvas[inside] = seen[inside]
    return np.asarray(cv2.resize(canvas, (width, height), interpolation=cv2.INTER_AREA), np.float32)


def _paper(cube: CubeModel, face: Face) -> Light:
    """One face from outside, its white paper with it, square."""
    cells = np.kron(
        marker_cells(cube.dictionary, face.marker_id), np.ones((TEXELS_PER_CELL, TEXELS_PER_CELL))
    )
    rim = round((cube.paper / cube.marker_size - 1) / 2 * len(cells))
    texture = WHITE + (BLACK - WHITE) * np.pad(cells, rim)
    return (SHADE.get(face.side, 0.9) * texture).astype(np.float32)


def _plane(cube: CubeModel, face: Face, count: int, pose: Array) -> Array:
    """Point in the camera's frame for the (column, row, 1) of a texel, (3, 3)."""
    # By whole texels, as the paper is drawn.
    grow = count / (TEXELS_PER_CELL * len(marker_cells(cube.dictionary, face.marker_id)))
    centre = face.corners.mean(axis=0)
    corners = (centre + grow * (face.corners - centre)) @ pose[:3, :3].T + pose[:3, 3]
    right, down = (corners[1] - corners[0]) / count, (corners[3] - corners[0]) / count
    return np.stack([right, down, corners[0] + (right + down) / 2], axis=1)
