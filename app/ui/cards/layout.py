"""Where cards lie: in the corners of the picture that hide neither cube, hand nor character."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from app.pipeline.step import Rect
from app.ui.canvas import PICTURE_HEIGHT

Corner = Literal["bottom right", "bottom left", "top right", "top left"]
CORNERS: tuple[Corner, ...] = ("bottom right", "bottom left", "top right", "top left")

CARD_MARGIN = 24.0
"""Distance of a card from the edges of the picture."""

SMOOTHING_S, MIN_STAY_S = 0.5, 2.0
"""Time constant of how much of a card hides something, and how long it stays in a corner."""

STAY_ADVANTAGE, FREE_ADVANTAGE = 0.1, 0.05
"""How much more of something a card may hide than it would in another corner, and than in a corner
from which it drives another card."""


def card_place(
    corner: Corner, size: tuple[float, float], picture_width: float
) -> tuple[float, float]:
    """Return the top left corner of a card of a size, in units of the canvas.

    >>> card_place("bottom right", (300.0, 100.0), 1280.0)
    (956.0, 596.0)
    """
    width, height = size
    x = CARD_MARGIN if corner.endswith("left") else picture_width - width - CARD_MARGIN
    y = CARD_MARGIN if corner.startswith("top") else PICTURE_HEIGHT - height - CARD_MARGIN
    return x, y


@dataclass
class _Placed:
    """A card with its history."""

    corner: Corner
    since: float = -np.inf
    hidden: NDArray[np.float64] = field(default_factory=lambda: np.zeros(len(CORNERS)))
    """Share of the card that would hide something in each corner, smoothed."""


class CardLayout:
    """Chooses corners for the cards of one sequence of pictures.

    Cards are named by their first corner. A card moves where it hides something and another corner
    is better.
    """

    def __init__(self) -> None:
        self._cards: dict[Corner, _Placed] = {}
        self._now: float | None = None

    def update(
        self,
        cards: dict[Corner, tuple[float, float]],
        subjects: Sequence[Rect],
        picture_width: float,
        now: float,
    ) -> dict[Corner, Corner]:
        """Return the corner of each card at a time [s].

        `cards` are their sizes by their first corner, the most important card first; `subjects`
        must stay visible; all in units of the canvas.
        """
        elapsed = 0.0 if self._now is None else max(now - self._now, 0.0)
        fresh = 1.0 if self._now is None else 1 - np.exp(-elapsed / SMOOTHING_S)
        self._now = now
        taken: list[Corner] = []
        for home, size in cards.items():
            card = self._cards.setdefault(home, _Placed(home))
            hidden = [
                _hidden_share((*card_place(corner, size, picture_width), *size), subjects)
                for corner in CORNERS
            ]
            card.hidden += fresh * (np.array(hidden) - card.hidden)
            others = [each.corner for each in self._cards.values() if each is not card]
            _move(card, taken, others, now)
            taken.append(card.corner)
        return {home: card.corner for home, card in self._cards.items() if home in cards}


def _move(card: _Placed, taken: Sequence[Corner], others: Sequence[Corner], now: float) -> None:
    """Move a card to the best corner that is not taken, unless it has just moved.

    `others` are the corners of the other cards, of which those that are not taken can move.
    """
    costs = {
        corner: hidden
        - STAY_ADVANTAGE * (corner == card.corner)
        - FREE_ADVANTAGE * (corner not in others)
        for corner, hidden in zip(CORNERS, card.hidden.tolist(), strict=True)
        if corner not in taken
    }
    best = min(costs, key=lambda corner: costs[corner])
    if best != card.corner and (card.corner in taken or now - card.since >= MIN_STAY_S):
        card.corner, card.since = best, now


def _hidden_share(card: tuple[float, float, float, float], subjects: Sequence[Rect]) -> float:
    """Return the largest share of a subject or of the card that lies in both, 0…1."""
    x, y, width, height = card
    shares = [0.0]
    for left, top, right, bottom in subjects:
        wide = min(x + width, right) - max(x, left)
        high = min(y + height, bottom) - max(y, top)
        if wide > 0 and high > 0:
            smaller = min(width * height, max((right - left) * (bottom - top), 1.0))
            shares.append(wide * high / smaller)
    return min(max(shares), 1.0)
