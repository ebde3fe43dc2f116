"""The hand in front of the cube, as a soft mask."""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from tracking.appearance.background import Background
from tracking.appearance.colour_model import ColourModel, colour_bins
from tracking.appearance.face_check import FaceCheck
from tracking.appearance.face_pattern import FacePattern
from tracking.cube.model import CubeModel
from tracking.geometry.arrays import Array, Flags, Floats, Image
from tracking.geometry.intrinsics import Intrinsics
from tracking.geometry.projection import MIN_DEPTH, Projection
from tracking.geometry.state import CubeState

REACH_EDGES = 2.0
"""How far from the cube's bounds the hand is looked for [apparent edges of the cube]."""

WORKING_EDGE_PX, MIN_EDGE_PX, MAX_EDGE_PX = 30.0, 17.0, 48.0
"""Edge of the cube at the resolution in which the hand is looked for, and the bounds at which that
resolution changes [px]."""

EVIDENCE, NO_EVIDENCE = 4.0, -4.0
"""What a face that disagrees or agrees with its print speaks for a hand, as logarithm of odds."""

SURE_ODDS = 1.5
"""The same for a pixel whose colour is learned as that of the hand."""

MIN_TOUCH_EDGES2, MIN_AREA_EDGES2 = 0.01, 0.15
"""Least area beside the cube, and in all, of a hand that hides no face [square edges]."""

MIN_EXTENT_EDGES = 0.9
"""How far from the cube's bounds it must reach: there is an arm behind a hand."""

IMAGE_STRIPS = 9
"""Parts of the image of which one a frame is learned as background while there is no hand."""

MIN_CHANGED_SHARE = 0.6
"""Least share of such a hand that does not look like the desk."""

CLOSED_EDGES = 0.25
"""Width of gaps of the hand over the cube that are filled: about a cell of a marker [edges]."""

EDGE_LEVELS = 90.0
"""Range of the odds, whose whole range is 255, over which the cover rises from 0 to 255."""

EDGE_SHIFT = 50.0
"""Odds, as above, at which half is covered: what differs from the desk is smoothed, so it grows."""

COVER = np.clip((np.arange(256) - 128 - EDGE_SHIFT) * (255 / EDGE_LEVELS) + 128, 0, 255).astype(
    np.uint8
)
"""Cover for the odds at full resolution."""

SMALL, WIDE = np.ones((3, 3), np.uint8), np.ones((5, 5), np.uint8)
"""A pixel with its neighbours."""


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
    """Distance of the nearest surface of the cube that the hand hides, along the camera's axis [m]:
    the hand is nearer. That of the cube's centre where the hand hides no face."""


@dataclass(frozen=True)
class _Window:
    """A part of the image at working resolution."""

    left: int
    """First column [px of the window]."""

    top: int
    """First row [px of the window]."""

    width: int
    """Number of columns."""

    height: int
    """Number of rows."""

    scale: int
    """Pixels of the image per pixel of the window."""

    edge: float
    """Apparent edge of the cube [px of the window]."""

    @property
    def box(self) -> tuple[slice, slice]:
        """Rows and columns in an image of the working resolution."""
        return np.s_[self.top : self.top + self.height, self.left : self.left + self.width]

    @property
    def image_box(self) -> tuple[slice, slice]:
        """Rows and columns in the image."""
        rows, columns = self.box
        return (
            slice(rows.start * self.scale, rows.stop * self.scale),
            slice(columns.start * self.scale, columns.stop * self.scale),
        )


class HandFinder:
    """Finds the hand in front of one cube seen by one camera.

    Pixels of a face that disagree with its print are a finger. Outside the cube, the hand is what
    is connected to it, has its colours, learned over frames, and does not look like the desk.
    """

    def __init__(self, cube: CubeModel, intrinsics: Intrinsics) -> None:
        self._projection = Projection(intrinsics)
        self._pattern = FacePattern(cube, self._projection)
        self._edge = cube.edge
        signs = [(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
        self._corners = np.array(signs, np.float64) * cube.edge / 2
        self._faces = FaceCheck()
        self._background = Background()
        self._colours = ColourModel()
        self._scale = self._strip = 0

    def update(self, image: Image, state: CubeState) -> HandMask | None:
        """Find the hand in the next image, (H, W, 3) BGR, with the cube's state in it.

        Returns
        -------
        None where the cube is not seen, or no hand is in front of it.
        """
        pose = state.camera_from_cube
        window = None if pose is None or not state.visible else self._window(pose)
        if pose is None or window is None:
            return None
        part = image[window.image_box]
        small = cv2.resize(part, (window.width, window.height), interpolation=cv2.INTER_AREA)
        pixels = np.asarray(cv2.cvtColor(small, cv2.COLOR_BGR2LAB), np.uint8)
        planes = np.ascontiguousarray(pixels.transpose(2, 0, 1))
        lab = planes.astype(np.float32)
        columns, rows = (side // window.scale for side in self._projection.size)
        self._background.match_size(columns, rows)

        cube, evidence, distance = self._evidence(lab, pose, window)
        inner, outer = cv2.erode(cube, SMALL) > 0, cv2.dilate(cube, WIDE) > 0
        bins = colour_bins(list(planes))
        if np.count_nonzero(evidence) > 8:
            self._colours.learn_hand(bins, evidence)

        by_place, changed, steady = self._background.odds(lab, window.box, ~outer)
        if not steady:
            self._background.forget()
        if not self._colours.knows_behind:
            self._colours.learn_behind(bins, ~outer)  # a hand has only a small share in it
        by_colour = self._colours.odds()[bins]
        # Where the place tells, or paper and ink are near, colours tell half.
        odds = by_colour * np.where(outer | changed, np.float32(0.5), np.float32(1.0))
        odds += np.where(outer, 0, by_place)
        odds[inner] = NO_EVIDENCE
        odds[evidence] = EVIDENCE
        odds = np.asarray(cv2.GaussianBlur(odds, (5, 5), 1.0), np.float32)

        odds[inner] = np.where(_closed_over(odds, inner, window.edge), 0.5 * EVIDENCE, odds)[inner]

        hand = self._grown(_cleaned(odds > 0), evidence, changed, cube, window.edge)
        self._learn(lab, bins, window, outer, hand, changed, odds)
        if not hand.any():
            self._learn_strip(image, window)
            return None
        down, across = window.image_box
        size = (across.stop - across.start, down.stop - down.start)
        return HandMask(across.start, down.start, _soft(hand, odds, size), distance)

    def region(self, camera_from_cube: Array) -> tuple[slice, slice] | None:
        """Rows and columns of the image in which the hand is looked for at a pose of the cube."""
        window = self._window(camera_from_cube)
        return window.image_box if window else None

    def _window(self, pose: Array) -> _Window | None:
        points = self._corners @ pose[:3, :3].T + pose[:3, 3]
        if points[:, 2].min() < MIN_DEPTH:
            return None
        pixels = self._projection.project(points)
        edge = self._edge * float(self._projection.matrix[0, 0]) / float(pose[2, 3])
        if not self._scale or not MIN_EDGE_PX < edge / self._scale < MAX_EDGE_PX:
            self._scale = max(1, round(edge / WORKING_EDGE_PX))
        scale, reach = self._scale, REACH_EDGES * edge
        size = np.array(self._projection.size) // scale
        low = np.clip(np.floor((pixels.min(axis=0) - reach) / scale), 0, size).astype(int)
        high = np.clip(np.ceil((pixels.max(axis=0) + reach) / scale), 0, size).astype(int)
        if (high - low).min() < 8:
            return None
        (left, top), (width, height) = low.tolist(), (high - low).tolist()
        return _Window(left, top, width, height, scale, edge / scale)

    def _evidence(self, lab: Floats, pose: Array, window: _Window) -> tuple[Image, Flags, float]:
        """Return the cube, (h, w), what of its faces is hidden, and the distance of that [m]."""
        origin = np.array([window.left, window.top], np.float64) * window.scale
        seen = self._pattern.seen(pose, origin, window.scale, (window.width, window.height))
        cube = np.asarray(seen.face > 0, np.uint8)
        evidence = np.zeros(cube.shape, bool)
        left, top, width, height = cv2.boundingRect(cube)
        if not width:
            return cube, evidence, float(pose[2, 3])
        box = np.s_[max(top - 4, 0) : top + height + 4, max(left - 4, 0) : left + width + 4]
        part = seen.cropped(box)
        evidence[box] = self._faces.disagreement(lab[:, box[0], box[1]], part, window.edge)
        if not evidence.any():
            return cube, evidence, float(pose[2, 3])
        hidden = np.where(evidence, seen.face, np.uint8(0))
        return cube, evidence, self._pattern.distance(pose, hidden, origin, window.scale)

    def _grown(
        self, hand: Image, evidence: Flags, changed: Flags, cube: Image, edge: float
    ) -> Flags:
        """Choose the components that hold evidence, or that touch the cube and reach away."""
        count, labels, stats, _ = cv2.connectedComponentsWithStats(hand)
        area = stats[:, cv2.CC_STAT_AREA]
        beside = cv2.dilate(cube, WIDE, iterations=3) > 0
        keep = np.bincount(labels[beside], minlength=count) > MIN_TOUCH_EDGES2 * edge**2
        keep &= area > MIN_AREA_EDGES2 * edge**2
        far = int(np.ceil(MIN_EXTENT_EDGES * edge))
        left, top, width, height = cv2.boundingRect(cube)
        near = np.s_[
            max(top - far, 0) : top + height + far, max(left - far, 0) : left + width + far
        ]
        away = labels.copy()
        away[near] = 0
        keep &= np.bincount(away.ravel(), minlength=count) > 0
        keep &= np.bincount(labels[changed], minlength=count) > MIN_CHANGED_SHARE * area
        keep[labels[evidence & (hand > 0)]] = True
        keep[0] = False
        return np.asarray(keep[labels])

    def _learn(
        self,
        lab: Floats,
        bins: NDArray[np.intp],
        window: _Window,
        outer: Flags,
        hand: Flags,
        changed: Flags,
        odds: Floats,
    ) -> None:
        """Learn the colours of the hand, and what is behind it."""
        sure = hand & changed & (odds > SURE_ODDS)
        if np.count_nonzero(sure) > 8:
            self._colours.learn_hand(bins, sure)
        free = cv2.dilate(outer.astype(np.uint8), WIDE) == 0
        free &= cv2.dilate(hand.astype(np.uint8), WIDE) == 0
        self._colours.learn_behind(bins, free & ~changed)
        self._background.learn(lab, window.box, free, changed)

    def _learn_strip(self, image: Image, window: _Window) -> None:
        """Learn a strip of the whole image, without a hand: the cube may come there."""
        scale = window.scale
        columns, rows = (side // scale for side in self._projection.size)
        self._strip = (self._strip + 1) % IMAGE_STRIPS
        top, bottom = (rows * strip // IMAGE_STRIPS for strip in (self._strip, self._strip + 1))
        part = image[top * scale : bottom * scale, : columns * scale]
        small = cv2.resize(part, (columns, bottom - top), interpolation=cv2.INTER_AREA)
        lab = np.stack(cv2.split(cv2.cvtColor(small, cv2.COLOR_BGR2LAB))).astype(np.float32)
        free = np.ones((bottom - top, columns), bool)
        first, last = max(window.top - top, 0), max(window.top + window.height - top, 0)
        free[first:last, window.left : window.left + window.width] = False
        self._background.learn_first(lab, np.s_[top:bottom, :columns], free)


def _closed_over(odds: Floats, inner: Flags, edge: float) -> Flags:
    """Return what lies between parts of the hand a marker's cell apart: a dark finger on ink."""
    side = 2 * round(CLOSED_EDGES * edge / 2) + 1
    hand = (odds > 0).astype(np.uint8)
    closed = cv2.morphologyEx(hand, cv2.MORPH_CLOSE, np.ones((side, side), np.uint8))
    return (closed > 0) & inner


def _cleaned(flags: Flags) -> Image:
    """Drop specks, and fill gaps of a few pixels."""
    mask = cv2.morphologyEx(flags.astype(np.uint8), cv2.MORPH_OPEN, SMALL)
    return np.asarray(cv2.morphologyEx(mask, cv2.MORPH_CLOSE, WIDE), np.uint8)


def _soft(hand: Flags, odds: Floats, size: tuple[int, int]) -> Image:
    """Return the cover of each pixel of the image, 0…255: soft at the edge, by the odds there."""
    mask = hand.astype(np.uint8)
    core, rim = cv2.erode(mask, SMALL), cv2.dilate(mask, SMALL)
    level = np.clip(odds * (127 / -NO_EVIDENCE) + 128, 0, 255).astype(np.uint8)
    level[core > 0] = 255
    level[rim == 0] = 0
    large = cv2.resize(level, size, interpolation=cv2.INTER_LINEAR)
    return np.asarray(cv2.LUT(large, COVER), np.uint8)
