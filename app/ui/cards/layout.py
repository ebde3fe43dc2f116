"""Where cards lie: in the corners of the picture that hide neither cube, hand nor character.

They never lie over each other, nor over the hint above them. In a narrow picture, a card at the top
is below the hint, and one at the bottom leaves no room beside it.
"""

import math
from collections.abc import Collection, Mapping, Sequence
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


LABEL_DISTANCE = 8.0
"""Between a label and its character."""

LABEL_STAY_S = 0.7
"""A label goes to a better place once that has been free for so long [s]."""

LEFT_OUT_SIDE = 5
"""The side of a label that is left out: the number of the others."""


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


def are_apart(box: Rect, others: Sequence[Rect], gap: float = CARD_GAP) -> bool:
    """Return whether a card has a gap to all others."""
    left, top, right, bottom = box
    return all(
        right + gap <= other_left
        or other_right + gap <= left
        or bottom + gap <= other_top
        or other_bottom + gap <= top
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
        self.labels = LabelLayout()
        """Where the labels of the characters are."""

    def box(self, corner: Corner, size: tuple[float, float], picture_width: float) -> Rect:
        """Return where a card of a size lies in a corner, as `card_box` does."""
        return card_box(corner, size, picture_width, self._right_top)

    def slide(
        self, home: Corner, box: Rect, now: float, subjects: Sequence[Rect] = ()
    ) -> tuple[float, float]:
        """Return the top left corner of a card on its way to a box, at a time [s].

        It starts on the way when the box is another one. A new card is there at once, and so is one
        whose way leads over a subject that it does not hide yet.
        """
        place = box[:2]
        slide = self._slides.get(home) or _Slide(place, place, now)
        if slide.end != place:
            slide = _Slide(slide.at(now), place, now)
            beside = [each for each in subjects if are_apart(_moved(box, slide.start), [each], 0.0)]
            if not are_apart(_swept(slide.start, box), beside, 0.0):
                slide = _Slide(place, place, now)
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


def _moved(box: Rect, corner: tuple[float, float]) -> Rect:
    """Return a box with its top left corner at another place."""
    x, y = corner
    return x, y, x + box[2] - box[0], y + box[3] - box[1]


def _swept(start: tuple[float, float], box: Rect) -> Rect:
    """Return what a card passes over on its way from a place of its corner to a box."""
    (left, top, right, bottom), (x, y, end, low) = box, _moved(box, start)
    return min(left, x), min(top, y), max(right, end), max(bottom, low)


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


@dataclass
class _LabelPlace:
    """Where a label is."""

    side: int
    """Its side of the character, of `_label_sides`; the last one is nowhere."""

    better_since: float = math.inf
    """Since when another side would be better [s]; ∞ if none is."""


class LabelLayout:
    """Chooses places for the labels of one sequence of pictures.

    A label is above its character's head, or at another side where it would be in the way there: it
    hides nobody, no cube and no card. Where there is no such place, it is left out.
    """

    def __init__(self) -> None:
        self._places: dict[str, _LabelPlace] = {}

    def update(
        self,
        figures: Mapping[str, Rect],
        sizes: Mapping[str, tuple[float, float]],
        taken: Sequence[Rect],
        picture_width: float,
        now: float,
    ) -> dict[str, Rect]:
        """Return where the labels are at a time [s].

        Parameters
        ----------
        figures
            Where the characters are, by name.
        sizes
            Those of their labels.
        taken
            Where no label may be: all characters, cubes and cards.
        picture_width, now
            That of the picture, and the time [s]; all lengths are in units of the canvas.
        """
        placed: dict[str, Rect] = {}
        for name, figure in figures.items():
            others = [*(rect for rect in taken if rect != figure), *placed.values()]
            seen = not are_apart(figure, [(0.0, 0.0, picture_width, PICTURE_HEIGHT)], 0.0)
            free = {
                side: box
                for side, box in enumerate(_label_sides(figure, sizes[name], picture_width))
                if _is_inside(box, picture_width) and are_apart(box, others, 0.0) and seen
            }
            box = free.get(self._side(name, free, now))
            if box is not None:
                placed[name] = box
        return placed

    def _side(self, name: str, free: Collection[int], now: float) -> int:
        """Return the side of a label, of those that are free."""
        best = min(free, default=LEFT_OUT_SIDE)
        place = self._places.setdefault(name, _LabelPlace(best))
        if best >= place.side:
            place.better_since = math.inf
        else:
            place.better_since = min(place.better_since, now)
        if place.side not in free or now - place.better_since >= LABEL_STAY_S:
            place.side, place.better_since = best, math.inf
        return place.side


def _label_sides(figure: Rect, size: tuple[float, float], picture_width: float) -> tuple[Rect, ...]:
    """Return the sides of a label, the best first: above a figure, beside its head, at its feet."""
    left, top, right, bottom = figure
    width, height = size
    middle = min(max((left + right - width) / 2, CARD_MARGIN), picture_width - CARD_MARGIN - width)
    corners = (
        (middle, top - LABEL_DISTANCE - height),
        (right + LABEL_DISTANCE, top),
        (left - LABEL_DISTANCE - width, top),
        (middle, bottom + LABEL_DISTANCE),
        (middle, top - 2 * (LABEL_DISTANCE + height)),
    )
    return tuple((x, y, x + width, y + height) for x, y in corners)


def _is_inside(box: Rect, picture_width: float) -> bool:
    left, top, right, bottom = box
    return left >= 0.0 and top >= 0.0 and right <= picture_width and bottom <= PICTURE_HEIGHT
