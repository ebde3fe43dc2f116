"""A sheet of a study: a text, or a question with what it is about; drawn, and operated."""

from collections.abc import Sequence
from functools import cached_property

import numpy as np

from cubeling.app.errors import AppError
from cubeling.app.ui.canvas import Canvas, text_width, wrap_text
from cubeling.app.ui.palette import ANGRY, INK, PAPER, QUIET
from cubeling.app.workshop.study.protocols.questionnaires import Answer, Item
from cubeling.app.workshop.study.window.fields import (
    CHOSEN,
    FIELD_LEFT,
    FIELD_WIDTH,
    SHEET_HEIGHT,
    SHEET_WIDTH,
    Picture,
    TextField,
    field_of,
    fit,
)

TITLE_Y, TITLE_SIZE = 52.0, 22.0

TEXT_SIZES = (30.0, 26.0, 22.0, 18.0, 15.0)
"""Sizes of a text: the first in which it fits."""

QUESTION_SIZE = 32.0

SHOWN_TOP, MAX_SHOWN_HEIGHT, SHOWN_GAP = 78.0, 360.0, 24.0
"""Room for what is shown, and between two things side by side."""

BUTTON = (540.0, 640.0, 200.0, 52.0)
"""Left, top, width and height of what goes on."""

GO_ON, PRESS_ENTER = "Go on", "or press Enter"

PATCH = 60.0
"""Side of the square in the lower right corner that a light sensor sees."""


def empty_sheet(scale: float) -> Picture:
    """Return a sheet with nothing on it but a black square in the corner."""
    canvas = Canvas(SHEET_WIDTH, SHEET_HEIGHT, scale)
    draw_patch(canvas, lit=False)
    return canvas.color


def draw_patch(canvas: Canvas, *, lit: bool) -> None:
    """Draw the square in the corner, white or black."""
    side = round(PATCH * canvas.scale)
    canvas.color[-side:, -side:] = 255 * lit


class Sheet:
    """What a participant has before them; keys and mouse change it until it is done.

    Parameters
    ----------
    title
        What stands above it.
    text
        What is to be read; "" for a question.
    item
        The question; None for a text.
    captions
        What stands below each thing that is shown.
    pictures
        One for each answer of the question, or none.
    patch
        Whether a square in the corner is white while something is shown, and else black.
    """

    def __init__(
        self,
        title: str,
        text: str = "",
        item: Item | None = None,
        captions: Sequence[str] = (),
        pictures: Sequence[Picture] = (),
        *,
        patch: bool = False,
    ) -> None:
        self._title, self._text, self._item = title, text, item
        self._captions, self._patch = tuple(captions), patch
        self._field = None if item is None else field_of(item, pictures)
        self._problem = ""
        self.answer: Answer = None
        """The answer, once it is done."""
        self.done = False
        """Whether the participant goes on."""
        self.changed = True
        """Whether it looks another way than when it was drawn last."""

    def press(self, key: str) -> None:
        """Handle a key by its name."""
        self.changed = True
        if key == "Enter":
            self._finish()
        elif self._field is not None:
            self._field.press(key)

    def type(self, character: str) -> bool:
        """Handle a character that is typed; return whether it is text."""
        taken = self._field is not None and self._field.type(character)
        self.changed |= taken
        return taken

    def click(self, x: float, y: float) -> None:
        """Handle the mouse where it is pressed, in units of the canvas."""
        self.changed = True
        left, top, width, height = BUTTON
        if left <= x <= left + width and top <= y <= top + height:
            self._finish()
        elif self._field is not None:
            self._field.point(x, y - self._field_top)

    def drag(self, x: float, y: float) -> None:
        """Handle the mouse where it moves while it is pressed."""
        if self._field is not None and y < BUTTON[1]:
            self.changed = True
            self._field.point(x, y - self._field_top)

    @property
    def takes_text(self) -> bool:
        """Whether letters are text, and no keys."""
        return isinstance(self._field, TextField)

    def _finish(self) -> None:
        if self._item is None or self._field is None:
            self.done = True
            return
        try:
            self.answer = self._item.parse(self._field.answer)
            self.done = True
        except AppError as error:
            self._problem = str(error)

    @cached_property
    def _question(self) -> list[str]:
        words = "" if self._item is None else self._item.text
        return wrap_text(words, FIELD_WIDTH, QUESTION_SIZE) if words else []

    @property
    def _question_top(self) -> float:
        """Height of the first line's base."""
        if self._captions:
            return SHOWN_TOP + self._shown_height + 44
        return max(150.0, 0.4 * SHEET_HEIGHT - 20 * len(self._question) - self._field_height / 3)

    @property
    def _shown_height(self) -> float:
        """Height of what is shown, which leaves room for question and field."""
        below = 44 + 42 * max(len(self._question) - 1, 0) + 26 + self._field_height + 30
        return min(MAX_SHOWN_HEIGHT, BUTTON[1] - SHOWN_TOP - below)

    @property
    def _field_height(self) -> float:
        return 0.0 if self._field is None else self._field.height

    @property
    def _field_top(self) -> float:
        top = self._question_top + 42 * max(len(self._question) - 1, 0) + 26
        return min(top, BUTTON[1] - 24 - self._field_height)

    def draw(self, scale: float, shown: Sequence[Picture] = ()) -> Picture:
        """Return it in a size, with what it shows, (height, width, 3) BGR."""
        self.changed = False
        canvas = Canvas(SHEET_WIDTH, SHEET_HEIGHT, scale)
        canvas.text(SHEET_WIDTH / 2, TITLE_Y, self._title, TITLE_SIZE, QUIET, "middle")
        for number, picture in enumerate(shown):
            self._draw_shown(canvas, number, picture, len(shown))
        if self._field is None:
            self._draw_text(canvas)
        else:
            for row, line in enumerate(self._question):
                y = self._question_top + 42 * row
                canvas.text(SHEET_WIDTH / 2, y, line, QUESTION_SIZE, INK, "middle")
            self._field.draw(canvas, self._field_top)
        canvas.text(SHEET_WIDTH / 2, BUTTON[1] - 12, self._problem, 20, ANGRY, "middle")
        left, top, width, height = BUTTON
        canvas.bar(left, top + height / 2, width, height, CHOSEN)
        canvas.text(left + width / 2, top + 34, GO_ON, 24, PAPER, "middle")
        canvas.text(left + width + 20, top + 34, PRESS_ENTER, 18, QUIET)
        if self._patch:
            draw_patch(canvas, lit=bool(shown))
        return canvas.color

    def _draw_text(self, canvas: Canvas) -> None:
        """Draw what is to be read, in the largest size that leaves room for the button."""
        room = BUTTON[1] - 40 - SHOWN_TOP
        for size in TEXT_SIZES:
            lines = [
                line
                for block in self._text.splitlines()
                for line in wrap_text(block, FIELD_WIDTH, size)
            ]
            if 1.5 * size * len(lines) <= room:
                break
        top = SHOWN_TOP + max((room - 1.5 * size * len(lines)) / 3, 0.0)
        widest = max((text_width(line, size) for line in lines if line), default=0.0)
        left = max((SHEET_WIDTH - widest) / 2, FIELD_LEFT)
        for row, line in enumerate(lines):
            canvas.text(left, top + size * (1.1 + 1.5 * row), line, size, INK)

    def _draw_shown(self, canvas: Canvas, number: int, picture: Picture, count: int) -> None:
        width = (FIELD_WIDTH - SHOWN_GAP * (count - 1)) / count
        caption = self._captions[number] if number < len(self._captions) else ""
        height = max(self._shown_height - 26 * bool(caption), 60.0)
        fitted = fit(picture, width * canvas.scale, height * canvas.scale)
        high, wide = np.array(fitted.shape[:2]) / canvas.scale
        x = FIELD_LEFT + (width + SHOWN_GAP) * number + width / 2
        y = SHOWN_TOP + height / 2
        canvas.picture(x - wide / 2, y - high / 2, fitted, 6)
        if caption:
            canvas.text(x, SHOWN_TOP + height + 20, caption, 18, QUIET, "middle")
