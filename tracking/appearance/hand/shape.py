"""From what each pixel speaks for a hand to the hand: its parts and its gaps."""

import cv2
import numpy as np

from cubeling.tracking.appearance.hand.background import UNKNOWN, WindowChange
from cubeling.tracking.appearance.hand.components import at_border
from cubeling.tracking.appearance.hand.on_cube.cube_part import CubePart
from cubeling.tracking.appearance.hand.structuring_elements import SQUARE_3, SQUARE_5
from cubeling.tracking.appearance.hand.window import HandWindow
from cubeling.tracking.geometry.arrays import Flags, Floats, Image

CLOSED_EDGES = 0.25
"""Width of gaps of the hand over the cube that are filled: about a cell of a marker [edges]."""

MIN_TOUCH_EDGES2, MIN_AREA_EDGES2 = 0.01, 0.15
"""Least area beside the cube, and in all, of a hand that hides no face [square edges]."""

MIN_EXTENT_EDGES, SURE_COLOUR_ODDS = 0.9, 1.0
"""How far from the cube's bounds it must reach, as there is an arm behind a hand; but not if its
colours speak so much for a hand on average, as a watch or a sleeve may be between."""

MIN_CHANGED_SHARE = 0.3
"""Least share of such a hand that does not look like the desk."""

MAX_LIKENESS = 0.5
"""Most likeness of its details to those of the desk: of hands on photographs it is at most 0.4, of
a keyboard that the camera's movement has shifted by a fraction of a pixel at least 0.8."""

MIN_COLOUR_ODDS = -1.0
"""Least of what its colours speak for a hand on average: about 0 for skin in the colour of the
desk, below -1.5 for a desk that shows where something else was."""


def fill(odds: Floats, inner: Flags, doubtful: Flags, edge: float) -> Flags:
    """Return where the hand covers what looks like its print: as most of what is told around it."""
    side = 2 * round(CLOSED_EDGES * edge / 2) + 1
    hand = (odds > 0).view(np.uint8)
    closed = cv2.morphologyEx(hand, cv2.MORPH_CLOSE, np.ones((side, side), np.uint8)) > 0
    votes = cv2.blur((np.float32(2) * hand - np.float32(1)) * ~doubtful, (side, side))
    return np.asarray(inner & (closed | (doubtful & (votes > 0))))


def choose_components(
    flags: Flags,
    window: HandWindow,
    cube: CubePart,
    place: WindowChange,
    by_colour: Floats,
    distinctness: float,
) -> Image | None:
    """Choose the components that hold evidence, or that touch the cube and reach away.

    Without any, a hand has let go of the cube or is about to take it: what comes from outside the
    window and has its colours.

    Parameters
    ----------
    flags
        What may be one, (h, w).
    window
        Where that is.
    cube
        The cube there.
    place
        How the window looks compared with the desk.
    by_colour
        What colours speak for a hand, (h, w).
    distinctness
        How well they tell the hand that is there from the desk, 0…1.
    """
    hand = cv2.morphologyEx(flags.view(np.uint8), cv2.MORPH_OPEN, SQUARE_3)
    hand = cv2.morphologyEx(hand, cv2.MORPH_CLOSE, SQUARE_5)
    count, labels32 = cv2.connectedComponents(hand)
    if count == 1:
        return None
    labels = np.asarray(cv2.convertScaleAbs(labels32), np.uint8)
    beside = cv2.dilate(cube.outline, SQUARE_5, iterations=3).view(bool)
    square, by_cube = window.edge**2, labels[window.cube_box]
    large = np.bincount(labels.ravel(), minlength=256) > MIN_AREA_EDGES2 * square
    touching = np.bincount(by_cube[beside], minlength=256) > MIN_TOUCH_EDGES2 * square
    large[0] = False
    keep = np.zeros(256, bool)
    keep[by_cube[cube.evidence]] = True
    for label in np.flatnonzero(touching & large & ~keep).tolist():
        part = labels == label
        reaches = np.count_nonzero(part) > np.count_nonzero(part[_within_reach(window)])
        least = MIN_COLOUR_ODDS if reaches else SURE_COLOUR_ODDS
        keep[label] = _like_hand(part, place, by_colour, least, distinctness)
    if not keep[1:].any():
        for label in np.flatnonzero(at_border(labels, 256) & large).tolist():
            part = labels == label
            keep[label] = _like_hand(part, place, by_colour, SURE_COLOUR_ODDS, distinctness)
    keep[[0, 255]] = False
    return np.asarray(cv2.LUT(labels, keep.view(np.uint8)), np.uint8) if keep.any() else None


def _like_hand(
    part: Flags, place: WindowChange, by_colour: Floats, least: float, distinctness: float
) -> bool:
    """Return whether a component may be a hand; `least` is what its colours speak for one.

    Where the desk is not known, they must speak for sure, and tell the hand that was just there.
    """
    some = MIN_CHANGED_SHARE * np.count_nonzero(part)
    if np.count_nonzero(part & (place.odds > 0)) <= some:
        least = SURE_COLOUR_ODDS
        unknown = np.count_nonzero(part & (place.odds >= UNKNOWN))
        if unknown <= some or distinctness == 0:
            return False
    return bool(by_colour[part].mean() > least and place.likeness(part) < MAX_LIKENESS)


def _within_reach(window: HandWindow) -> tuple[slice, slice]:
    low, high = window.quads.min(axis=(0, 1)), window.quads.max(axis=(0, 1))
    far = MIN_EXTENT_EDGES * window.edge
    (left, top), (right, bottom) = (low - far).tolist(), (high + far).tolist()
    return np.s_[max(int(top), 0) : int(bottom) + 1, max(int(left), 0) : int(right) + 1]
