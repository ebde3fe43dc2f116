"""The colours of the hand and of what is behind it, learned over frames."""

import cv2
import numpy as np
from numpy.typing import NDArray

from cubeling.tracking.geometry.arrays import Flags, Floats
from cubeling.tracking.geometry.robust_statistics import quantile

LAB_BINS = (32, 32, 8)
"""Bins along chroma a and b and along lightness."""

CHROMA_STEP, LIGHTNESS_STEP = 1 / 75, 40.0
"""Width of the bins of chroma, as a share of the lightness, which a shadow does not change; and of
the bins of lightness, L + 16 [CIELab bytes]."""

MEMORY_PER_PICTURE = 0.96
"""What remains of a histogram after one more picture was learned: half of it after 17."""

MIN_LEARNED, MANY_LEARNED = 40, 6000
"""Pixels of a hand from which on its colours are known, and known well."""

MIN_SHOWN_PX = 8
"""Pixels of a hand above which one picture of it shows its colours."""

MIN_DENSITY = 1e-4
"""Density of a colour that was never seen."""

MAX_ODDS = 2.0
"""What a colour speaks for or against a hand at most, as the logarithm of odds."""

DISTINCT_ODDS = 1.2, 1.7
"""Mean of what a hand's own colours speak for it, from which on they tell it from what is behind it
at all, and wherever it is."""

MIN_SEEN_ODDS, MIN_OWN_ODDS = 1.0, 0.2
"""What half of a hand's pixels speak for it, from which on it is told by its colours; and what its
own colours then speak at least."""

MIN_DIFFERENCE = 1.0
"""Difference of such odds from which on one of two colours is more likely that of a hand."""

MIN_COMMON = 0.01
"""Share that a colour must have of what is behind the hand, to be what a hand has uncovered."""

Colours = NDArray[np.uint16]
"""Number of the bin of each pixel, (h, w)."""


def colours(lab: Floats) -> Colours:
    """Return the bin of each pixel; `lab` is L + 16, a and b of CIELab in bytes, (3, …)."""
    light, a, b = lab
    # Once the camera lets in less light than at first, what is white has more than the lightest.
    step = np.minimum(light * np.float32(1 / LIGHTNESS_STEP), LAB_BINS[2] - 1)
    bins: Colours = step.astype(np.uint16)
    for chroma, count, places in ((a, LAB_BINS[0], LAB_BINS[1] * LAB_BINS[2]), (b, *LAB_BINS[1:])):
        share = np.float32(1 / CHROMA_STEP) * chroma / light + np.float32(count // 2)
        bins += share.clip(0, count - 1).astype(np.uint16) * np.uint16(places)
    return bins


class ColourModel:
    """Two histograms that forget slowly: of the hand, and of what is behind it."""

    def __init__(self) -> None:
        self._hand, self._behind = np.zeros(LAB_BINS, np.float32), np.zeros(LAB_BINS, np.float32)
        self._odds = np.zeros(self._hand.size, np.float32)
        self._behind_density = np.zeros(self._hand.size, np.float32)
        self._odds_are_new = True
        self._learned_odds = self._seen_odds = 0.0

    @property
    def distinctness(self) -> float:
        """How well its colours tell the hand that is there from what is behind it, 0…1."""
        own = min(self._learned_odds, self._seen_odds)
        return float(np.interp(own, DISTINCT_ODDS, (0.0, 1.0)))

    @property
    def knows_hand(self) -> bool:
        """Whether enough of a hand was seen."""
        return bool(self._hand.sum() > MIN_LEARNED)

    @property
    def hand_is_new(self) -> bool:
        """Whether so little of a hand was seen that each picture of it counts."""
        return bool(self._hand.sum() < MANY_LEARNED)

    @property
    def knows_behind(self) -> bool:
        """Whether anything behind the hand was seen."""
        return bool(self._behind.any())

    def see_hand(self, seen: Colours) -> None:
        """Take note of colours of the hand that is there, (n,): it may be another one."""
        self._seen_odds = quantile(self.odds(seen), 0.5)

    def lose_hand(self) -> None:
        """Take note that no hand is there: the next may be another one."""
        self._seen_odds = 0.0

    def learn_hand(self, seen: Colours, where: Flags) -> None:
        """Add the marked pixels to those of the hand."""
        self._hand, self._odds_are_new = _learn(self._hand, seen[where]), False

    def learn_behind(self, seen: Colours, where: Flags) -> None:
        """Add the marked pixels to those behind the hand."""
        self._behind, self._odds_are_new = _learn(self._behind, seen[where]), False

    def odds(self, seen: Colours) -> Floats:
        """Return what the colour of each pixel speaks for a hand, (h, w): logarithm of odds."""
        if not self._odds_are_new:
            self._behind_density = _density(self._behind)
            if self.knows_hand:
                ratio = np.log(_density(self._hand) / self._behind_density)
                self._odds = np.minimum(np.maximum(ratio, -MAX_ODDS), MAX_ODDS)
                self._learned_odds = float(self._hand.ravel() @ self._odds / self._hand.sum())
            self._odds_are_new = True
        return np.asarray(self._odds.take(seen), np.float32)

    def uncovered_pixels(self, now: Colours, before: Colours) -> Flags:
        """Return where a hand may have gone: what is there now is common behind it, (n,)."""
        common = self._behind_density.take(now) > MIN_COMMON
        return np.asarray(common & self._less_like_hand(now, before))

    def covered_pixels(self, now: Colours, before: Colours, recoloured: Flags) -> Flags:
        """Return where a hand may be that was not there before, (n,).

        Where a hand was before, it has gone. Where the hand is told by its colours, what does not
        have them is in its shadow, if it is not `recoloured`.
        """
        covered = ~self._less_like_hand(now, before)
        if self._seen_odds > MIN_SEEN_ODDS:
            covered &= recoloured | (self._odds.take(now) > MIN_OWN_ODDS)
        return np.asarray(covered)

    def _less_like_hand(self, now: Colours, before: Colours) -> Flags:
        """Return where what was there before is more likely a hand than what is there now, (n,).

        Before a hand is known, that is what is rarer behind it.
        """
        odds = self._odds if self.knows_hand else -np.log(self._behind_density)
        return np.asarray(odds.take(before) - odds.take(now) > MIN_DIFFERENCE)


def _learn(counts: Floats, seen: Colours) -> Floats:
    new = np.bincount(seen, minlength=counts.size).astype(np.float32)
    return np.asarray(cv2.scaleAdd(counts, MEMORY_PER_PICTURE, new.reshape(LAB_BINS)))


def _density(counts: Floats) -> Floats:
    """Return the share of each colour, smoothed over neighbouring bins, and not zero."""
    by_chroma = cv2.GaussianBlur(counts, (3, 3), 0.8)
    soft = np.asarray(cv2.blur(by_chroma.reshape(-1, LAB_BINS[2]), (3, 1)), np.float32)
    return soft.ravel() * np.float32(1 / max(float(soft.sum()), 1.0)) + np.float32(MIN_DENSITY)
