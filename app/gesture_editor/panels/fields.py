"""Sliders and text fields."""

from collections.abc import Callable
from dataclasses import dataclass

from cubeling.app.gesture_editor.editing.state import EditorState
from cubeling.app.gesture_editor.panels.widgets import (
    ACCENT,
    CARD,
    NORMAL,
    SMALL,
    SUBTLE,
    Look,
    Widget,
    fitting,
    rounded,
)
from cubeling.app.ui.canvas import Canvas, text_width
from cubeling.app.ui.palette import INK, PAPER, QUIET, RULE, between


@dataclass(frozen=True)
class Slider(Widget):
    """A number that is dragged; its name is to the left, its value to the right."""

    label: str
    """Its name."""

    value: float
    """The number."""

    low: float
    """The number at the left end."""

    high: float
    """The number at the right end."""

    change: Callable[[EditorState, float], EditorState]
    """Sets the number."""

    unit: str = ""
    """What is written behind the number."""

    step: float = 0.05
    """Numbers are multiples of this."""

    label_width: float = 84.0
    """Room for the name, in units of the canvas."""

    value_width: float = 46.0
    """Room for the number, in units of the canvas."""

    @property
    def takes_mouse(self) -> bool:
        """Always."""
        return True

    @property
    def track(self) -> tuple[float, float]:
        """Left and right end of the track."""
        left, _, width, _ = self.rect
        return left + self.label_width + 8, left + width - self.value_width - 8

    def draw(self, canvas: Canvas, look: Look) -> None:
        """Draw name, track, knob and value."""
        left, top, width, height = self.rect
        middle, (start, end) = top + height / 2, self.track
        size = fitting(self.label, NORMAL, self.label_width)
        canvas.text(left, middle + 5, self.label, size, INK)
        share = min(max((self.value - self.low) / (self.high - self.low), 0.0), 1.0)
        zero = min(max(-self.low / (self.high - self.low), 0.0), 1.0)
        knob, origin = (start + each * (end - start) for each in (share, zero))
        canvas.line([[start, middle], [end, middle]], RULE, 5)
        canvas.line([[origin, middle], [knob, middle]], between(PAPER, ACCENT, 0.65), 5)
        canvas.disc(knob, middle, 8.5 if look.hovered or look.held else 7.5, ACCENT)
        canvas.disc(knob, middle, 4.0, CARD)
        words = f"{self.value:.4g}{self.unit}"
        canvas.text(left + width, middle + 5, words, SMALL, SUBTLE, "right")

    def press(self, state: EditorState, x: float, y: float) -> EditorState:
        """Put the knob under the mouse, unless it is on the name."""
        return self.drag(state, x, y) if x > self.track[0] - 12 else state

    def drag(self, state: EditorState, x: float, y: float) -> EditorState:
        """Move the knob, in steps."""
        start, end = self.track
        share = min(max((x - start) / (end - start), 0.0), 1.0)
        return self._set(state, self.low + share * (self.high - self.low))

    def _set(self, state: EditorState, value: float) -> EditorState:
        return self.change(state, round(round(value / self.step) * self.step, 4))


@dataclass(frozen=True)
class TextField(Widget):
    """A line of text; a click lets it take what is typed."""

    text: str
    """What stands in it."""

    hint: str
    """What it shows while nothing does."""

    focused: bool
    """Whether it takes what is typed."""

    @property
    def takes_mouse(self) -> bool:
        """Always."""
        return True

    def draw(self, canvas: Canvas, look: Look) -> None:
        """Draw the end of the text that fits, and a caret."""
        left, top, width, height = self.rect
        edge = ACCENT if self.focused else between(RULE, INK, 0.25 * look.hovered)
        rounded(canvas, self.rect, 8, edge)
        rounded(canvas, (left + 1.5, top + 1.5, width - 3, height - 3), 7, CARD)
        shown = self.text
        while text_width(shown, NORMAL) > width - 24:
            shown = shown[1:]
        baseline = top + height / 2 + 5
        if not shown:
            start = left + (16 if self.focused else 11)
            size = fitting(self.hint, NORMAL, width - 28)
            canvas.text(start, baseline, self.hint, size, QUIET)
        else:
            canvas.text(left + 11, baseline, shown, NORMAL, INK)
        if self.focused:
            x = left + 12 + (text_width(shown, NORMAL) if shown else 0.0)
            canvas.line([[x, top + 7], [x, top + height - 7]], ACCENT, 1.6)
