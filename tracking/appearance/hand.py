"""The hand in front of the cube, as a soft mask."""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from tracking.appearance.background import Background
from tracking.appearance.face_pattern import FacePattern, SeenPattern
from tracking.appearance.skin_model import FLOOR, ColourHistogram, colour_bins
from tracking.cube.model import CubeModel
from tracking.geometry.arrays import Array, Flags, Floats, Image
from tracking.geometry.intrinsics import Intrinsics
from tracking.geometry.projection import MIN_DEPTH, Projection
from tracking.geometry.state import CubeState

REACH_EDGES = 2.0
"""How far from the cube's outline the hand is looked for [apparent edges of the cube]."""

WORKING_EDGE_PX = 36.0
"""Length of the cube's edge at the resolution in which the hand is looked for, or less [px]."""

MIN_SHADE, MAX_SHADE = 0.35, 1.25
"""Light on a part of a face relative to the face's typical light: less is no shadow."""

CHROMA_TOLERANCE = 7.0
"""How far the chroma of paper and ink may be off that of the paper [CIELab]."""

LIGHTNESS_TOLERANCE = 22.0
"""How far grey may be off what the print allows [CIELab bytes, 0…255]."""

MIN_EVIDENCE_EDGES2 = 0.004
"""Least area of a face that must disagree with its print [square edges]."""

TINT_STEP = 0.1
"""Share of a frame in the learned tint of paper."""


MIN_LEARNED = 60
"""Pixels of a hand from which on its colours are known."""

MIN_TOUCH_EDGES2, MIN_AREA_EDGES2 = 0.01, 0.15
"""Least area beside the cube, and in all, of a hand that hides no face [square edges]."""

SMALL = np.ones((3, 3), np.uint8)
"""The neighbours of a pixel."""


@dataclass(frozen=True)
class HandMask:
    """What the hand covers of the image near the cube."""

    x: int
    """First column of the cover in the camera's frame [px]."""

    y: int
    """First row of the cover in the camera's frame [px]."""

    cover: NDArray[np.uint8]
    """Share of each pixel that the hand covers, 0…255, (height, width)."""

    distance: float
    """Distance of the nearest surface that the hand hides, along the camera's axis [m]."""


@dataclass(frozen=True)
class _Window:
    """A part of the image at working resolution."""

    left: int
    top: int
    scale: int
    lab: Image
    edge: float
    """Apparent edge of the cube [px of the window]."""


class HandFinder:
    """Finds the hand in front of one cube seen by one camera.

    Pixels of a face that disagree with its print are the hand. Their colours, learned over
    frames, tell the hand outside the cube, as far as it is connected.
    """

    def __init__(self, cube: CubeModel, intrinsics: Intrinsics) -> None:
        self._projection = Projection(intrinsics)
        self._pattern = FacePattern(cube, self._projection)
        self._edge = cube.edge
        signs = [(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
        self._corners = np.array(signs, np.float64) * cube.edge / 2
        self._faces = FaceCheck()
        self._background = Background()
        self._hand, self._behind = ColourHistogram(), ColourHistogram()

    def update(self, image: Image, state: CubeState) -> HandMask | None:
        """Find the hand in the next image, (H, W, 3) BGR, with the cube's state in it.

        Returns
        -------
        None where the cube is not seen, or no hand is in front of it.
        """
        pose = state.camera_from_cube
        if pose is None or not state.visible:
            return None
        window = self._window(image, pose)
        if window is None:
            return None
        lab, edge = window.lab, window.edge
        height, width = lab.shape[:2]
        origin = np.array([window.left, window.top], np.float64)
        seen = self._pattern.seen(pose, origin, window.scale, (width, height))
        evidence = self._faces.disagreement(lab, seen, edge)
        cube = (seen.face > 0).astype(np.uint8)
        inner, outer = cv2.erode(cube, SMALL) > 0, cv2.dilate(cube, SMALL, iterations=2) > 0
        column, row = window.left // window.scale, window.top // window.scale
        box = np.s_[row : row + height, column : column + width]
        columns, rows = (side // window.scale for side in self._projection.size)
        self._background.match_size(columns, rows)
        by_place, trust = self._background.odds(lab, box, ~outer)
        if trust == 0:
            self._background.forget()
        bins = colour_bins(lab)
        by_colour = self._colour_odds()[bins]
        odds = by_colour + by_place
        odds[outer] = by_colour[outer] * 0.5
        odds[inner] = -4.0
        odds[evidence] = 4.0
        odds = cv2.GaussianBlur(odds, (5, 5), 1.0)
        grown = self._grown(closed(odds > 0), evidence, cube > 0, edge)
        wide = cv2.dilate(grown.astype(np.uint8), SMALL, iterations=2) > 0
        sure = grown & (odds > 1.5) & ~outer & (by_place > 0) | evidence
        if np.count_nonzero(sure) > 8:
            self._hand.learn(bins, sure)
        free = ~outer & ~wide
        self._behind.learn(bins, free & (by_place <= 0))
        self._background.learn(lab, box, free, by_place)
        if not grown.any():
            return None
        core = cv2.erode(grown.astype(np.uint8), SMALL) > 0
        soft = np.clip(odds * 0.4 + 0.5, 0, 1) * (cv2.dilate(grown.astype(np.uint8), SMALL) > 0)
        soft[core] = 1.0
        size = (width * window.scale, height * window.scale)
        cover = cv2.resize(np.rint(255 * soft).astype(np.uint8), size)
        hidden = seen.depth[evidence]
        distance = float(hidden.min()) if len(hidden) else float(pose[2, 3])
        return HandMask(window.left, window.top, np.asarray(cover, np.uint8), distance)

    def _colour_odds(self) -> Floats:
        """What each colour speaks for a hand, as the logarithm of odds."""
        if self._hand.weight < MIN_LEARNED:
            return np.zeros(len(self._hand.density()), np.float32)
        ratio = np.log((self._hand.density() + FLOOR) / (self._behind.density() + FLOOR))
        return np.asarray(np.clip(ratio, -2.0, 2.0), np.float32)

    def _grown(self, hand: Flags, evidence: Flags, cube: Flags, edge: float) -> Flags:
        """Choose the components that hold evidence, or that touch the cube on a long line."""
        count, labels, stats, _ = cv2.connectedComponentsWithStats(hand.astype(np.uint8))
        area = stats[:, cv2.CC_STAT_AREA]
        beside = cv2.dilate(cube.astype(np.uint8), SMALL, iterations=4) > 0
        touching = np.bincount(labels[beside], minlength=count)
        keep = (touching > MIN_TOUCH_EDGES2 * edge**2) & (area > MIN_AREA_EDGES2 * edge**2)
        keep[labels[evidence & hand]] = True
        keep[0] = False
        return np.asarray(keep[labels])

    def region(self, camera_from_cube: Array | None) -> tuple[slice, slice] | None:
        """Rows and columns of the image in which the hand is looked for at a pose of the cube."""
        bounds = None if camera_from_cube is None else self._bounds(camera_from_cube)
        if bounds is None:
            return None
        left, top, width, height, scale, _ = bounds
        return slice(top, top + height * scale), slice(left, left + width * scale)

    def _bounds(self, pose: Array) -> tuple[int, int, int, int, int, float] | None:
        points = self._corners @ pose[:3, :3].T + pose[:3, 3]
        if points[:, 2].min() < MIN_DEPTH:
            return None
        pixels = self._projection.project(points)
        edge = self._edge * float(self._projection.matrix[0, 0]) / float(pose[2, 3])
        scale = 1 if edge < 40 else 2 if edge < 100 else 4
        size = np.array(self._projection.size)
        reach = REACH_EDGES * edge
        low = np.clip(np.floor((pixels.min(axis=0) - reach) / scale) * scale, 0, size)
        high = np.clip(pixels.max(axis=0) + reach, 0, size)
        width, height = ((high - low).astype(int) // scale).tolist()
        if min(width, height) < 8:
            return None
        return int(low[0]), int(low[1]), width, height, scale, edge / scale

    def _window(self, image: Image, pose: Array) -> _Window | None:
        bounds = self._bounds(pose)
        if bounds is None:
            return None
        left, top, width, height, scale, edge = bounds
        part = image[top : top + height * scale, left : left + width * scale]
        small = cv2.resize(part, (width, height), interpolation=cv2.INTER_AREA)
        lab = np.asarray(cv2.cvtColor(small, cv2.COLOR_BGR2LAB), np.uint8)
        return _Window(left, top, scale, lab, edge)


class FaceCheck:
    """Finds pixels of faces that do not look like their print."""

    def __init__(self) -> None:
        self._tint: Floats | None = None

    def disagreement(self, lab: Image, seen: SeenPattern, edge: float) -> Flags:
        """Return which pixels of the faces do not look like their print, (h, w).

        Parameters
        ----------
        lab
            CIELab of the window, bytes, (h, w, 3).
        seen
            The print there.
        edge
            Apparent edge of the cube [px].
        """
        most, least = cv2.dilate(seen.ink, SMALL), cv2.erode(seen.ink, SMALL)
        found = np.zeros(seen.face.shape, bool)
        inner = cv2.erode((seen.face > 0).astype(np.uint8), SMALL) > 0
        lightness = lab[..., 0].astype(np.float32)
        chroma = lab[..., 1:].astype(np.float32) - 128.0
        all_paper = inner & (most < 0.1) & ~seen.icon
        tint = self._paper_tint(lightness, chroma, all_paper)
        if tint is None:
            return found
        # Light scales L + 16 and the chroma by the same factor.
        off_tint = chroma - (lightness[..., None] + 41.0) * tint
        coloured = (off_tint**2).sum(axis=-1) > CHROMA_TOLERANCE**2
        for number in np.unique(seen.face[inner]).tolist():
            face = (seen.face == number) & inner
            paper, ink = face & all_paper, face & (least > 0.9)
            plain, dark = paper & ~coloured, ink & ~coloured
            if np.count_nonzero(plain) < 8:
                found |= face & coloured & ~seen.icon
                continue
            white = float(np.quantile(lightness[plain], 0.7))
            black = 0.25 * white
            if np.count_nonzero(dark) > 8:
                black = min(float(np.quantile(lightness[dark], 0.3)), 0.6 * white)
            top = MAX_SHADE * (white - least * (white - black)) + LIGHTNESS_TOLERANCE
            bottom = MIN_SHADE * (white - most * (white - black)) - LIGHTNESS_TOLERANCE
            off = (lightness > top) | (lightness < bottom) | coloured & ~seen.icon
            found |= off & face
        opened = cv2.morphologyEx(found.astype(np.uint8), cv2.MORPH_OPEN, np.ones((2, 2), np.uint8))
        found = connected_from_outside(opened > 0, seen.face > 0, MIN_EVIDENCE_EDGES2 * edge * edge)
        self._learn_tint(lightness, chroma, all_paper & ~coloured & ~found)
        return found

    def _paper_tint(self, lightness: Floats, chroma: Floats, paper: Flags) -> Floats | None:
        """Chroma of paper per L + 16, as learned, or from the brighter half of what is paper."""
        if self._tint is None:
            if np.count_nonzero(paper) < 12:
                return None
            bright = paper & (lightness >= np.quantile(lightness[paper], 0.5))
            self._tint = np.median(chroma[bright] / (lightness[bright][:, None] + 41.0), axis=0)
        return self._tint

    def _learn_tint(self, lightness: Floats, chroma: Floats, paper: Flags) -> None:
        if np.count_nonzero(paper) > 30 and self._tint is not None:
            now = np.median(chroma[paper] / (lightness[paper][:, None] + 41.0), axis=0)
            self._tint = np.asarray(self._tint + TINT_STEP * (now - self._tint), np.float32)


def closed(flags: Flags) -> Flags:
    """Fill gaps of a few pixels, and drop specks."""
    mask = cv2.morphologyEx(flags.astype(np.uint8), cv2.MORPH_OPEN, SMALL)
    return cv2.morphologyEx(mask, cv2.MORPH_CLOSE, np.ones((5, 5), np.uint8)) > 0


def connected(flags: Flags, seeds: Flags) -> Flags:
    """Return the components of some pixels that hold a seed, (h, w)."""
    _, labels = cv2.connectedComponents(flags.astype(np.uint8), connectivity=4)
    hit = np.zeros(int(labels.max()) + 1, bool)
    hit[labels[seeds & flags]] = True
    hit[0] = False
    return np.asarray(hit[labels])


def connected_from_outside(flags: Flags, inside: Flags, min_area: float) -> Flags:
    """Return the components large enough that reach the edge of a shape: a hand comes from there."""
    count, labels, stats, _ = cv2.connectedComponentsWithStats(flags.astype(np.uint8))
    core = cv2.erode(inside.astype(np.uint8), np.ones((7, 7), np.uint8)) > 0
    keep = np.zeros(count, bool)
    keep[labels[flags & ~core]] = True
    keep &= stats[:, cv2.CC_STAT_AREA] >= min_area
    keep[0] = False
    return np.asarray(keep[labels])
