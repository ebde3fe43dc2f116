"""Detection of markers with a corner under a finger or outside the image."""

import cv2
import numpy as np

from cubeling.tracking.cube.marker import marker_cells
from cubeling.tracking.cube.model import CubeModel
from cubeling.tracking.detection.markers import Observation
from cubeling.tracking.detection.quads import Quads, find_quads, sample_grey
from cubeling.tracking.detection.smeared_patterns import SmearedPatterns
from cubeling.tracking.geometry.arrays import Array, Flags, Image, Indices
from cubeling.tracking.geometry.image_region import Region

UNREAD_BAND = 0.15
"""A cell closer to the middle between black and white than this share of the contrast is unread."""

PAPER_DISTANCE_CELLS = 0.4
"""How far outside the marker its white paper is sampled: no cube has a narrower border."""

MIN_FRAME_SHARE = 0.6
"""Share of the border cells that must be black, and of the paper around them that must be white."""

MIN_RIGHT_SHARE = 0.5
"""Share of the inner cells that must be read and be right."""

MAX_WRONG_SHARE = 0.07
"""Share of the read cells that may be wrong where a corner is hidden; else none may be."""

MAX_GAP_CELLS = 0.7
"""Cells of a side that may be missing at a corner that counts as visible."""

CLEAR_SHARE = 0.85
"""A quad of which more cells than this share are read, and that is no marker, is something else."""

UNREAD, OTHER = -1, -2
"""Instead of the number of a marker: cells that cannot be read, and those of something else."""

MIN_LEAD_SHARE = 0.12
"""Share of the cells by which the best marker must fit better than the second."""

MIN_CONTRAST = 8
"""Least contrast between paper and border [grey levels]."""


class PartlyHiddenMarkerDetector:
    """Detects markers of one cube by the visible parts of their four sides.

    OpenCV looks for whole quads; here four straight segments of one blob's border are enough. The
    result is a proposal to check on all edges: a hand can cover the cells that tell markers apart.
    """

    def __init__(self, cube: CubeModel) -> None:
        self._faces = cube.faces
        self._smeared = SmearedPatterns(cube)
        patterns = [marker_cells(cube.dictionary, face.marker_id) for face in cube.faces]
        self._count = count = len(patterns[0])
        # Every marker in four rotations: rotated k times, its corner 0 is corner −k of the quad.
        turned = [np.rot90(pattern, turn) for pattern in patterns for turn in range(4)]
        self._white = np.stack([~each[1:-1, 1:-1].ravel() for each in turned]).astype(np.float64)
        steps = np.concatenate(
            [[-PAPER_DISTANCE_CELLS], np.arange(count) + 0.5, [count + PAPER_DISTANCE_CELLS]]
        )
        x, y = (axis.ravel() for axis in np.meshgrid(steps, steps))
        self._places = np.stack([x, y], axis=1) / count
        depth = np.minimum(np.minimum(x, y), count - np.maximum(x, y))
        self._paper, self._border, self._bits = depth < 0, (depth > 0) & (depth < 1), depth > 1

    def detect(
        self, grey: Image, region: Region | None = None, doubled: bool = False
    ) -> list[Observation]:
        """Detect markers in a grey image, (H, W), or in a region of it; `doubled` finds small ones.

        Returns
        -------
        Markers, the most certain first, whole ones among them. A marker can occur twice.
        """
        left, top, right, bottom = region or (0, 0, grey.shape[1], grey.shape[0])
        part = grey[top:bottom, left:right]
        if doubled:
            larger = cv2.resize(part, None, fx=2, fy=2, interpolation=cv2.INTER_CUBIC)
            part = np.asarray(larger, np.uint8)
        soft = np.asarray(cv2.GaussianBlur(part, (5, 5), 0), np.uint8)
        quads = find_quads(soft)
        if not len(quads):
            return []
        number, fit = self._read(soft, quads)
        unread = number == UNREAD
        if unread.any():
            number[unread], fit[unread] = self._smeared.match(soft, quads.select(unread))
        # Of quads that fit alike, the most visible one has the best corners.
        order = np.argsort(-(fit + 0.5 * quads.visible), kind="stable")
        origin = np.array([left, top], np.float64)
        found: list[Observation] = []
        for each in order[number[order] >= 0].tolist():
            face, turn = divmod(int(number[each]), 4)
            corners = np.roll(quads.corners[each], turn, axis=0)
            # Pixel centres lie at whole numbers.
            corners = (corners - 0.5) / 2 + origin if doubled else corners + origin
            seen = Observation(self._faces[face], corners)
            if not any(_same(seen, other) for other in found):
                found.append(seen)
        return found

    def _read(self, soft: Image, quads: Quads) -> tuple[Indices, Array]:
        """Identify the marker in each quad: 4 × index of its face + rotation, or below 0."""
        places = quads.map(self._places)
        values = sample_grey(soft, places)
        seen = self._is_uncovered(quads) & _inside(places, soft.shape)
        white = _median(values[:, self._paper], seen[:, self._paper])[:, None]
        black = _median(values[:, self._border], seen[:, self._border])[:, None]
        contrast = white - black
        share = (values - black) / np.where(contrast > MIN_CONTRAST, contrast, np.inf)
        # 1 is white, −1 black, 0 not read.
        sign = np.where(seen & (np.abs(share - 0.5) > UNREAD_BAND), np.sign(share - 0.5), 0.0)
        framed = contrast[:, 0] > MIN_CONTRAST
        framed &= _share(sign[:, self._paper]) > MIN_FRAME_SHARE
        framed &= _share(-sign[:, self._border]) > MIN_FRAME_SHARE
        hidden = quads.gaps.max(axis=1) > MAX_GAP_CELLS / self._count
        return self._match(sign[:, self._bits], framed, np.where(hidden, MAX_WRONG_SHARE, 0.0))

    def _match(self, sign: Array, framed: Flags, wrong_share: Array) -> tuple[Indices, Array]:
        """Find the marker that agrees best with the signs of the inner cells, (N, cells)."""
        fit = sign @ (2 * self._white - 1).T  # right minus wrong
        read = np.abs(sign).sum(axis=1)
        order = np.argsort(fit, axis=1, kind="stable")
        best = order[:, -1]
        most, next_most = np.take_along_axis(fit, order[:, :-3:-1], axis=1).T
        right, wrong = (read + most) / 2, (read - most) / 2
        cells = sign.shape[1]
        good = framed & (right >= MIN_RIGHT_SHARE * cells) & (wrong <= wrong_share * read)
        good &= most - next_most > MIN_LEAD_SHARE * cells
        unknown = np.where(read > CLEAR_SHARE * cells, OTHER, UNREAD)
        return np.where(good, best, unknown), np.asarray(most / cells, np.float64)

    def _is_uncovered(self, quads: Quads) -> Flags:
        """Whether each place is away from corners whose sides are hidden, (N, places)."""
        corners = np.array([(0, 0), (1, 0), (1, 1), (0, 1)], np.float64)
        away = np.linalg.norm(self._places[:, None] - corners, axis=-1)
        gaps = np.where(quads.gaps > MAX_GAP_CELLS / self._count, quads.gaps, 0.0)
        return np.asarray((away > np.minimum(gaps, 0.5)[:, None]).all(axis=-1))


def _inside(places: Array, shape: tuple[int, ...]) -> Flags:
    return np.asarray(((places >= 0) & (places <= (shape[1] - 1, shape[0] - 1))).all(axis=-1))


def _median(values: Array, seen: Flags) -> Array:
    """Median of the visible values of each row; 0 where there is none."""
    ordered = np.sort(np.where(seen, values, np.inf), axis=1)
    middle = np.maximum(seen.sum(axis=1) - 1, 0) // 2
    median = np.take_along_axis(ordered, middle[:, None], axis=1)[:, 0]
    return np.asarray(np.where(seen.any(axis=1), median, 0.0))


def _share(sign: Array) -> Array:
    """Share of the read cells of each row that are positive."""
    return np.asarray((sign > 0).sum(axis=1) / np.maximum((sign != 0).sum(axis=1), 1))


def _same(one: Observation, other: Observation) -> bool:
    """Whether two quads are one marker; a false one of another size must not hide the true one."""
    apart = np.linalg.norm(one.corners - other.corners, axis=1).max()
    return one.face is other.face and bool(apart < 0.2 * min(one.size, other.size))
