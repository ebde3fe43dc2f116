"""One frame of the editor's panels: Dear ImGui's widgets, and the state that they change."""

from collections.abc import Iterable, Iterator
from contextlib import contextmanager

from imgui_bundle import ImVec2, imgui

from cubeling.app.ui.palette import ACTION_COLORS, INK, PAPER, RULE, Color, between, bgr
from cubeling.app.ui.panels.drawing.style import pack_color, rgba, use_card_style
from cubeling.app.workshop.gesture_editor.editing.document import GestureDocument
from cubeling.app.workshop.gesture_editor.editing.state import (
    Action,
    EditorState,
    with_document,
    with_text,
)

Rect = tuple[float, float, float, float]
"""Left, top, width and height [px]."""

ACCENT = ACTION_COLORS["walk"]
"""Colour of what is selected."""

FIELD = bgr("#f4eddf")
"""Background of what can be changed."""

SUBTLE = bgr("#6d7385")
"""Words that explain; with a contrast of 4.5 to 1 on paper."""

DESK = between(PAPER, RULE, 0.55)
"""Background of the window."""

SMALL, LARGE = 14.0, 18.0
"""Sizes of labels and of titles [design units]."""

VALUE_WIDTH = 42.0
"""Room for the value of a slider, to its right [design units]."""

GAP = 4.0
"""Between buttons that belong together [design units]."""

FRAME_FLAGS = (
    imgui.WindowFlags_.no_decoration
    | imgui.WindowFlags_.no_move
    | imgui.WindowFlags_.no_saved_settings
    | imgui.WindowFlags_.no_bring_to_front_on_focus
)
"""A part of the window that stays where it is."""

_COLORS: dict[str, tuple[Color, float]] = {
    "window_bg": (PAPER, 1.0),
    "frame_bg": (FIELD, 1.0),
    "frame_bg_hovered": (between(FIELD, RULE, 0.6), 1.0),
    "frame_bg_active": (between(FIELD, RULE, 0.6), 1.0),
    "button": (FIELD, 1.0),
    "button_hovered": (between(PAPER, ACCENT, 0.2), 1.0),
    "button_active": (between(PAPER, ACCENT, 0.35), 1.0),
    "header": (between(PAPER, ACCENT, 0.25), 1.0),
    "header_hovered": (between(PAPER, ACCENT, 0.2), 1.0),
    "slider_grab": (ACCENT, 1.0),
    "slider_grab_active": (between(ACCENT, INK, 0.25), 1.0),
    "text_selected_bg": (ACCENT, 0.3),
    "modal_window_dim_bg": (INK, 0.4),
    "separator": (RULE, 1.0),
}
"""Colours that differ from those of the panels over a picture."""


class Ui:
    """The widgets of one frame; each is known by a name, by which its place is noted.

    Parameters
    ----------
    state
        What they show; they change `Ui.state`.
    unit
        Pixels of a design unit.
    """

    def __init__(self, state: EditorState, unit: float) -> None:
        self.state, self.unit = state, unit
        self.places: dict[str, Rect] = {}
        """Where each widget is [px]: who uses the editor without eyes finds it there."""
        self.map_held = False
        """Whether a hand is dragged on the map."""

    def do(self, action: Action) -> None:
        """Take the state one step on."""
        self.state = action(self.state)

    def edit(self, document: GestureDocument) -> None:
        """Replace the document of the state, as one step of undo."""
        self.state = with_document(self.state, document)

    def note(self, name: str) -> None:
        """Note where the last widget is."""
        (left, top), (right, bottom) = imgui.get_item_rect_min(), imgui.get_item_rect_max()
        self.places[name] = left, top, right - left, bottom - top

    def button(
        self,
        name: str,
        label: str,
        width: float = 0.0,
        *,
        enabled: bool = True,
        chosen: bool = False,
    ) -> bool:
        """Draw a button of a width [design units], or that of its label; return if clicked."""
        colors = ("button", "button_hovered", "button_active") if chosen and enabled else ()
        for number, color in enumerate(colors):
            shade = between(ACCENT, INK, 0.15 * number)
            imgui.push_style_color(imgui.Col_[color], rgba(shade))
        if colors:
            imgui.push_style_color(imgui.Col_.text, rgba(PAPER))
        imgui.begin_disabled(not enabled)
        clicked = imgui.button(f"{label}##{name}", (width * self.unit, 0.0))
        imgui.end_disabled()
        imgui.pop_style_color(len(colors) + bool(colors))
        self.note(name)
        return clicked

    def choose(
        self,
        prefix: str,
        options: Iterable[tuple[str, str]],
        chosen: tuple[str, ...],
        width: float,
        columns: int,
    ) -> str | None:
        """Draw buttons for (value, label) in rows that fill a width; return what was clicked."""
        clicked = None
        wide = (width - GAP * (columns - 1)) / columns
        imgui.push_style_var(imgui.StyleVar_.item_spacing, ImVec2(GAP * self.unit, GAP * self.unit))
        with self.font(SMALL):
            for number, (value, label) in enumerate(options):
                if number % columns:
                    imgui.same_line()
                if self.button(f"{prefix}:{value}", label, wide, chosen=value in chosen):
                    clicked = value
        imgui.pop_style_var()
        return clicked

    def slider(
        self,
        name: str,
        label: str,
        value: float,
        limits: tuple[float, float],
        width: float,
        *,
        step: float = 0.05,
        words: str = "%.2f",
        label_width: float = 88.0,
    ) -> float | None:
        """Draw a label and a slider of multiples of `step`; return what it was moved to."""
        x, y = imgui.get_cursor_pos()
        wide = width - label_width - VALUE_WIDTH
        with self.font(SMALL):
            imgui.align_text_to_frame_padding()
            imgui.text_unformatted(label)
            imgui.same_line()
            imgui.set_cursor_pos((x + label_width * self.unit, y))
            typed = imgui.internal.temp_input_is_active(imgui.get_id(f"##{name}"))
            if not typed:  # its value stands to its right, where its knob does not hide it
                self._draw_track(value, limits, wide)
                for color in ("frame_bg", "frame_bg_hovered", "frame_bg_active", "text"):
                    imgui.push_style_color(imgui.Col_[color], rgba(FIELD, 0.0))
            imgui.set_next_item_width(wide * self.unit)
            flags = imgui.SliderFlags_.always_clamp
            moved, to = imgui.slider_float(f"##{name}", value, *limits, words, flags)
            imgui.pop_style_color(0 if typed else 4)
            self.note(name)
            imgui.same_line()
            written = words % value
            room = imgui.calc_text_size(written).x
            imgui.set_cursor_pos((x + width * self.unit - room, y))
            imgui.align_text_to_frame_padding()
            self.label(written, SUBTLE)
        return round(round(to / step) * step, 4) if moved else None

    def _draw_track(self, value: float, limits: tuple[float, float], width: float) -> None:
        """Draw what lies below a slider: its frame, filled from zero to its value."""
        left, top = imgui.get_cursor_screen_pos()
        wide, high = width * self.unit, imgui.get_frame_height()
        canvas, rounding = imgui.get_window_draw_list(), imgui.get_style().frame_rounding
        canvas.add_rect_filled((left, top), (left + wide, top + high), pack_color(FIELD), rounding)
        shares = ((each - limits[0]) / (limits[1] - limits[0]) for each in (0.0, value))
        ends = sorted(left + (0.02 + 0.96 * share) * wide for share in shares)
        fill = pack_color(between(PAPER, ACCENT, 0.3))
        canvas.add_rect_filled((ends[0], top), (ends[1], top + high), fill, 2.0 * self.unit)

    def text_field(self, name: str, text: str, hint: str, width: float) -> str | None:
        """Draw a line of text; return what it was changed to."""
        imgui.set_next_item_width(width * self.unit)
        changed, to = imgui.input_text_with_hint(f"##{name}", hint, text)
        self.note(name)
        return to if changed else None

    def card_field(self, name: str, hint: str, width: float, *, first: bool = False) -> None:
        """Draw a text field of a card; the first one takes what is typed when the card opens."""
        if first and imgui.is_window_appearing():
            imgui.set_keyboard_focus_here()
        text = self.text_field(name, self.state.text(name), hint, width)
        if text is not None:
            self.state = with_text(self.state, name, text)

    def label(self, words: str, color: Color = INK, size: float = 0.0) -> None:
        """Write words at the cursor, which moves on."""
        imgui.push_style_color(imgui.Col_.text, rgba(color))
        with self.font(size):
            imgui.text_unformatted(words)
        imgui.pop_style_color()

    def write(
        self, words: str, place: tuple[float, float], color: Color, size: float, align: float
    ) -> None:
        """Write a line of words; `place` [px] is at `align` of its width, and half its height."""
        with self.font(size):
            wide, high = imgui.calc_text_size(words)
            corner = place[0] - align * wide, place[1] - high / 2
            imgui.get_window_draw_list().add_text(corner, pack_color(color), words)

    @contextmanager
    def font(self, size: float) -> Iterator[None]:
        """Write in another size [design units]; 0 for the usual one."""
        imgui.push_font(None, size)
        yield
        imgui.pop_font()

    @contextmanager
    def part(self, name: str, rect: Rect, padding: float = 14.0) -> Iterator[None]:
        """Draw into a part of the window."""
        imgui.set_next_window_pos(rect[:2])
        imgui.set_next_window_size(rect[2:])
        inner = ImVec2(padding * self.unit, 0.7 * padding * self.unit)
        imgui.push_style_var(imgui.StyleVar_.window_padding, inner)
        imgui.begin(f"##{name}", None, FRAME_FLAGS)
        yield
        imgui.end()
        imgui.pop_style_var()

    @contextmanager
    def column(self, left: float) -> Iterator[None]:
        """Draw beside what was drawn before, from `left` of the window on [design units]."""
        imgui.same_line(left * self.unit)
        imgui.begin_group()
        yield
        imgui.end_group()

    def space(self, height: float) -> None:
        """Leave a gap below what was drawn [design units]."""
        imgui.dummy((0.0, max(height * self.unit - imgui.get_style().item_spacing.y, 0.0)))


def use_editor_style(unit: float) -> None:
    """Draw everything from the next frame on in the editor's look, `unit` times as large."""
    use_card_style(unit)
    style = imgui.get_style()
    for name, (color, opacity) in _COLORS.items():
        style.set_color_(imgui.Col_[name], rgba(color, opacity))
    style.frame_padding = ImVec2(9.0 * unit, 5.0 * unit)
    style.item_spacing = ImVec2(8.0 * unit, 6.0 * unit)
    style.window_rounding = 12.0 * unit
    style.frame_rounding = 6.0 * unit
    style.grab_min_size, style.grab_rounding = 6.0 * unit, 3.0 * unit
    style.disabled_alpha = 0.4
