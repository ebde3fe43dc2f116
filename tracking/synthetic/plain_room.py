"""Cubes on a plain ground, as they were tracked: what is shown where no picture was recorded."""

from collections.abc import Sequence

import cv2
import numpy as np

from cubeling.tracking.cube.model import CubeModel
from cubeling.tracking.geometry.arrays import Array, Floats, Image
from cubeling.tracking.geometry.intrinsics import Intrinsics
from cubeling.tracking.geometry.projection import MIN_DEPTH
from cubeling.tracking.synthetic.camera_rays import CameraRays
from cubeling.tracking.synthetic.paper_cube import TO_LIGHT, PaperCube
from cubeling.tracking.synthetic.shadow import cast_shadow

GROUND, LINE = 176.0, 158.0
"""Grey of the ground, and of the lines on it where they are seen best."""

SQUARE_M, LINES = 0.05, 21
"""Side of the squares between the lines [m], and the number of lines each way from the middle."""

FADE_STEPS = 6
"""Steps in which the lines fade towards their ends."""

LINES_REACH = 1.2
"""How far out the lines are drawn, as a multiple of the way to the picture's edge."""

CUBE_SAMPLES = 2
"""The cube is drawn by the square of so many rays for each pixel."""


class PlainRoom:
    """Draws the pictures that a camera would take of cubes on a grey ground with lines.

    The same poses give the same picture, whatever was drawn before.

    Parameters
    ----------
    intrinsics
        Of the camera; the pictures have their size.
    cubes
        The cubes, in the order of their poses.
    """

    def __init__(self, intrinsics: Intrinsics, cubes: Sequence[CubeModel]) -> None:
        self._camera = CameraRays(intrinsics)
        self._cubes = [PaperCube(each, self._camera, seed=0) for each in cubes]
        self._table: Array | None = None
        self._begin()

    def look_through(self, intrinsics: Intrinsics) -> None:
        """Take another lens, or another camera."""
        self._camera = CameraRays(intrinsics)
        for cube in self._cubes:
            cube.camera = self._camera
        self._begin()

    def draw(self, camera_from_table: Array | None, poses: Sequence[Array | None]) -> Image:
        """Return the picture, (H, W, 3) uint8 BGR.

        Parameters
        ----------
        camera_from_table
            Pose of the table, (4, 4); None before it is known: then the ground has no lines.
        poses
            `camera_from_cube` of each cube, (4, 4); None for one that is not seen.
        """
        table = camera_from_table
        if not _same(table, self._table):
            self._table, self._ground = table, self._draw_ground(table)
        image = self._ground.copy()
        # Until the table is known, as for a camera that looks along it.
        upright = np.diag([1.0, -1.0, -1.0]) if table is None else table[:3, :3]
        to_light = upright @ TO_LIGHT / np.linalg.norm(TO_LIGHT)
        if table is not None:
            table_from_camera = np.linalg.inv(table)
            for cube, pose in zip(self._cubes, poses, strict=True):
                if pose is not None:
                    cast_shadow(image, self._camera, cube.corners(table_from_camera @ pose))
        seen = [(c, p) for c, p in zip(self._cubes, poses, strict=True) if p is not None]
        for cube, pose in sorted(seen, key=lambda each: -float(each[1][2, 3])):  # far ones first
            region = cube.region(pose)
            if not region.empty:
                colour, cover = cube.draw(region, [pose], to_light, CUBE_SAMPLES)
                part = image[region.index]
                part *= 1.0 - cover
                part += colour
        # It rounds, and limits to 0…255.
        return np.asarray(cv2.convertScaleAbs(image), np.uint8)

    def _begin(self) -> None:
        # A lens bends what is far outside of the picture back into it.
        self._reach = LINES_REACH * np.abs(self._camera.rays(self._camera.whole(), 1)).max((0, 1))
        self._table = None
        self._ground = self._draw_ground(None)

    def _draw_ground(self, table: Array | None) -> Floats:
        """Return the ground with its lines, (H, W, 3)."""
        width, height = self._camera.size
        canvas = np.full((height, width, 3), GROUND, np.uint8)
        if table is not None:
            self._camera.camera_from_table = table
            pieces, ends = _line_pieces()
            in_camera = self._camera.from_table(pieces.reshape(-1, 3))
            depth = in_camera[:, 2:]
            seen = (depth > MIN_DEPTH) & (np.abs(in_camera[:, :2]) < self._reach * depth)
            kept = seen.reshape(len(pieces), -1).all(axis=1)
            pixels = self._camera.pixels(in_camera[np.repeat(kept, 2)]).reshape(-1, 2, 2)
            thickness = max(1, round(height / 540))
            for step in range(FADE_STEPS):
                level = LINE + (GROUND - LINE) * step / FADE_STEPS
                points = np.round(pixels[ends[kept] == step] * 16).astype(np.int32)
                cv2.polylines(canvas, list(points), False, (level,) * 3, thickness, cv2.LINE_AA, 4)
        return canvas.astype(np.float32)


def _same(one: Array | None, other: Array | None) -> bool:
    return one is other or (one is not None and other is not None and np.array_equal(one, other))


def _line_pieces() -> tuple[Array, Array]:
    """Return pieces of the lines on the table, (n, 2, 3) [m], and how far each fades, (n,)."""
    steps = SQUARE_M * np.arange(-LINES, LINES + 1)
    along, across = np.meshgrid(steps[:-1], steps)
    starts = np.stack([along.ravel(), np.zeros(along.size), across.ravel()], axis=1)
    pieces = np.stack([starts, starts + (SQUARE_M, 0.0, 0.0)], axis=1)
    pieces = np.concatenate([pieces, pieces[:, :, ::-1]])
    reach = np.linalg.norm(pieces.mean(axis=1), axis=1) / (LINES * SQUARE_M)
    return pieces, np.floor(np.clip(reach, 0.0, 1.0) * FADE_STEPS)
