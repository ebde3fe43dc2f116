"""Corners of dark quads in an image, parts of which may be hidden."""

from dataclasses import dataclass

import cv2
import numpy as np

from cubeling.tracking.detection.borders import BorderSegments, find_border_segments, quadrilaterals
from cubeling.tracking.geometry.arrays import Array, Flags, Image

MIN_SIDE_PX = 14.0
"""Shortest side of a quad."""

MIN_VISIBLE_OUTLINE, MIN_VISIBLE_SIDE = 0.45, 0.15
"""Share of the outline of a quad that must be visible, and of each side."""

MAX_SIDE_RATIO = 3.0
"""Greatest ratio of opposite sides: beyond, a marker could not be read."""

SEARCH_REACH_PX = 3.0
"""How far from an outline its edge is searched."""


@dataclass(frozen=True)
class Quads:
    """Squares, seen in perspective."""

    corners: Array
    """Clockwise as seen (y down), (N, 4, 2) [px]; a hidden one is where its sides would meet."""

    gaps: Array
    """Hidden part of the sides at each corner, as a share of their length, (N, 4)."""

    visible: Array
    """Visible share of their outlines, (N,)."""

    def __len__(self) -> int:
        return len(self.corners)

    def select(self, chosen: Flags) -> "Quads":
        """Return some of them."""
        return Quads(self.corners[chosen], self.gaps[chosen], self.visible[chosen])

    def map(self, places: Array) -> Array:
        """Map places in the unit square, (M, 2), to the image, (N, M, 2) [px].

        Heckbert 1989, "Fundamentals of texture mapping and image warping", section 2.2.3.
        """
        first, second, third, fourth = np.moveaxis(self.corners, 1, 0)
        skew = first - second + third - fourth
        one, two = second - third, fourth - third
        area = cross(one, two)
        g, h = cross(skew, two) / area, cross(one, skew) / area
        along_u = second - first + g[:, None] * second
        along_v = fourth - first + h[:, None] * fourth
        u, v = places.T
        above = u[:, None] * along_u[:, None] + v[:, None] * along_v[:, None] + first[:, None]
        return np.asarray(above / (g[:, None] * u + h[:, None] * v + 1.0)[..., None], np.float64)


def find_quads(grey: Image) -> Quads:
    """Find dark quads in a grey image, (H, W), slightly blurred."""
    sides = find_border_segments(grey)
    chosen, corners = quadrilaterals(sides)
    length = _side_lengths(corners)
    share = sides.length[chosen] / np.maximum(length, 1.0)
    keep = length.min(axis=1, initial=np.inf) > MIN_SIDE_PX
    keep &= share.mean(axis=1) > MIN_VISIBLE_OUTLINE
    # Up to 1.3: the blur of a small image makes segments longer than the sides they lie on.
    keep &= (share.min(axis=1, initial=1.0) > MIN_VISIBLE_SIDE) & (share < 1.3).all(axis=1)
    # Each side against its opposite one, two corners on.
    keep &= (length < MAX_SIDE_RATIO * length[:, [2, 3, 0, 1]]).all(axis=1)
    if not keep.any():
        return Quads(np.zeros((0, 4, 2)), np.zeros((0, 4)), np.zeros(0))
    # Many quads share their sides: move each side once.
    used, of_quad = np.unique(chosen[keep], return_inverse=True)
    start, end = _move_to_edge(grey, sides.select(used))
    corners = _intersections(start[of_quad], end[of_quad])
    gaps = _gaps(sides.start[chosen[keep]], sides.end[chosen[keep]], corners)
    return Quads(corners, gaps, share[keep].mean(axis=1))


def sample_grey(grey: Image, places: Array) -> Array:
    """Grey values between pixel centres, bilinear, places (N, M, 2) [px] → (N, M)."""
    x, y = np.moveaxis(places.astype(np.float32), -1, 0)
    border = cv2.BORDER_REPLICATE
    return np.asarray(cv2.remap(grey, x, y, cv2.INTER_LINEAR, borderMode=border), np.float64)


def cross(a: Array, b: Array) -> Array:
    """Cross product of vectors in the plane, (…, 2)."""
    return np.asarray(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0], np.float64)


def _side_lengths(corners: Array) -> Array:
    edges = np.roll(corners, -1, axis=1) - corners
    return np.asarray(np.hypot(edges[..., 0], edges[..., 1]), np.float64)


def _move_to_edge(grey: Image, used: BorderSegments) -> tuple[Array, Array]:
    """Move sides to the greatest gradient of the image; return their starts and ends, (N, 2)."""
    direction = (used.end - used.start) / used.length[:, None]
    across = np.stack([direction[:, 1], -direction[:, 0]], axis=1)  # towards the bright side
    # Not up to the corners, where the gradient of the other side begins.
    along = np.linspace(0.1, 0.9, 13)
    reach = np.arange(-SEARCH_REACH_PX, SEARCH_REACH_PX + 1.25, 0.5)  # outlines lie on dark pixels
    middle = used.start[:, None] + along[:, None] * (used.end - used.start)[:, None]
    places = middle[:, :, None] + reach[:, None] * across[:, None, None]
    values = sample_grey(grey, places.reshape(-1, len(reach), 2)).reshape(places.shape[:-1])
    # Only from dark to bright, as the inside of a quad is dark; squared, so that the edge outweighs
    # noise, and the summand keeps a side without any gradient where it is.
    slope = np.square(np.maximum(values[..., 2:] - values[..., :-2], 0.0)) + 1e-3
    offset = (slope @ reach[1:-1]) / slope.sum(axis=-1)
    shift, slant = _fit_lines(along - 0.5, offset)
    start = used.start + (shift - slant / 2)[:, None] * across
    end = used.end + (shift + slant / 2)[:, None] * across
    return start, end


def _fit_lines(x: Array, y: Array) -> tuple[Array, Array]:
    """Fit a line to each row of y, (N, M), at x, (M,): value at 0 and slope, (N,) each."""
    weight = np.ones_like(y)
    for _ in range(2):
        total = weight.sum(axis=1)
        mean_x, mean_y = (weight @ x) / total, np.vecdot(weight, y) / total
        dx, dy = x - mean_x[:, None], y - mean_y[:, None]
        weighted = weight * dx
        slope = np.vecdot(weighted, dy) / np.vecdot(weighted, dx)
        miss = np.abs(dy - slope[:, None] * dx)
        # The second fit leaves out the outliers of the first.
        weight = (miss <= 2.0 * np.median(miss, axis=1)[:, None] + 0.05).astype(np.float64)
    return mean_y - slope * mean_x, slope


def _intersections(start: Array, end: Array) -> Array:
    """Corners between each side and the one before it, sides (N, 4, 2)."""
    direction = end - start
    before, previous = np.roll(start, 1, axis=1), np.roll(direction, 1, axis=1)
    share = cross(start - before, direction) / cross(previous, direction)
    return np.asarray(before + share[..., None] * previous, np.float64)


def _gaps(start: Array, end: Array, corners: Array) -> Array:
    """Return the hidden share of the two sides at each corner, the greater of the two."""
    length = _side_lengths(corners)
    after = np.linalg.norm(start - corners, axis=-1) / length
    before = np.linalg.norm(end - np.roll(corners, -1, axis=1), axis=-1) / length
    return np.asarray(np.maximum(after, np.roll(before, 1, axis=1)), np.float64)
