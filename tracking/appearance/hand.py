"""The hand in front of the cube, as a soft mask."""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from tracking.appearance.background import Background, Box
from tracking.appearance.colour_model import (
    LIGHTNESS_OFFSET,
    ColourModel,
    Colours,
    colours,
)
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

SLANTED_EVIDENCE = -1.0
"""The same for a face that the camera sees at so small an angle that its print tells nothing."""

SURE_ODDS = 1.5
"""The same for a pixel whose colour is learned as that of the hand."""

MIN_TOUCH_EDGES2, MIN_AREA_EDGES2 = 0.01, 0.15
"""Least area beside the cube, and in all, of a hand that hides no face [square edges]."""

MIN_EXTENT_EDGES = 0.9
"""How far from the cube's bounds it must reach: there is an arm behind a hand."""

HELD_S = 0.15
"""Time for which the hand stays where it was after the cube is lost: the hand may hide it [s]."""

MANY_FRAMES = 20
"""Frames after which the desk is learned in every second one, and its colours in the others."""

IMAGE_STRIPS = 9
"""Parts of the image of which one a frame is learned as background while there is no hand."""

MIN_CHANGED_SHARE = 0.6
"""Least share of such a hand that does not look like the desk."""

CLOSED_EDGES = 0.25
"""Width of gaps of the hand over the cube that are filled: about a cell of a marker [edges]."""

MARGIN_PX = 7
"""Pixels of the window around the cube that take part in filters over it."""

DOUBTFUL_ODDS = 1.6
"""What the colour of print must speak for a hand, so that it may be one: a dark finger on ink."""

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

    quads: Array
    """Where the faces' prints are, seen or not, (faces, 4, 2) [px of the window]."""

    @property
    def cube_box(self) -> Box:
        """Rows and columns of the window with the cube, at least one."""
        size = np.array([self.width, self.height])
        low = np.clip(self.quads.min(axis=(0, 1)).astype(int) - MARGIN_PX, 0, size - 1).tolist()
        high = np.ceil(self.quads.max(axis=(0, 1))).astype(int) + MARGIN_PX
        high = np.clip(high, np.add(low, 1), size).tolist()
        return np.s_[low[1] : high[1], low[0] : high[0]]

    @property
    def box(self) -> Box:
        """Rows and columns in an image of the working resolution."""
        return np.s_[self.top : self.top + self.height, self.left : self.left + self.width]

    @property
    def image_box(self) -> Box:
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
        corners = np.array(signs, np.float64) * cube.edge / 2
        self._points = np.concatenate([corners, self._pattern.corners.reshape(-1, 3)])
        self._faces = FaceCheck()
        self._background = Background()
        self._colours = ColourModel()
        self._scale = self._strip = self._frames = 0
        self._last: HandMask | None = None
        self._seen = -np.inf

    def update(self, image: Image, state: CubeState) -> HandMask | None:
        """Find the hand in the next image, (H, W, 3) BGR, with the cube's state in it.

        Returns
        -------
        None where no hand is in front of the cube. A cube that is not seen has the hand before, for
        `HELD_S`.
        """
        pose = state.camera_from_cube
        if pose is None or not state.visible:
            return self._last if state.timestamp - self._seen < HELD_S else None
        self._last, self._seen = self._found(image, pose), state.timestamp
        return self._last

    def _found(self, image: Image, pose: Array) -> HandMask | None:
        window = self._window(pose)
        if window is None:
            return None
        planes = _planes(image[window.image_box], window.scale)
        lab, seen = _float_planes(planes), colours(planes)
        columns, rows = (side // window.scale for side in self._projection.size)
        self._background.match_size(columns, rows)

        box = window.cube_box
        by_colour, hand_was_known = self._colours.odds(seen), self._colours.knows_hand
        like_hand = by_colour[box] > DOUBTFUL_ODDS
        face, evidence, distance = self._evidence(lab, pose, window, like_hand)
        inner = cv2.erode(face, SMALL) > 0
        cube = _outline(window)
        outer = np.asarray(cv2.dilate(cube, SMALL), np.uint8)
        outside = outer == 0
        if np.count_nonzero(evidence) > 8:
            finger = np.zeros(cube.shape, np.uint8)
            finger[box] = evidence
            self._colours.learn_hand(seen, finger)

        by_place, changed, steady = self._background.odds(lab, window.box, outside)
        if not steady:
            self._background.forget()
        if not self._colours.knows_behind:
            self._colours.learn_behind(seen, outside.view(np.uint8))  # a hand is only little of it
        if not hand_was_known:
            by_colour = self._colours.odds(seen)
        # Where the place tells, or paper and ink are near, colours tell half.
        full = np.float32(1) - np.float32(0.5) * (outer | changed)
        odds = by_colour * full + by_place
        on_cube = odds[box]
        on_cube[(face == 0) & (cube[box] > 0)] += SLANTED_EVIDENCE
        on_cube[inner] = NO_EVIDENCE
        on_cube[evidence] = EVIDENCE
        odds = np.asarray(cv2.GaussianBlur(odds, (5, 5), 1.0), np.float32)
        on_cube = odds[box]
        doubtful = inner & ~evidence & like_hand
        on_cube[_filled(on_cube, inner, doubtful, window.edge)] = 0.5 * EVIDENCE

        hand = self._grown(_cleaned(odds > 0), box, evidence, by_place > 0, cube, window.edge)
        self._learn(lab, seen, window, outer, hand, changed, odds)
        if hand is None:
            self._learn_strip(image, window)
            return None
        return _soft(hand, odds, window, distance)

    def region(self, camera_from_cube: Array) -> Box | None:
        """Rows and columns of the image in which the hand is looked for at a pose of the cube."""
        window = self._window(camera_from_cube)
        return window.image_box if window else None

    def _window(self, pose: Array) -> _Window | None:
        points = self._points @ pose[:3, :3].T + pose[:3, 3]
        if points[:, 2].min() < MIN_DEPTH:
            return None
        pixels = self._projection.project(points)
        edge = self._edge * float(self._projection.matrix[0, 0]) / float(pose[2, 3])
        if not self._scale or not MIN_EDGE_PX < edge / self._scale < MAX_EDGE_PX:
            self._scale = max(1, round(edge / WORKING_EDGE_PX))
        scale = self._scale
        size = np.array(self._projection.size) // scale
        corners, reach = pixels[:8], REACH_EDGES * edge
        low = np.clip(np.floor((corners.min(axis=0) - reach) / scale), 0, size).astype(int)
        high = np.clip(np.ceil((corners.max(axis=0) + reach) / scale), 0, size).astype(int)
        if (high - low).min() < 8:
            return None
        (left, top), (width, height) = low.tolist(), (high - low).tolist()
        quads = (pixels[8:].reshape(-1, 4, 2) + 0.5) / scale - 0.5 - low
        return _Window(left, top, width, height, scale, edge / scale, quads)

    def _evidence(
        self, lab: Floats, pose: Array, window: _Window, like_hand: Flags
    ) -> tuple[Image, Flags, float]:
        """Return the faces in the cube's box, what of them is hidden, and the distance [m]."""
        box = window.cube_box
        corner = np.array([box[1].start, box[0].start], np.float64)
        size = (box[1].stop - box[1].start, box[0].stop - box[0].start)
        seen = self._pattern.seen(pose, window.quads - corner, size)
        evidence = self._faces.disagreement(lab[:, box[0], box[1]], seen, like_hand, window.edge)
        if not evidence.any():
            return seen.face, evidence, float(pose[2, 3])
        origin = (corner + (window.left, window.top)) * window.scale
        distance = self._pattern.distance(pose, seen.face * evidence, origin, window.scale)
        return seen.face, evidence, distance

    def _grown(
        self, hand: Image, box: Box, evidence: Flags, changed: Flags, cube: Image, edge: float
    ) -> Image | None:
        """Choose the components that hold evidence, or that touch the cube and reach away."""
        count, labels32 = cv2.connectedComponents(hand)
        if count == 1:
            return None
        labels = np.asarray(cv2.convertScaleAbs(labels32), np.uint8)
        area = _counts(labels)
        beside = np.asarray(cv2.dilate(cube, WIDE, iterations=3), np.uint8)
        keep = _counts(labels, beside) > MIN_TOUCH_EDGES2 * edge**2
        keep &= area > MIN_AREA_EDGES2 * edge**2
        left, top, width, height = cv2.boundingRect(cube)
        far = int(np.ceil(MIN_EXTENT_EDGES * edge))
        keep &= area > _counts(
            labels[max(top - far, 0) : top + height + far, max(left - far, 0) : left + width + far]
        )
        keep &= _counts(labels, changed.view(np.uint8)) > MIN_CHANGED_SHARE * area
        keep[labels[box][evidence]] = True
        keep[[0, 255]] = False
        return np.asarray(cv2.LUT(labels, keep.view(np.uint8)), np.uint8) if keep.any() else None

    def _learn(
        self,
        lab: Floats,
        seen: Colours,
        window: _Window,
        outer: Image,
        hand: Image | None,
        changed: Flags,
        odds: Floats,
    ) -> None:
        """Learn the colours of the hand, and what is behind it."""
        hidden = outer
        if hand is not None:
            hidden = outer | hand
            sure = hand * (changed & (odds > SURE_ODDS))
            if np.count_nonzero(sure) > 8:
                self._colours.learn_hand(seen, sure)
        free = cv2.dilate(hidden, WIDE) == 0
        self._frames += 1
        if self._frames % 2 == 0:
            self._colours.learn_behind(seen, (free & ~changed).view(np.uint8))
        if self._frames % 2 or self._frames < MANY_FRAMES:
            self._background.learn(lab, window.box, free, changed)

    def _learn_strip(self, image: Image, window: _Window) -> None:
        """Learn a strip of the whole image, without a hand: the cube may come there."""
        scale = window.scale
        columns, rows = (side // scale for side in self._projection.size)
        self._strip = (self._strip + 1) % IMAGE_STRIPS
        top, bottom = (rows * strip // IMAGE_STRIPS for strip in (self._strip, self._strip + 1))
        part = image[top * scale : bottom * scale, : columns * scale]
        free = np.ones((bottom - top, columns), bool)
        first, last = max(window.top - top, 0), max(window.top + window.height - top, 0)
        free[first:last, window.left : window.left + window.width] = False
        lab = _float_planes(_planes(part, scale))
        self._background.learn_first(lab, np.s_[top:bottom, :columns], free)


def _outline(window: _Window) -> Image:
    """Return the whole cube in the window, (h, w)."""
    cube = np.zeros((window.height, window.width), np.uint8)
    hull = cv2.convexHull(np.rint(window.quads.reshape(-1, 2) * 16).astype(np.int32))
    return np.asarray(cv2.fillConvexPoly(cube, hull, 1, shift=4), np.uint8)


def _planes(image: Image, scale: int) -> list[Image]:
    """Return CIELab of a part of the image at working resolution, in bytes, (h, w) each."""
    # The mean of a square, in half the time that INTER_AREA takes.
    side = (scale - 1) | 1
    size = (image.shape[1] // scale, image.shape[0] // scale)
    soft = cv2.blur(image, (side, side)) if side > 1 else image
    small = cv2.resize(soft, size, interpolation=cv2.INTER_LINEAR)
    return [np.asarray(plane) for plane in cv2.split(cv2.cvtColor(small, cv2.COLOR_BGR2LAB))]


def _float_planes(planes: list[Image]) -> Floats:
    """Return L + 16, a and b in single precision, (3, h, w)."""
    lab = np.empty((3, *planes[0].shape), np.float32)
    for plane, offset, of in zip(planes, (LIGHTNESS_OFFSET, -128.0, -128.0), lab, strict=True):
        np.add(plane, np.float32(offset), out=of)
    return lab


def _counts(labels: Image, where: Image | None = None) -> Floats:
    """Return how many pixels each of 256 labels has."""
    return np.asarray(cv2.calcHist([labels], [0], where, [256], (0, 256)), np.float32).ravel()


def _filled(odds: Floats, inner: Flags, doubtful: Flags, edge: float) -> Flags:
    """Return where the hand covers what looks like its print: as most of what is told around it."""
    side = 2 * round(CLOSED_EDGES * edge / 2) + 1
    hand = (odds > 0).view(np.uint8)
    closed = cv2.morphologyEx(hand, cv2.MORPH_CLOSE, np.ones((side, side), np.uint8)) > 0
    votes = cv2.blur((2.0 * hand - 1).astype(np.float32) * ~doubtful, (side, side))
    return np.asarray(inner & (closed | (doubtful & (votes > 0))))


def _cleaned(flags: Flags) -> Image:
    """Drop specks, and fill gaps of a few pixels."""
    mask = cv2.morphologyEx(flags.view(np.uint8), cv2.MORPH_OPEN, SMALL)
    return np.asarray(cv2.morphologyEx(mask, cv2.MORPH_CLOSE, WIDE), np.uint8)


def _soft(hand: Image, odds: Floats, window: _Window, distance: float) -> HandMask:
    """Return the cover of each pixel of the image: soft at the edge, by the odds there."""
    left, top, width, height = cv2.boundingRect(hand)
    left, right = max(left - 2, 0), min(left + width + 2, window.width)
    top, bottom = max(top - 2, 0), min(top + height + 2, window.height)
    part = np.s_[top:bottom, left:right]
    mask = hand[part]
    level = np.clip(odds[part] * (127 / -NO_EVIDENCE) + 128, 0, 255).astype(np.uint8)
    level[cv2.erode(mask, SMALL) > 0] = 255
    level[cv2.dilate(mask, SMALL) == 0] = 0
    size = ((right - left) * window.scale, (bottom - top) * window.scale)
    large = cv2.resize(level, size, interpolation=cv2.INTER_LINEAR)
    cover = np.asarray(cv2.LUT(large, COVER), np.uint8)
    x, y = (window.left + left) * window.scale, (window.top + top) * window.scale
    return HandMask(x, y, cover, distance)
