"""Straight border segments of dark blobs, and the quadrilaterals that four of them span."""

from dataclasses import dataclass

import cv2
import numpy as np

from cubeling.tracking.geometry.arrays import Array, Flags, Image, Indices

THRESHOLD_WINDOW_PX, THRESHOLD_OFFSET = 25, 5
"""A dark pixel is this many grey levels below the mean of this window. Larger dark cells become
hollow but keep their borders; dark rooms need a small offset, noise a larger one."""

MIN_BLOB_EXTENT_PX, MIN_BLOB_EXTENTS_PX = 12, 30
"""Smallest extent of a blob along rows and columns, as noise and lines of text are thinner, and sum
of both: a marker of 14 px."""

MAX_DEVIATION_PX = 1.6
"""How far an outline may deviate from a straight segment."""

MIN_SEGMENT_PX = 7.0
"""Length of the shortest segment."""

MIN_CONTRAST, CONTRAST_WINDOW_PX = 12.0, 9
"""Least difference of the grey levels on both sides of a border, and the window around a dark pixel
in which something is brighter by so much. What lies on even surfaces costs most of the time."""

MAX_SEGMENTS = 80
"""Segments of one blob that are combined, the longest first."""

MIN_CORNER_SINE = 0.25
"""Least sine of the angle between neighbouring sides of a quadrilateral."""

MAX_OVERLAP_PX, MAX_OVERLAP_SHARE = 3.0, 0.25
"""How far a segment may extend beyond a corner, as blur rounds outlines, or which share of it, as
what covers the corner may be dark too."""


@dataclass(frozen=True)
class BorderSegments:
    """Straight pieces of borders, with the dark side on the right from start to end."""

    start: Array
    """Start of each, (N, 2) [px]."""

    end: Array
    """End of each, (N, 2) [px]."""

    blob: Indices
    """Index of the blob of each, (N,), ascending."""

    def __len__(self) -> int:
        return len(self.start)

    @property
    def length(self) -> Array:
        """Distance from start to end, (N,) [px]."""
        return np.asarray(np.hypot(*(self.end - self.start).T))

    def select(self, chosen: Indices | Flags) -> "BorderSegments":
        """Return some of them."""
        return BorderSegments(self.start[chosen], self.end[chosen], self.blob[chosen])


def find_border_segments(grey: Image) -> BorderSegments:
    """Find the straight borders of the dark blobs in a grey image, (H, W), slightly blurred."""
    outlines = cv2.findContoursLinkRuns(_dark_pixels(grey))[0]
    loops = [
        cv2.approxPolyDP(outline, MAX_DEVIATION_PX, True)[:, 0]
        for outline in outlines
        if _is_large(outline)
    ]
    if not loops:
        return BorderSegments(np.zeros((0, 2)), np.zeros((0, 2)), np.zeros(0, np.intp))
    counts = np.array([len(loop) for loop in loops])
    points = np.concatenate(loops).astype(np.float64)
    following = np.arange(1, len(points) + 1)
    following[np.cumsum(counts) - 1] -= counts
    # OpenCV's link runs go around a blob with the dark side on the right (y down).
    segments = BorderSegments(points, points[following], np.repeat(np.arange(len(loops)), counts))
    segments = segments.select(segments.length >= MIN_SEGMENT_PX)
    return _longest(segments.select(_has_contrast(segments, grey)))


def _dark_pixels(grey: Image) -> Image:
    """Return 255 where a pixel is darker than those around it, and not only by noise, else 0."""
    window = (THRESHOLD_WINDOW_PX, THRESHOLD_WINDOW_PX)
    mean = cv2.blur(grey, window, borderType=cv2.BORDER_REPLICATE)
    # The same as cv2.adaptiveThreshold, which is not vectorized.
    darker = cv2.subtract(mean, grey)
    dark = cv2.threshold(darker, THRESHOLD_OFFSET - 1, 255, cv2.THRESH_BINARY)[1]
    brightest = cv2.dilate(grey, np.ones((CONTRAST_WINDOW_PX, CONTRAST_WINDOW_PX), np.uint8))
    contrast = cv2.subtract(brightest, grey)
    stands_out = cv2.threshold(contrast, MIN_CONTRAST - 1, 255, cv2.THRESH_BINARY)[1]
    return np.asarray(cv2.bitwise_and(dark, stands_out), np.uint8)


def _is_large(outline: cv2.typing.MatLike) -> bool:
    """Whether an outline, (N, 1, 2), is that of a blob as large as a marker."""
    if len(outline) < MIN_BLOB_EXTENT_PX:  # at least one point in each row
        return False
    width, height = cv2.boundingRect(outline)[2:]
    return min(width, height) >= MIN_BLOB_EXTENT_PX and width + height >= MIN_BLOB_EXTENTS_PX


def _has_contrast(segments: BorderSegments, grey: Image) -> Flags:
    """Whether there is a step from dark to bright across the middle of each segment."""
    height, width = grey.shape
    ahead = segments.end - segments.start
    across = ahead[:, ::-1] * (1.0, -1.0) / segments.length[:, None]  # to the bright side
    middle = segments.start + np.array([0.3, 0.5, 0.7])[:, None, None] * ahead
    places = middle + np.array([-2.0, 3.0])[:, None, None, None] * across
    x, y = np.rint(np.moveaxis(places, -1, 0)).astype(np.intp)
    seen = ((x >= 0) & (x < width) & (y >= 0) & (y < height)).all(axis=(0, 1))
    inner, outer = grey[np.clip(y, 0, height - 1), np.clip(x, 0, width - 1)].astype(np.float64)
    one, two, three = outer - inner
    median = np.maximum(np.minimum(one, two), np.minimum(np.maximum(one, two), three))
    return np.asarray(seen & (median > MIN_CONTRAST))


def _longest(segments: BorderSegments) -> BorderSegments:
    """Keep the longest segments of each blob, and blobs with at least three segments."""
    order = np.lexsort((-segments.length, segments.blob))
    blob = segments.blob[order]
    first = np.searchsorted(blob, blob, side="left")
    rank = np.arange(len(blob)) - first
    count = np.searchsorted(blob, blob, side="right") - first
    return segments.select(np.sort(order[(rank < MAX_SEGMENTS) & (count > 2)]))


def quadrilaterals(segments: BorderSegments) -> tuple[Indices, Array]:
    """Combine segments that can be the four sides of one dark quad, parts of which are hidden.

    Return their indices, (Q, 4), clockwise as seen (y down), and the corners, (Q, 4, 2) [px]:
    corner k lies between the segments k − 1 and k.
    """
    first, second, corner = _neighbours(segments)
    if not len(first):
        return np.zeros((0, 4), np.intp), np.zeros((0, 4, 2))
    begins = np.searchsorted(first, np.arange(len(segments) + 1))
    chain = np.stack([first, second], axis=1)
    meets = corner[:, None]
    for _ in range(2):
        chain, meets = _extend(chain, meets, begins, second, corner)
    # The fourth segment must meet the first again: look up this pair.
    key = first * len(segments) + second
    wanted = chain[:, 3] * len(segments) + chain[:, 0]
    closing = np.minimum(np.searchsorted(key, wanted), len(key) - 1)
    whole = key[closing] == wanted
    corners = np.concatenate([corner[closing[whole]][:, None], meets[whole]], axis=1)
    return chain[whole], corners


def _neighbours(segments: BorderSegments) -> tuple[Indices, Indices, Array]:
    """Pairs of segments of one blob that meet clockwise, (P,), (P,), and where, (P, 2)."""
    begin = np.searchsorted(segments.blob, segments.blob, side="left")
    count = np.searchsorted(segments.blob, segments.blob, side="right") - begin
    a = np.repeat(np.arange(len(segments)), count)
    b = np.arange(len(a)) - np.repeat(np.cumsum(count) - count, count) + np.repeat(begin, count)
    length = segments.length
    direction = (segments.end - segments.start) / length[:, None]
    dx, dy = np.ascontiguousarray(direction.T)
    sine = dx[a] * dy[b] - dy[a] * dx[b]
    keep = np.flatnonzero(sine > MIN_CORNER_SINE)
    a, b, sine = a[keep], b[keep], sine[keep]
    x, y = (segments.start[b] - segments.start[a]).T
    # start_a + s direction_a = start_b + t direction_b
    s = (x * dy[b] - y * dx[b]) / sine
    t = (x * dy[a] - y * dx[a]) / sine
    overlap, most = _overlap(length), 3 * length
    ahead, behind = s - length[a], -t
    # At most three quarters of a side are hidden at one end.
    keep = np.flatnonzero(
        (ahead > -overlap[a]) & (behind > -overlap[b]) & (ahead < most[a]) & (behind < most[b])
    )
    a, b, s = a[keep], b[keep], s[keep]
    return a, b, segments.start[a] + s[:, None] * direction[a]


def _overlap(length: Array) -> Array:
    return np.asarray(np.maximum(MAX_OVERLAP_PX, MAX_OVERLAP_SHARE * length), np.float64)


def _extend(
    chain: Indices, meets: Array, begins: Indices, second: Indices, corner: Array
) -> tuple[Indices, Array]:
    """Append to each chain of segments every segment that its last one meets."""
    last = chain[:, -1]
    count = begins[last + 1] - begins[last]
    old = np.repeat(np.arange(len(chain)), count)
    pair = np.arange(len(old)) - np.repeat(np.cumsum(count) - count, count)
    pair += np.repeat(begins[last], count)
    # Each quad once, beginning at its segment of least index, and each segment once in it.
    keep = second[pair] > chain[old, 0]
    keep &= (second[pair][:, None] != chain[old]).all(axis=1)
    old, pair = old[keep], pair[keep]
    grown = np.concatenate([chain[old], second[pair][:, None]], axis=1)
    return grown, np.concatenate([meets[old], corner[pair][:, None]], axis=1)
