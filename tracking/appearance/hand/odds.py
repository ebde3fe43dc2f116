"""What colour, place and print together speak for a hand, pixel by pixel."""

import cv2
import numpy as np

from cubeling.tracking.appearance.hand.background import SHADED, UNKNOWN, WindowChange
from cubeling.tracking.appearance.hand.edge import ODDS_RANGE
from cubeling.tracking.appearance.hand.on_cube.cube_part import CubePart
from cubeling.tracking.appearance.hand.shape import fill
from cubeling.tracking.appearance.hand.structuring_elements import SQUARE_3
from cubeling.tracking.appearance.hand.window import HandWindow
from cubeling.tracking.geometry.arrays import Floats

SLANTED_EVIDENCE = -1.0
"""What a face speaks for a hand that the camera sees at so small an angle that its print tells
nothing, as logarithm of odds."""

FAMILIAR_ODDS = -0.5, 0.5
"""What the colours near it speak for a hand, from which on what has changed may be one at all, and
without doubt; a colour that was never seen speaks neither for nor against it."""


def hand_odds(
    window: HandWindow, cube: CubePart, place: WindowChange, by_colour: Floats, distinctness: float
) -> Floats:
    """Return what all speaks for a hand, (h, w): smooth, but sure where the cube is not hidden.

    Where the place tells, or paper and ink are near, colours tell half.

    Parameters
    ----------
    window, cube
        Where that is, and the cube there.
    place
        How the window looks compared with the desk.
    by_colour
        What colours speak for a hand, (h, w).
    distinctness
        How well they tell it from the desk, 0…1.
    """
    halved = place.changed | ~cube.outside
    odds = by_colour * (np.float32(1) - np.float32(0.5) * halved)
    odds += _credible(place, by_colour, distinctness)
    # However short a place is known for: what looks as before is no hand.
    np.minimum(odds, np.float32(UNKNOWN), out=odds, where=place.odds < SHADED)
    part = odds[window.cube_box]
    part[cube.slanted] += SLANTED_EVIDENCE
    part[cube.inner] = -ODDS_RANGE
    part[cube.evidence | cube.told] = ODDS_RANGE
    odds = odds.clip(-ODDS_RANGE, ODDS_RANGE)
    smooth = np.asarray(cv2.GaussianBlur(odds, (5, 5), 1.0), np.float32)
    part = smooth[window.cube_box]
    part[fill(part, cube.inner, cube.doubtful, window.edge)] = 0.5 * ODDS_RANGE
    return smooth


def _credible(place: WindowChange, by_colour: Floats, distinctness: float) -> Floats:
    """Return what the place speaks for a hand, less where nothing near has its colours, (h, w).

    The more its colours tell the hand from the desk, the less can it have those of the desk: then
    what has changed is a shadow, or desk in the place of something that was moved. What has become
    of another colour is no shadow, but may be a sleeve.
    """
    low, high = FAMILIAR_ODDS
    near = cv2.dilate(cv2.blur(by_colour, (3, 3)), SQUARE_3)
    lack = ((np.float32(high) - near) / np.float32(high - low)).clip(0, 1)
    lack *= np.float32(distinctness) * ~place.recoloured
    return np.asarray(place.odds - lack * np.maximum(place.odds, 0))
