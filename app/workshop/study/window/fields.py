"""Where a question takes its answer: scales, choices, sliders and free text, drawn and operated."""

from collections.abc import Sequence

import cv2
import numpy as np
from numpy.typing import NDArray

from cubeling.app.ui.canvas import Canvas, text_width, wrap_text
from cubeling.app.ui.palette import INK, PAPER, QUIET, RULE, bgr
from cubeling.app.workshop.study.protocols.questionnaires import Item

Picture = NDArray[np.uint8]

SHEET_WIDTH, SHEET_HEIGHT = 1280.0, 720.0
"""Size of what is drawn, in units of the canvas."""

CHOSEN = bgr("#2b5c9e")
"""Colour of what is chosen, and of the button."""

FIELD_LEFT, FIELD_WIDTH = 140.0, 1000.0
"""Left edge and width of a field."""

RADIUS = 17.0
"""Of the circle of an answer."""

WORDS_SIZE = 20.0
"""Size of the words at an answer."""

PICTURE_SIDE = 96.0
"""Greatest side of the picture of an answer."""

ROW = 46.0
"""Height of a choice, or of a line of text."""

SLIDER_STEPS = 100
"""Steps of a slider by keys."""

MAX_TYPED_CHARS = 2000
"""Longest text that is typed."""


class Field:
    """What takes an answer."""

    height: float
    """Of what is drawn."""

    @property
    def answer(self) -> str:
        """What `Item.parse` reads; "" for nothing yet."""
        raise NotImplementedError

    def draw(self, canvas: Canvas, top: float) -> None:
        """Draw it below a height."""
        raise NotImplementedError

    def press(self, key: str) -> None:
        """Handle a key by its name."""

    def type(self, character: str) -> bool:
        """Handle a character; return whether it is text."""
        return False

    def point(self, x: float, y: float) -> None:
        """Handle the mouse where it is pressed, `y` from the top of the field."""


def field_of(item: Item, pictures: Sequence[Picture] = ()) -> Field:
    """Return the field of an item, with a picture for each answer or none."""
    if item.kind == "text":
        return TextField()
    if item.kind == "slider":
        return SliderField(item)
    return ChoiceField(item) if item.kind == "choice" else ScaleField(item, pictures)


class ScaleField(Field):
    """Circles in a row, chosen by digits, arrows or the mouse."""

    def __init__(self, item: Item, pictures: Sequence[Picture] = ()) -> None:
        self._item, self._pictures = item, pictures
        self._chosen: int | None = None
        count = len(item.answers)
        named = len(item.anchors) == count > 2
        self._between = not item.text  # two opposites: their words are beside the circles
        room = 0.5 if self._between else 1.0
        self._step = FIELD_WIDTH * room / count
        self._left = (SHEET_WIDTH - FIELD_WIDTH * room + self._step) / 2
        values = [f"{each:g}" for each in item.answers]
        unnumbered = self._between or bool(pictures)
        numbers = ("",) * count if unnumbered else values
        # Where no numbers are seen, digits count from the left.
        counted = [f"{number}" for number in range(1, count + 1)]
        self._keys = counted if named or unnumbered else values
        self._words = [
            wrap_text(words, self._step - 10, WORDS_SIZE)
            for words in (item.anchors if named else numbers)
        ]
        self._ends = () if named or not item.anchors else (item.anchors[0], item.anchors[-1])
        self._top = PICTURE_SIDE + 16 if pictures else 8.0
        rows = max(map(len, self._words))
        self.height = self._top + 2 * RADIUS + 34 + 26 * rows + (30 if self._ends else 0)

    @property
    def answer(self) -> str:
        """The number that is chosen."""
        return "" if self._chosen is None else f"{self._item.answers[self._chosen]:g}"

    def draw(self, canvas: Canvas, top: float) -> None:
        """Draw the circles with their pictures and words."""
        middle = top + self._top + RADIUS
        for number, lines in enumerate(self._words):
            x = self._left + number * self._step
            if number < len(self._pictures):
                _draw_fitted(canvas, self._pictures[number], x, top + PICTURE_SIDE / 2)
            _draw_circle(canvas, x, middle, number == self._chosen)
            for row, line in enumerate(lines):
                canvas.text(x, middle + RADIUS + 28 + 26 * row, line, WORDS_SIZE, INK, "middle")
        last = self._left + (len(self._words) - 1) * self._step
        if not self._ends:
            return
        low, high = self._ends
        if self._between:
            canvas.text(self._left - 50, middle + 8, low, 26, INK, "right")
            canvas.text(last + 50, middle + 8, high, 26, INK)
            return
        y = top + self.height - 10
        canvas.text(max(self._left - RADIUS, FIELD_LEFT), y, low, WORDS_SIZE, QUIET)
        canvas.text(
            min(last + RADIUS, FIELD_LEFT + FIELD_WIDTH), y, high, WORDS_SIZE, QUIET, "right"
        )

    def press(self, key: str) -> None:
        """Choose by a digit, or move by arrows."""
        count = len(self._words)
        if key in self._keys:
            self._chosen = self._keys.index(key)
        elif key in ("←", "→"):
            step = 1 if key == "→" else -1
            before = (-1 if step > 0 else count) if self._chosen is None else self._chosen
            self._chosen = min(max(before + step, 0), count - 1)

    def point(self, x: float, y: float) -> None:
        """Choose the circle, its picture or its words."""
        number = round((x - self._left) / self._step)
        if 0 <= number < len(self._words) and y < self.height:
            self._chosen = number


class ChoiceField(Field):
    """Rows of words, chosen by digits, arrows or the mouse."""

    def __init__(self, item: Item) -> None:
        self._options = item.options
        self._chosen: int | None = None
        self._columns = 2 if len(item.options) > 6 else 1
        self._rows = -(-len(item.options) // self._columns)
        self.height = ROW * self._rows

    @property
    def answer(self) -> str:
        """The number of what is chosen, from 1."""
        return "" if self._chosen is None else f"{self._chosen + 1}"

    def draw(self, canvas: Canvas, top: float) -> None:
        """Draw the options below each other, in two columns if there are many."""
        for number, words in enumerate(self._options):
            column, row = divmod(number, self._rows)
            x = self._left + column * FIELD_WIDTH / self._columns
            y = top + ROW * (row + 0.5)
            _draw_circle(canvas, x, y, number == self._chosen)
            canvas.text(x + 36, y + 8, words, 24, INK)

    @property
    def _left(self) -> float:
        widest = max(text_width(words, 24) for words in self._options) + 36
        return max(FIELD_LEFT + RADIUS, (SHEET_WIDTH - widest) / 2 if self._columns == 1 else 0.0)

    def press(self, key: str) -> None:
        """Choose by a digit, or move by arrows."""
        count = len(self._options)
        if key.isdecimal() and 1 <= int(key) <= count:
            self._chosen = int(key) - 1
        elif key in ("↑", "↓"):
            step = 1 if key == "↓" else -1
            before = (-1 if step > 0 else count) if self._chosen is None else self._chosen
            self._chosen = min(max(before + step, 0), count - 1)

    def point(self, x: float, y: float) -> None:
        """Choose the option in whose row the mouse is."""
        column = int(x > SHEET_WIDTH / 2) if self._columns == 2 else 0
        number = int(y // ROW) + column * self._rows
        if 0 <= y < self.height and number < len(self._options):
            self._chosen = number


class SliderField(Field):
    """A line with a handle, which is there once it was put somewhere."""

    height = 120.0

    def __init__(self, item: Item) -> None:
        self._item = item
        self._share: float | None = None

    @property
    def answer(self) -> str:
        """The number at the handle."""
        if self._share is None:
            return ""
        low, high = self._item.low, self._item.high
        return f"{low + self._share * (high - low):.6g}"

    def draw(self, canvas: Canvas, top: float) -> None:
        """Draw the line, its ends and the handle."""
        y = top + 36
        canvas.bar(FIELD_LEFT, y, FIELD_WIDTH, 10, RULE)
        if self._share is not None:
            x = FIELD_LEFT + self._share * FIELD_WIDTH
            canvas.disc(x, y, 20, CHOSEN)
        ends = (self._item.anchors[0], self._item.anchors[-1]) if self._item.anchors else ("", "")
        canvas.text(FIELD_LEFT, top + 94, ends[0], WORDS_SIZE, QUIET)
        canvas.text(FIELD_LEFT + FIELD_WIDTH, top + 94, ends[1], WORDS_SIZE, QUIET, "right")

    def press(self, key: str) -> None:
        """Move by arrows, from the middle at first; Home and End lead to the ends."""
        steps = {"←": -1.0, "→": 1.0, "Home": -SLIDER_STEPS, "End": SLIDER_STEPS}
        if key in steps:
            before = 0.5 if self._share is None else self._share
            self._share = min(max(before + steps[key] / SLIDER_STEPS, 0.0), 1.0)

    def point(self, x: float, y: float) -> None:
        """Put the handle where the mouse is."""
        if 0.0 <= y < self.height:
            self._share = min(max((x - FIELD_LEFT) / FIELD_WIDTH, 0.0), 1.0)


class TextField(Field):
    """Lines of text; Enter ends it, as it goes on to the next question."""

    height = 5 * 34.0 + 24

    def __init__(self) -> None:
        self._text = ""

    @property
    def answer(self) -> str:
        """The text so far."""
        return self._text

    def draw(self, canvas: Canvas, top: float) -> None:
        """Draw the box and the last lines of the text."""
        left, right = FIELD_LEFT, FIELD_LEFT + FIELD_WIDTH
        box = [[left, top], [right, top], [right, top + self.height], [left, top + self.height]]
        canvas.line(box, QUIET, 2, closed=True)
        lines = wrap_text(self._text, FIELD_WIDTH - 40, 24)[-5:]
        for row, line in enumerate(lines):
            canvas.text(left + 16, top + 36 + 34 * row, line, 24, INK)
        end = left + 19 + text_width(lines[-1], 24) * bool(lines[-1])
        end += 8 * self._text.endswith(" ")
        y = top + 36 + 34 * (len(lines) - 1)
        canvas.line([[end, y - 22], [end, y + 6]], INK, 2)

    def press(self, key: str) -> None:
        """Take back the last character."""
        if key == "Backspace":
            self._text = self._text[:-1]

    def type(self, character: str) -> bool:
        """Add a character to the text, unless it is too long."""
        if character.isprintable() and len(self._text) < MAX_TYPED_CHARS:
            self._text += character
        return True


def _draw_circle(canvas: Canvas, x: float, y: float, chosen: bool) -> None:
    canvas.disc(x, y, RADIUS, CHOSEN if chosen else QUIET)
    canvas.disc(x, y, RADIUS - 2.5, PAPER)
    if chosen:
        canvas.disc(x, y, RADIUS - 6.5, CHOSEN)


def _draw_fitted(canvas: Canvas, picture: Picture, x: float, y: float) -> None:
    """Draw a picture around a point, as large as the room at an answer."""
    fitted = fit(picture, PICTURE_SIDE * canvas.scale, PICTURE_SIDE * canvas.scale)
    high, wide = fitted.shape[0] / canvas.scale, fitted.shape[1] / canvas.scale
    canvas.picture(x - wide / 2, y - high / 2, fitted, 6)


def fit(picture: Picture, width_px: float, height_px: float) -> Picture:
    """Return a picture as large as fits into a room [px]."""
    high, wide = picture.shape[:2]
    scale = min(width_px / wide, height_px / high)
    size = max(1, round(wide * scale)), max(1, round(high * scale))
    how = cv2.INTER_AREA if scale < 1.0 else cv2.INTER_CUBIC
    return np.asarray(cv2.resize(picture, size, interpolation=how), np.uint8)
