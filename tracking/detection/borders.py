"""Straight borders of dark blobs, and the quadrilaterals that four of them span."""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Picture = NDArray[np.uint8]
Index = NDArray[np.intp]

WINDOW = 25
"""Side of the square whose mean a pixel must be darker than [px]: dark cells larger than this turn
hollow, but keep their borders."""

DARKER = 5
"""By how much it must be darker [grey levels]: little, for dark rooms; blurred noise is less."""

SHORTEST_BLOB = 56
"""Length of the outline of the smallest blob [px]: a marker of 14 px."""

THINNEST_BLOB = 12
"""Smallest extent of a blob along rows and columns [px]: grain and lines of writing are thinner."""

COARSE = 1.6
"""How far an outline may leave a straight side [px]."""

SHORTEST = 7.0
"""Length of the shortest side that is used [px]."""

CONTRAST = 12.0
"""Least difference of the grey levels on both sides of a border."""

MOST = 80
"""Segments of one blob that are combined, the longest first."""

SHARPEST = 0.25
"""Least sine of the angle between neighbouring sides of a quadrilateral."""

OVERLAP = 3.0
"""How far a side may reach over a corner [px]: outlines are round where blur is."""


@dataclass(frozen=True)
class BorderSegments:
    """Straight pieces of borders, dark on the right hand as one goes from start to end."""

    start: Array
    """Where each begins, (N, 2) [px]."""

    end: Array
    """Where each ends, (N, 2) [px]."""

    blob: Index
    """Number of the blob that each belongs to, (N,), ascending."""

    def __len__(self) -> int:
        return len(self.start)

    @property
    def length(self) -> Array:
        """Lengths, (N,) [px]."""
        return np.asarray(np.hypot(*(self.end - self.start).T))

    def of(self, chosen: Index | NDArray[np.bool_]) -> "BorderSegments":
        """Choose some of them."""
        return BorderSegments(self.start[chosen], self.end[chosen], self.blob[chosen])


def find_border_segments(grey: Picture) -> BorderSegments:
    """Find the straight borders of the dark blobs in a picture, (H, W) grey, slightly blurred."""
    dark = cv2.adaptiveThreshold(
        grey, 255, cv2.ADAPTIVE_THRESH_MEAN_C, cv2.THRESH_BINARY_INV, WINDOW, DARKER
    )
    outlines = cv2.findContours(dark, cv2.RETR_LIST, cv2.CHAIN_APPROX_NONE)[0]
    loops = [
        cv2.approxPolyDP(outline, COARSE, True)[:, 0]
        for outline in outlines
        if len(outline) >= SHORTEST_BLOB and min(cv2.boundingRect(outline)[2:]) >= THINNEST_BLOB
    ]
    if not loops:
        return BorderSegments(np.zeros((0, 2)), np.zeros((0, 2)), np.zeros(0, np.intp))
    counts = np.array([len(loop) for loop in loops])
    points = np.concatenate(loops).astype(np.float64)
    following = np.arange(1, len(points) + 1)
    following[np.cumsum(counts) - 1] -= counts
    # OpenCV walks round a blob with the dark on the left hand (y down): turn all round.
    sides = BorderSegments(points[following], points, np.repeat(np.arange(len(loops)), counts))
    sides = sides.of(sides.length >= SHORTEST)
    return _longest(sides.of(_bordering(sides, grey)))


def _bordering(sides: BorderSegments, grey: Picture) -> NDArray[np.bool_]:
    """Whether there is a step from dark to bright across the middle of each side."""
    height, width = grey.shape
    way = (sides.end - sides.start) / sides.length[:, None]
    across = np.stack([way[:, 1], -way[:, 0]], axis=1)  # to the left hand: the bright side
    values = []
    for share in (0.3, 0.5, 0.7):
        middle = sides.start + share * (sides.end - sides.start)
        for reach in (-2.0, 3.0):
            x, y = np.rint(middle + reach * across).astype(np.intp).T
            seen = (x >= 0) & (x < width) & (y >= 0) & (y < height)
            value = grey[np.clip(y, 0, height - 1), np.clip(x, 0, width - 1)]
            values.append(np.where(seen, value, np.nan))
    table = np.asarray(values, np.float64)
    return np.asarray(np.median(table[1::2] - table[::2], axis=0) > CONTRAST)


def _longest(sides: BorderSegments) -> BorderSegments:
    """Keep the longest sides of each blob, and blobs with three sides at least."""
    order = np.lexsort((-sides.length, sides.blob))
    blob = sides.blob[order]
    first = np.searchsorted(blob, blob, side="left")
    rank = np.arange(len(blob)) - first
    count = np.searchsorted(blob, blob, side="right") - first
    return sides.of(np.sort(order[(rank < MOST) & (count > 2)]))


def quadrilaterals(sides: BorderSegments) -> tuple[Index, Array]:
    """Combine sides that can be the four sides of one dark square, parts of them hidden.

    Returns
    -------
    Numbers of the sides, (Q, 4), clockwise as seen (y down), and the corners, (Q, 4, 2) [px]:
    corner k lies between the sides k − 1 and k.
    """
    first, second, corner = _neighbours(sides)
    if not len(first):
        return np.zeros((0, 4), np.intp), np.zeros((0, 4, 2))
    begins = np.searchsorted(first, np.arange(len(sides) + 1))
    chain = np.stack([first, second], axis=1)
    meets = corner[:, None]
    for _ in range(2):
        chain, meets = _extended(chain, meets, begins, second, corner)
    # The fourth side must meet the first again: look its pair up.
    key = first * len(sides) + second
    wanted = chain[:, 3] * len(sides) + chain[:, 0]
    closing = np.minimum(np.searchsorted(key, wanted), len(key) - 1)
    whole = key[closing] == wanted
    corners = np.concatenate([corner[closing[whole]][:, None], meets[whole]], axis=1)
    return chain[whole], corners


def _neighbours(sides: BorderSegments) -> tuple[Index, Index, Array]:
    """Pairs of sides of one blob that meet clockwise, (P,), (P,), and where they do, (P, 2)."""
    begin = np.searchsorted(sides.blob, sides.blob, side="left")
    count = np.searchsorted(sides.blob, sides.blob, side="right") - begin
    a = np.repeat(np.arange(len(sides)), count)
    b = np.arange(len(a)) - np.repeat(np.cumsum(count) - count, count) + np.repeat(begin, count)
    length = sides.length
    way = (sides.end - sides.start) / length[:, None]
    turn = way[a, 0] * way[b, 1] - way[a, 1] * way[b, 0]
    keep = turn > SHARPEST
    a, b, turn = a[keep], b[keep], turn[keep]
    offset = sides.start[b] - sides.start[a]
    # start_a + s way_a = start_b + t way_b
    s = (offset[:, 0] * way[b, 1] - offset[:, 1] * way[b, 0]) / turn
    t = (offset[:, 0] * way[a, 1] - offset[:, 1] * way[a, 0]) / turn
    ahead, behind = s - length[a], -t
    # No more than three quarters of a side are hidden at one end.
    keep = (ahead > -OVERLAP) & (behind > -OVERLAP)
    keep &= (ahead < 3 * length[a]) & (behind < 3 * length[b])
    a, b, s = a[keep], b[keep], s[keep]
    return a, b, sides.start[a] + s[:, None] * way[a]


def _extended(
    chain: Index, meets: Array, begins: Index, second: Index, corner: Array
) -> tuple[Index, Array]:
    """Append to each chain of sides every side that its last one meets."""
    last = chain[:, -1]
    count = begins[last + 1] - begins[last]
    old = np.repeat(np.arange(len(chain)), count)
    pair = np.arange(len(old)) - np.repeat(np.cumsum(count) - count, count)
    pair += np.repeat(begins[last], count)
    # Each square once, begun at its side of least number; and each side once in it.
    keep = second[pair] > chain[old, 0]
    keep &= (second[pair][:, None] != chain[old]).all(axis=1)
    old, pair = old[keep], pair[keep]
    grown = np.concatenate([chain[old], second[pair][:, None]], axis=1)
    return grown, np.concatenate([meets[old], corner[pair][:, None]], axis=1)
