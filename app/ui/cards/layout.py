"""Where cards lie: in the corners of the picture that hide neither cube, hand nor character.

They never lie over each other, nor over the hint above them. In a narrow picture, a card at the top
is below the hint, and one at the bottom leaves no room beside it.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from cubeling.app.pipeline.step import Rect
from cubeling.app.ui.canvas import PICTURE_HEIGHT

Corner = Literal["bottom right", "bottom left", "top right", "top left"]
CORNERS: tuple[Corner, ...] = ("bottom right", "bottom left", "top right", "top left")

CARD_MARGIN, CARD_GAP = 24.0, 12.0
"""Distance of a card from the edges of the picture, and least distance between two cards."""

HINT_TOP, HINT_HEIGHT = 22.0, 48.0
"""Top edge and height of the hint, which lies in the middle."""

HINT_ROOM = 624.0
"""Width that is kept free for the hint, so that no card moves when its words change: in a picture
of 16:9, the action's card has room beside it."""

SMOOTHING_S, MIN_STAY_S = 0.5, 2.0
"""Time constant of how much of a card hides something, and how long it stays in a corner."""

LASTING_S, LASTING = 0.7, 0.3
"""Time constant of whether a card hides anything at all, and what that counts beside how much: even
the edge of a character that stays is not hidden for long."""

SLIDING_S = 0.4
"""Time in which a card slides to another corner."""

STAY_ADVANTAGE, FREE_ADVANTAGE = 0.1, 0.05
"""How much more of something a card may hide than it would in another corner, and than in a corner
from which it drives another card."""


def card_box(
    corner: Corner,
    size: tuple[float, float],
    picture_width: float,
    right_top: float = CARD_MARGIN,
) -> Rect:
    """Return the left, top, right and bottom edge of a card of a size, in units of the canvas.

    In the top right corner, cards begin at `right_top`.

    >>> card_box("bottom right", (300.0, 100.0), 1280.0)
    (956.0, 596.0, 1256.0, 696.0)
    >>> card_box("top right", (200.0, 300.0), 1280.0)
    (1056.0, 24.0, 1256.0, 324.0)
    >>> card_box("top left", (200.0, 300.0), 405.0)  # below the hint
    (24.0, 82.0, 224.0, 382.0)
    """
    width, height = size
    x = CARD_MARGIN if corner.endswith("left") else picture_width - width - CARD_MARGIN
    if corner.startswith("bottom"):
        y = PICTURE_HEIGHT - height - CARD_MARGIN
    elif CARD_MARGIN + width + CARD_GAP <= (picture_width - HINT_ROOM) / 2:
        y = right_top if corner == "top right" else CARD_MARGIN
    else:
        y = HINT_TOP + HINT_HEIGHT + CARD_GAP
    return x, y, x + width, y + height


def are_apart(box: Rect, others: Sequence[Rect]) -> bool:
    """Return whether a card has `CARD_GAP` to all others."""
    left, top, right, bottom = box
    return all(
        right + CARD_GAP <= other_left
        or other_right + CARD_GAP <= left
        or bottom + CARD_GAP <= other_top
        or other_bottom + CARD_GAP <= top
        for other_left, other_top, other_right, other_bottom in others
    )


@dataclass(frozen=True)
class _Slide:
    """The way of a card to a place, in units of the canvas."""

    start: tuple[float, float]
    end: tuple[float, float]
    since: float

    def at(self, now: float) -> tuple[float, float]:
        share = min(max((now - self.since) / SLIDING_S, 0.0), 1.0)
        share = share * share * (3.0 - 2.0 * share)  # it starts and stops softly
        (x, y), (to_x, to_y) = self.start, self.end
        return x + share * (to_x - x), y + share * (to_y - y)


@dataclass
class _Placed:
    """A card with its history."""

    corner: Corner
    size: tuple[float, float]
    since: float = -np.inf
    hidden: NDArray[np.float64] = field(default_factory=lambda: np.zeros(len(CORNERS)))
    """Share of the card that would hide something in each corner, smoothed."""

    lasting: NDArray[np.float64] = field(default_factory=lambda: np.zeros(len(CORNERS)))
    """Share of the last time in which it would have hidden anything there."""


class CardLayout:
    """Chooses corners for the cards of one sequence of pictures.

    Cards are named by their first corner. A card moves where it hides something and another corner
    is better. In the top right corner they begin at `right_top`.
    """

    def __init__(self, right_top: float = CARD_MARGIN) -> None:
        self._right_top = right_top
        self._cards: dict[Corner, _Placed] = {}
        self._slides: dict[Corner, _Slide] = {}
        self._now: float | None = None

    def box(self, corner: Corner, size: tuple[float, float], picture_width: float) -> Rect:
        """Return where a card of a size lies in a corner, as `card_box` does."""
        return card_box(corner, size, picture_width, self._right_top)

    def slide(self, home: Corner, box: Rect, now: float) -> tuple[float, float]:
        """Return the top left corner of a card on its way to a box, at a time [s].

        It starts on the way when the box is another one; a new card is there at once.
        """
        place = box[:2]
        slide = self._slides.get(home) or _Slide(place, place, now)
        if slide.end != place:
            slide = _Slide(slide.at(now), place, now)
        self._slides[home] = slide
        return slide.at(now)

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
        fresh, lasting = (
            1.0 if self._now is None else 1 - np.exp(-elapsed / constant)
            for constant in (SMOOTHING_S, LASTING_S)
        )
        self._now = now
        placed: list[Rect] = []
        for home, size in cards.items():
            card = self._cards.setdefault(home, _Placed(home, size))
            card.size = size
            boxes = {corner: self.box(corner, size, picture_width) for corner in CORNERS}
            hidden = [_hidden_share(box, subjects) for box in boxes.values()]
            card.hidden += fresh * (np.array(hidden) - card.hidden)
            card.lasting += lasting * (np.sign(hidden) - card.lasting)
            others = [
                self.box(each.corner, each.size, picture_width)
                for each in self._cards.values()
                if each is not card
            ]
            _move(card, boxes, placed, others, now)
            placed.append(boxes[card.corner])
        return {home: card.corner for home, card in self._cards.items() if home in cards}


def _move(
    card: _Placed,
    boxes: dict[Corner, Rect],
    placed: Sequence[Rect],
    others: Sequence[Rect],
    now: float,
) -> None:
    """Move a card to the best corner beside those that are placed, unless it has just moved.

    `boxes` is where it would lie, and `others` where the other cards do, of which those that are
    not placed can move.
    """
    costs = {
        corner: hidden
        + LASTING * lasting
        - STAY_ADVANTAGE * (corner == card.corner)
        - FREE_ADVANTAGE * are_apart(boxes[corner], others)
        for corner, hidden, lasting in zip(
            CORNERS, card.hidden.tolist(), card.lasting.tolist(), strict=True
        )
        if are_apart(boxes[corner], placed)
    }
    best = min(costs, key=lambda corner: costs[corner], default=card.corner)
    if best != card.corner and (card.corner not in costs or now - card.since >= MIN_STAY_S):
        card.corner, card.since = best, now


def _hidden_share(card: Rect, subjects: Sequence[Rect]) -> float:
    """Return the largest share of a subject or of the card that lies in both, 0…1."""
    card_left, card_top, card_right, card_bottom = card
    area = (card_right - card_left) * (card_bottom - card_top)
    shares = [0.0]
    for left, top, right, bottom in subjects:
        wide = min(card_right, right) - max(card_left, left)
        high = min(card_bottom, bottom) - max(card_top, top)
        if wide > 0 and high > 0:
            smaller = min(area, max((right - left) * (bottom - top), 1.0))
            shares.append(wide * high / smaller)
    return min(max(shares), 1.0)
