"""The hand in front of the cube, as a soft mask."""

from dataclasses import dataclass

import cv2
import numpy as np

from cubeling.tracking.appearance.colour_space import LAB_FROM_ROOTS, lab
from cubeling.tracking.appearance.hand.arm import arm_samples, with_arm
from cubeling.tracking.appearance.hand.background import Background, Box, WindowChange
from cubeling.tracking.appearance.hand.colour_model import (
    MAX_ODDS,
    MIN_DIFFERENCE,
    MIN_SHOWN_PX,
    ColourModel,
    Colours,
    colours,
)
from cubeling.tracking.appearance.hand.edge import soft_cover
from cubeling.tracking.appearance.hand.last_hand import LastHand
from cubeling.tracking.appearance.hand.mask import EDGE_SLOPE, HandMask
from cubeling.tracking.appearance.hand.odds import hand_odds
from cubeling.tracking.appearance.hand.on_cube.cube_part import CubeCheck, CubePart
from cubeling.tracking.appearance.hand.on_cube.face_pattern import FacePattern
from cubeling.tracking.appearance.hand.shape import choose_components
from cubeling.tracking.appearance.hand.structuring_elements import SQUARE_3, SQUARE_5
from cubeling.tracking.appearance.hand.window import (
    HandWindow,
    Stillness,
    WindowFinder,
    sample,
    shrink,
)
from cubeling.tracking.cube.model import CubeModel
from cubeling.tracking.geometry.arrays import Array, Flags, Floats, Image
from cubeling.tracking.geometry.intrinsics import Intrinsics
from cubeling.tracking.geometry.projection import Projection
from cubeling.tracking.geometry.state import CubeState

SURE_ODDS = 1.2
"""What all speaks for a hand where its colours are learned, as logarithm of odds."""

HELD_S = 0.15
"""Time for which the hand before is kept after the cube is lost: the hand may hide it [s]."""

MAX_HAND_AGE = 15
"""Frames after which what a pixel shows is the desk, and no hand that was there from the beginning:
what changes it is the first hand."""

MAX_RESTING_AGE = 40
"""The same where it has the colours of the hand, and is connected to it."""

STILL_ODDS, MIN_DISTINCTNESS = 1.0, 0.5
"""What speaks for a hand there, as logarithm of odds; and how well its colours must tell it from
the desk, where nothing else does."""

MAX_STILL_SHARE = 0.5
"""Most of such a part, as a share of the hand that was found, or an edge of the cube squared."""

MANY_FRAMES = 20
"""Frames at a session's beginning, and after the camera was moved, in which all is looked at and
learned each time."""

WHOLE_FRAMES, LEARNING_FRAMES = 8, 4
"""Later, one of so many frames looks at the whole window and at what changes slowly: noise, the
colours behind the hand, what it has uncovered; the others look where something differs, and one of
so many of them learns the hand there, and another the desk."""

IMAGE_STRIPS = 9
"""Parts of the image of which one a frame is learned as background, at first, and while there is no
hand."""


@dataclass(frozen=True)
class _View:
    """What a window of the image shows."""

    window: HandWindow
    """Part of the picture that it is cut from."""

    lab: Floats
    """L + 16, a and b of CIELab, in bytes, (3, h, w)."""

    colours: Colours
    """The same as the bins of a histogram, (h, w)."""

    whole: bool
    """Whether it is all of the window around the cube, so that what changes slowly is measured."""


class HandFinder:
    """Finds the hand in front of one cube seen by one camera.

    Pixels of a face that disagree with its print are a finger. Outside the cube, the hand is what
    is connected to it, has its colours, learned over frames, and does not look like the desk.
    """

    def __init__(self, cube: CubeModel, intrinsics: Intrinsics) -> None:
        self._projection = Projection(intrinsics)
        self._pattern = FacePattern(cube, self._projection)
        self._windows = WindowFinder(cube, self._projection, self._pattern.corners)
        self._cube = CubeCheck(cube, self._pattern)
        self._background = Background()
        self._colours = ColourModel()
        self._stillness = Stillness()
        self._from_roots = LAB_FROM_ROOTS
        self._strip = self._frames = self._since_whole = 0
        self._scale = 0  # of the last window
        self._last = LastHand(cube, self._projection)
        self._seen = -np.inf

    def update(self, image: Image, state: CubeState) -> HandMask | None:
        """Find the hand in the next image, (H, W, 3) BGR, with the cube's state in it.

        Returns
        -------
        None where no hand is in front of the cube. A cube that is not seen has the hand before, for
        `HELD_S`, which moves as the cube is expected to.
        """
        pose = state.camera_from_cube
        if pose is None or not state.visible:
            is_held = 0.0 <= state.timestamp - self._seen < HELD_S
            return self._last.predict(pose) if is_held else None
        self._seen = time = state.timestamp
        if not self._is_early and self._last.carry(pose, time):
            return self._last.mask
        window = self._windows.window(pose, self._scale)
        if window is None:
            self._stillness = Stillness()
            self._last.update(None, pose, time)
            return None
        self._scale = window.scale
        self._since_whole += 1
        samples = sample(image, window.scale, window.samples)
        if self._is_early or not self._stillness.is_still(window, samples):
            columns, rows = (side // window.scale for side in self._projection.size)
            self._background.match_size(columns, rows)
            view = self._view(image, window, samples)
            hand = self._find(view, pose)
            if self._is_early or hand is None:
                self._learn_strip(image, view.window)
            found = None if hand is None else self._with_arm(image, window, hand)
            self._last.update(found, pose, time)
        return self._last.mask

    def region(self, camera_from_cube: Array) -> Box | None:
        """Rows and columns of the image in which the hand is looked for at a pose of the cube."""
        window = self._windows.window(camera_from_cube, self._scale)
        return window.image_box if window else None

    @property
    def _is_early(self) -> bool:
        """Whether so few frames were seen from the camera's place that all is looked at."""
        return self._frames < MANY_FRAMES

    def _with_arm(self, image: Image, window: HandWindow, hand: HandMask) -> HandMask:
        """Return a hand that was found in a window together with its arm beyond that."""
        samples = arm_samples(window, self._projection.size)
        planes = self._lab(sample(image, window.scale, samples))
        changed = self._background.changed_samples(planes, samples)
        if self._since_whole == 0:
            changed &= ~self._forget_uncovered(planes, samples, changed)
        return with_arm(hand, changed, samples, window)

    def _forget_uncovered(self, planes: Floats, samples: Box, changed: Flags) -> Flags:
        """Return the samples that show the desk since an arm that was there first has gone."""
        uncovered = changed & (self._background.sampled_age(samples) < MAX_RESTING_AGE)
        before = colours(self._background.sampled_lab(samples, uncovered))
        uncovered[uncovered] = self._colours.uncovered_pixels(colours(planes[:, uncovered]), before)
        self._background.forget_samples(samples, uncovered)
        return uncovered

    def _lab(self, image: Image) -> Floats:
        """Return the planes of `lab` as the camera showed them at first."""
        return lab(image, self._from_roots)

    def _view(self, image: Image, window: HandWindow, samples: Image) -> _View:
        """Look at the window, or at the part of it where something differs, as `samples` tell."""
        whole = self._is_early or self._since_whole >= WHOLE_FRAMES
        if whole:
            self._since_whole = 0
        else:
            planes, cube = self._lab(samples), window.cube_box
            window = window.part(self._background.difference_box(planes, window.samples, cube))
        small = shrink(image[window.image_box], window.scale)
        planes = self._lab(small)
        change = self._background.camera_change(planes, window.box) if whole else None
        if change is not None:
            self._from_roots = change @ self._from_roots
            planes = self._lab(small)
        return _View(window, planes, colours(planes), whole)

    def _find(self, view: _View, pose: Array) -> HandMask | None:
        """Find the hand in what is looked at, and learn from it."""
        window, by_colour = view.window, self._colours.odds(view.colours)
        nearest_is_due = self._frames % LEARNING_FRAMES == 0
        cube = self._cube.part(window, pose, view.lab, by_colour, nearest_is_due)
        if cube.shows_hand:
            self._colours.see_hand(view.colours[window.cube_box][cube.evidence])
        place = self._background.compare(view.lab, window.box, cube.outside, view.whole)
        if not self._background.steady:
            self._background.forget()
            self._frames = 0
        if not (self._colours.knows_hand and self._colours.knows_behind):
            self._learn_first(view, cube)
            by_colour = self._colours.odds(view.colours)
        if view.whole:
            place = self._without(self._uncovered_pixels(place, view, by_colour), place, window)
        if cube.shows_hand and self._colours.hand_is_new:
            seeds = np.zeros(by_colour.shape, np.uint8)
            seeds[window.cube_box] = cube.evidence
            still = self._still_parts(seeds, place, view, by_colour, cube, np.inf)
            place = self._without(still, place, window)
        distinctness = self._colours.distinctness
        odds = hand_odds(window, cube, place, by_colour, distinctness)
        hand = choose_components(odds > 0, window, cube, place, by_colour, distinctness)
        if hand is not None and distinctness > MIN_DISTINCTNESS:
            most = max(MAX_STILL_SHARE * np.count_nonzero(hand), window.edge**2)
            # Not forgotten as desk: what is in its colours would stay the hand when that has gone.
            still = self._still_parts(hand, place, view, by_colour, cube, most)
            odds[still] = np.maximum(odds[still], np.float32(STILL_ODDS))
            hand = np.asarray(cv2.max(hand, still.view(np.uint8)), np.uint8)
        self._learn(view, cube, place, odds, hand)
        if hand is None:
            return None
        left, top, share = soft_cover(hand, odds, place.difference, window)
        x, y = (window.left + left) * window.scale, (window.top + top) * window.scale
        return HandMask(x, y, share, cube.behind, window.scale, EDGE_SLOPE)

    def _without(self, mistaken: Flags, place: WindowChange, window: HandWindow) -> WindowChange:
        """Forget the background where it was `mistaken`, (h, w), for the desk."""
        if not mistaken.any():
            return place
        self._background.forget_some(window.box, mistaken)
        return place.without(mistaken)

    def _uncovered_pixels(self, place: WindowChange, view: _View, by_colour: Floats) -> Flags:
        """Return where the background was a hand, there from the beginning, which has gone."""
        box = view.window.box
        doubtful = place.changed & (by_colour < MAX_ODDS - MIN_DIFFERENCE)
        if not self._colours.knows_hand:
            doubtful &= self._background.age(box) < MAX_HAND_AGE
        before = colours(self._background.lab(box, doubtful))
        doubtful[doubtful] = self._colours.uncovered_pixels(view.colours[doubtful], before)
        return doubtful

    def _still_parts(
        self,
        hand: Image,
        place: WindowChange,
        view: _View,
        by_colour: Floats,
        cube: CubePart,
        most: float,
    ) -> Flags:
        """Return where the background is a part of a hand that has not moved since the beginning.

        It has the colours of the hand, touches what is known of that, (h, w), and is no larger than
        `most` pixels.
        """
        alike = (by_colour > MAX_ODDS - MIN_DIFFERENCE) & cube.outside
        alike &= ~(place.changed | place.relit)
        alike &= self._background.age(view.window.box) < MAX_RESTING_AGE
        closed = cv2.morphologyEx(alike.view(np.uint8), cv2.MORPH_CLOSE, SQUARE_3)
        closed *= cube.outside.view(np.uint8) * (hand == 0)
        count, labels, statistics, _ = cv2.connectedComponentsWithStats(closed)
        near = cv2.dilate(hand, SQUARE_5, iterations=2) > 0
        keep = np.bincount(labels[near], minlength=count) > 0
        keep &= statistics[:, cv2.CC_STAT_AREA] < most
        keep[0] = False
        return np.asarray(keep[labels])

    def _learn_first(self, view: _View, cube: CubePart) -> None:
        """Learn colours before anything of a hand or its surroundings is known."""
        if cube.shows_hand:
            self._colours.learn_hand(view.colours[view.window.cube_box], cube.evidence)
        if not self._colours.knows_behind:
            self._colours.learn_behind(view.colours, cube.outside)  # a hand is only little of it

    def _learn(
        self, view: _View, cube: CubePart, place: WindowChange, odds: Floats, hand: Image | None
    ) -> None:
        """Learn the colours of the hand and what is behind it, each in its turn."""
        self._frames += 1
        turn, free = self._frames % LEARNING_FRAMES, cube.outside
        if hand is None:
            self._colours.lose_hand()
        elif view.whole or turn == 0 or self._colours.hand_is_new:
            self._learn_hand(view, cube, place, hand.view(bool) & (odds > SURE_ODDS))
        if view.whole or turn == LEARNING_FRAMES // 2:
            if hand is not None:
                free = free & (cv2.dilate(hand, SQUARE_5) == 0)
            self._learn_desk(view, place, free)

    def _learn_hand(self, view: _View, cube: CubePart, place: WindowChange, sure: Flags) -> None:
        """Learn the colours of the hand where it is `sure`, (h, w), and was not before."""
        sure = sure & place.changed
        before = colours(self._background.lab(view.window.box, sure))
        sure[sure] = self._colours.covered_pixels(
            view.colours[sure], before, place.recoloured[sure]
        )
        if np.count_nonzero(sure) > MIN_SHOWN_PX and not cube.shows_hand:
            self._colours.see_hand(view.colours[sure])
        sure[view.window.cube_box] |= cube.evidence
        if np.count_nonzero(sure) > MIN_SHOWN_PX:
            self._colours.learn_hand(view.colours, sure)

    def _learn_desk(self, view: _View, place: WindowChange, free: Flags) -> None:
        """Learn the desk and its colours where it is `free` of cube and hand, (h, w)."""
        self._background.learn(view.lab, view.window.box, free, place)
        if view.whole:
            self._colours.learn_behind(view.colours, free & ~place.changed)

    def _learn_strip(self, image: Image, window: HandWindow) -> None:
        """Learn a strip of the whole image: the cube may come there."""
        scale = window.scale
        columns, rows = (side // scale for side in self._projection.size)
        self._strip = (self._strip + 1) % IMAGE_STRIPS
        top, bottom = (rows * strip // IMAGE_STRIPS for strip in (self._strip, self._strip + 1))
        part = image[top * scale : bottom * scale, : columns * scale]
        free = np.ones((bottom - top, columns), bool)
        first, last = max(window.top - top, 0), max(window.top + window.height - top, 0)
        free[first:last, window.left : window.left + window.width] = False
        self._background.learn_first(
            self._lab(shrink(part, scale)), np.s_[top:bottom, :columns], free
        )
