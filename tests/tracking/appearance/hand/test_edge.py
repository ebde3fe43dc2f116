"""The edge of the hand's cover is where the hand's edge is."""

import numpy as np
import pytest

from cubeling.tracking.appearance.hand.edge import ODDS_RANGE, soft_cover
from cubeling.tracking.appearance.hand.mask import EDGE_SLOPE, HandMask
from cubeling.tracking.appearance.hand.window import HandWindow
from tests.bench.hand_mask import covered

SIDE, SCALE, EDGE = 40, 3, 20.3
"""Side of the window and pixels of the image per pixel of it [px]; where the hand ends [px of the
window], measured from the left of the first column."""


def difference(hand: tuple[float, ...], desk: tuple[float, ...], light: float) -> np.ndarray:
    """How a hand at the left of a desk that it shades differs from it, by CIELab's L + 16, a, b."""
    share = np.clip(EDGE - np.arange(SIDE), 0, 1) * np.ones((SIDE, 1))
    before, inside = (np.array(colour)[:, None, None] for colour in (desk, hand))
    picture = share * inside + (1 - share) * light * before
    gain = picture[0] / before[0]
    off = np.hypot(*(picture[1:] - gain * before[1:]))
    return np.asarray(np.abs(picture[0] - before[0]) + 2 * off, np.float32)


@pytest.mark.parametrize("light", [1.0, 0.7])
@pytest.mark.parametrize("hand", [(70, 3, 4), (250, 4, 10), (190, 20, 25)])
@pytest.mark.parametrize("grown", [0, 1])
def test_the_edge_is_where_the_hand_ends(hand, light, grown):
    window = HandWindow(0, 0, SIDE, SIDE, SCALE, 28.0, np.zeros((6, 4, 2)), np.s_[0:1, 0:1])
    mask = np.zeros((SIDE, SIDE), np.uint8)
    mask[5:35, : 20 + grown] = 1
    odds = np.where(mask, np.float32(ODDS_RANGE), np.float32(-ODDS_RANGE))
    left, top, share = soft_cover(mask, odds, difference(hand, (160, 8, 30), light), window)
    found = HandMask(SCALE * left, SCALE * top, share, np.zeros(3), SCALE, EDGE_SLOPE)
    row = 255 * covered(found, (SCALE * SIDE, SCALE * SIDE))[20 * SCALE]
    assert abs(np.count_nonzero(row > 127) - EDGE * SCALE) < 2
    assert np.count_nonzero((row > 10) & (row < 245)) <= 2 * SCALE
