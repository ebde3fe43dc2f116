"""Paths painted on the table: discs, a ring, and dashes between them.

They are painted into an image of the table when they change, which is bent when they or the camera
have moved. Every picture is blended with it in memory.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import chain, repeat

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.rendering.camera_picture.hand_cover import PictureCover
from cubeling.characters.rendering.camera_picture.hidden_table import hidden_table
from cubeling.characters.rendering.passes.render_pass import RenderPass
from cubeling.characters.rendering.passes.shadows import DISPLAY_GAMMA
from cubeling.characters.rendering.passes.table_image import TableImage
from cubeling.characters.rendering.projection import NEAR_M, Rectangle
from cubeling.characters.rendering.resources import FrameResources
from cubeling.characters.rendering.scene import FloorPath
from cubeling.characters.skeleton.pose import Array

POINT_RADIUS_M, HIGHLIGHT_RADIUS_M = 0.005, 0.0075
"""Radii of a point, and of the highlighted one [m]."""

RING_RADII_M = (0.0105, 0.0125)
"""Inner and outer radius of the ring around the highlighted point [m]."""

DASH_M, GAP_M, DASH_WIDTH_M = 0.011, 0.008, 0.0028
"""Length of a dash, of the gap after it, and width of a dash [m]."""

CLEARANCE_M = 0.006
"""Distance between a disc and the first dash [m]."""

PAINT_OPACITY = 0.82
"""Share of the table that paint hides."""

MAX_SIDE_TEXELS, RIM_TEXELS = 2048, 4
"""Longest side of an image of paths, and its empty rim; texels are larger where paths reach
further."""

SAME_PX = 0.05
"""Paint is not bent again while the camera sees no corner of its image further off [px]: the table
trembles less than that where the cube that shows it rests."""


class FloorPathPass(RenderPass):
    """Paints the floor paths on the table."""

    def __init__(self) -> None:
        self._kept: list[_SeenPaint | None] = []

    def composite(self, frame: FrameResources, cover: PictureCover | None) -> None:
        """Paint the paths, except where real cubes or a hand hide them."""
        floor = frame.scene.floor
        self._kept = [
            _seen_paint(path, frame, last)
            for path, last in zip(floor, chain(self._kept, repeat(None)), strict=False)
        ]
        for seen, path in zip(self._kept, floor, strict=True):
            if seen is not None:
                seen.blend(frame, cover, path)


@dataclass(frozen=True)
class _SeenPaint:
    """The paint of a path as one camera sees it, while nothing hides it."""

    key: tuple[object, ...]
    """What the paint depends on."""

    image: TableImage
    """The paint on the table."""

    rays: Array
    """Where the camera saw the corners of the image, see `_rays`, (4, 3) [px]."""

    area: Rectangle | None
    """The area of the picture around it."""

    places: NDArray[np.int32]
    """Rows and columns in the area of the pixels that it covers, (2, n): few of all."""

    share: NDArray[np.float32]
    """The share of each of these pixels that it covers, (n,)."""

    def blend(self, frame: FrameResources, cover: PictureCover | None, path: FloorPath) -> None:
        """Blend it, lit as the table is, with the picture."""
        if self.area is None or not len(self.share):
            return
        place, share = tuple(self.places), self.share
        hidden = hidden_table(frame.hidden_by_cubes, cover, self.area)
        if hidden is not None:
            share = share * (1.0 - hidden[place] / np.float32(255.0))
        light = np.asarray(path.color, float) ** DISPLAY_GAMMA * frame.light.white
        paint = 255.0 * np.clip(light[::-1], 0.0, 1.0) ** (1.0 / DISPLAY_GAMMA)
        part = frame.picture[self.area.slices]
        before = part[place]
        part[place] = np.rint(
            before + PAINT_OPACITY * share[:, None] * (paint.astype(np.float32) - before)
        )


def _seen_paint(
    path: FloorPath, frame: FrameResources, last: _SeenPaint | None
) -> _SeenPaint | None:
    """Return how the camera of a frame sees the paint of a path; None without a point.

    `last` is the one before: it is the same, or at least its image is, while nothing has changed.
    """
    points = np.asarray(path.points, float).reshape(-1, 2)
    numbers = np.flatnonzero(np.isfinite(points).all(axis=1))
    if not len(numbers):
        return None
    places = points[numbers]
    texel = _texel(frame, places)
    key = points.tobytes(), path.closed, path.highlight, texel
    known = last if last is not None and last.key == key else None
    image = (
        known.image
        if known
        else _paint_share(places, path.closed, numbers == path.highlight, texel)
    )
    rays = _rays(frame, image.corners)
    if known is not None and np.abs(rays - known.rays).max() < SAME_PX:
        return known
    area, share = frame.area_of(image.corners), np.zeros((0, 0), np.uint8)
    if area is not None:
        share = image.in_picture(frame, area, beyond=0)
    pixels = np.stack(np.nonzero(share))
    share_of_pixels = share[tuple(pixels)] / np.float32(255.0)
    return _SeenPaint(key, image, rays, area, pixels.astype(np.int32), share_of_pixels)


def _rays(frame: FrameResources, points: Array) -> Array:
    """Return the directions in which the camera sees points (n, 3) of the table, behind it too.

    They are unit vectors times the camera matrix, (n, 3) [px].
    """
    pose = frame.camera_from_table
    in_camera = points @ pose[:3, :3].T + pose[:3, 3]
    distance = np.linalg.norm(in_camera, axis=1, keepdims=True)
    return np.asarray(in_camera / np.maximum(distance, 1e-9) @ frame.camera_matrix.T)


def _texel(frame: FrameResources, points: Array) -> float:
    """Return a side of texels that are about as large as the nearest pixels of a path [m].

    It is a power of two, so that paths are seldom painted again.
    """
    row = frame.camera_from_table[2]
    depth = max(float((points @ row[[0, 2]]).min() + row[3]), NEAR_M)
    exponent = round(math.log2(depth / float(frame.camera_matrix[1, 1])))
    side = float(np.ptp(points, axis=0).max()) + 2.0 * RING_RADII_M[1]
    return 2.0 ** max(exponent, math.ceil(math.log2(side / (MAX_SIDE_TEXELS - 2 * RIM_TEXELS))))


def _paint_share(
    places: Array, closed: bool, highlighted: NDArray[np.bool_], texel: float
) -> TableImage:
    """Return the share of each texel that paint covers; `places` are finite, (n, 2) [m]."""
    capsules = _discs(places, highlighted)
    if texel < DASH_M:  # else dashes are not seen, and may be many
        capsules = np.concatenate([capsules, *_dashes(places, closed, highlighted)])
    reach = RING_RADII_M[1] + (RIM_TEXELS - 1) * texel
    corner = np.floor((places.min(axis=0) - reach) / texel) * texel
    columns, rows = np.ceil((places.max(axis=0) + reach - corner) / texel).astype(int).tolist()
    pixels = np.zeros((rows, columns), np.uint8)
    for capsule in capsules.tolist():
        _paint(pixels, corner.tolist(), texel, capsule)
    return TableImage(pixels, (float(corner[0]), float(corner[1])), texel)


def _paint(
    pixels: NDArray[np.uint8], corner: Sequence[float], texel: float, capsule: Sequence[float]
) -> None:
    """Paint a capsule, a row of `_discs`, into an image; its edge is a texel wide."""
    x, z, along_x, along_z, half_length, radius, hole = capsule
    far = half_length + radius + 2.0 * texel
    (left, right), (near, end) = (
        (int((middle - far - low) / texel), int((middle + far - low) / texel) + 1)
        for middle, low in zip((x, z), corner, strict=True)
    )
    beside = corner[0] + texel * (np.arange(left, right) + 0.5) - x
    ahead = corner[1] + texel * (np.arange(near, end) + 0.5)[:, None] - z
    beyond = np.maximum(np.abs(beside * along_x + ahead * along_z) - half_length, 0.0)
    off = np.hypot(beyond, ahead * along_x - beside * along_z)
    covered = np.clip((radius - off) / texel + 0.5, 0.0, 1.0)
    if hole > 0.0:
        covered *= np.clip((off - hole) / texel + 0.5, 0.0, 1.0)
    part = pixels[near:end, left:right]
    np.maximum(part, np.rint(255.0 * covered).astype(np.uint8), out=part)


def _discs(points: Array, highlighted: NDArray[np.bool_]) -> Array:
    """Return the points of a path as capsules without length, with the ring, (n, 7).

    Centre and direction on the table, half length, radius, radius of the hole [m].
    """
    discs = np.zeros((len(points), 7))
    discs[:, 0:2], discs[:, 2] = points, 1.0
    discs[:, 5] = np.where(highlighted, HIGHLIGHT_RADIUS_M, POINT_RADIUS_M)
    rings = discs[highlighted]
    rings[:, 6], rings[:, 5] = RING_RADII_M
    return np.concatenate([discs, rings])


def _dashes(points: Array, closed: bool, highlighted: NDArray[np.bool_]) -> list[Array]:
    """Return the dashes of each segment, as `_discs` returns points."""
    count = len(points)
    segments = [(i, (i + 1) % count) for i in range(count if closed and count > 2 else count - 1)]
    clearance = np.where(highlighted, RING_RADII_M[1], POINT_RADIUS_M) + CLEARANCE_M
    dashes = []
    for start, end in segments:
        step = points[end] - points[start]
        length = float(np.linalg.norm(step))
        free = length - clearance[start] - clearance[end]
        number = int((free + GAP_M) // (DASH_M + GAP_M))
        if number < 1:
            continue
        along = step / length
        # Half of the remainder is left free before the first dash, half after the last.
        remainder = free - number * DASH_M - (number - 1) * GAP_M
        first = clearance[start] + 0.5 * remainder + 0.5 * DASH_M
        centers = points[start] + along * (first + (DASH_M + GAP_M) * np.arange(number))[:, None]
        shape = np.tile(
            [*along, 0.5 * (DASH_M - DASH_WIDTH_M), 0.5 * DASH_WIDTH_M, 0.0], (number, 1)
        )
        dashes.append(np.hstack([centers, shape]))
    return dashes
