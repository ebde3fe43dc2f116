"""Draws the content of panels with Dear ImGui."""

from collections.abc import Callable, Iterable
from functools import cache
from typing import Any

import numpy as np
from imgui_bundle import ImVec4, imgui, implot

from cubeling.app.ui.palette import ANGRY, HAPPY, INK, NEUTRAL, QUIET, RULE, Color
from cubeling.app.ui.panels.content import (
    Choice,
    Fact,
    LogLines,
    Note,
    Plot,
    Share,
    ShareBar,
    Slider,
    Switch,
    Tone,
    Widget,
)
from cubeling.app.ui.panels.drawing.style import FONT_SIZE, pack_color, rgba
from cubeling.app.ui.playback.requests import SessionRequest

TONE_COLORS: dict[Tone, Color] = {"good": HAPPY, "warning": NEUTRAL, "bad": ANGRY}
"""Colours of the dot before a value."""

LOG_COLUMNS = (46.0, 76.0)
"""Widths of the columns before the text of a log [design units]."""

LEGEND_COLUMNS = 2
"""Columns of a bar's legend."""

PLOT_FLAGS = implot.Flags_.canvas_only | implot.Flags_.no_inputs | implot.Flags_.no_frame


def draw_widgets(widgets: Iterable[Widget], width: float) -> list[SessionRequest]:
    """Draw widgets below each other, `width` pixels wide; return what the player changed."""
    changes = []
    for widget in widgets:
        change = _DRAW[type(widget)](widget, width)
        if change is not None:
            changes.append(change)
    return changes


def _unit() -> float:
    """Return the pixels of a design unit."""
    return imgui.get_font_size() / FONT_SIZE


def _fact(fact: Fact, width: float) -> None:
    x, y = imgui.get_cursor_screen_pos()
    canvas, unit = imgui.get_window_draw_list(), _unit()
    canvas.add_text((x, y), pack_color(QUIET), fact.name)
    left = x + width - imgui.calc_text_size(fact.value).x
    canvas.add_text((left, y), pack_color(QUIET if fact.tone == "quiet" else INK), fact.value)
    if fact.tone in TONE_COLORS:
        middle = y + imgui.get_font_size() / 2
        canvas.add_circle_filled(
            (left - 11 * unit, middle), 5 * unit, pack_color(TONE_COLORS[fact.tone]), 16
        )
    imgui.dummy((width, imgui.get_font_size()))


def _note(note: Note, width: float) -> None:
    color = INK if note.tone in TONE_COLORS else QUIET
    imgui.push_style_color(imgui.Col_.text, rgba(color))
    imgui.push_text_wrap_pos(imgui.get_cursor_pos_x() + width)
    imgui.text_unformatted(note.text)
    imgui.pop_text_wrap_pos()
    imgui.pop_style_color()


def _plot(plot: Plot, width: float) -> None:
    _legend(plot, width)
    if not implot.begin_plot(f"##{plot.title}", (width, plot.height * _unit()), PLOT_FLAGS):
        return
    hidden = implot.AxisFlags_.no_decorations
    implot.setup_axes("", "", hidden, hidden)
    span = (-plot.span, 0.0, plot.low, plot.high)
    implot.setup_axes_limits(*span, imgui.Cond_.always)
    x, y = implot.get_plot_pos()
    high = implot.get_plot_size().y
    canvas = implot.get_plot_draw_list()
    size = 0.8 * imgui.get_font_size()
    for value, word in plot.marks:
        place = y + high * (plot.high - value) / (plot.high - plot.low)
        canvas.add_line((x, place), (x + width, place), pack_color(RULE), _unit())
        below = place < y + high / 2
        corner = (x + 4 * _unit(), place if below else place - 1.2 * size)
        canvas.add_text(imgui.get_font(), size, corner, pack_color(QUIET), word)
    for curve in plot.curves:
        spec = _spec(curve.color, curve.width * _unit())
        implot.plot_line(curve.name, _contiguous(curve.times), _contiguous(curve.values), spec)
    implot.end_plot()


def _legend(plot: Plot, width: float) -> None:
    """Write the title on the left, and the names of the curves on the right."""
    x, y = imgui.get_cursor_screen_pos()
    canvas, unit, size = imgui.get_window_draw_list(), _unit(), imgui.get_font_size()
    canvas.add_text((x, y), pack_color(INK), plot.title)
    left = x + width
    for curve in plot.curves if len(plot.curves) > 1 else ():
        left -= imgui.calc_text_size(curve.name).x
        canvas.add_text((left, y), pack_color(QUIET), curve.name)
        line = (left - 22 * unit, y + size / 2), (left - 6 * unit, y + size / 2)
        canvas.add_line(*line, pack_color(curve.color), curve.width * unit)
        left -= 34 * unit
    imgui.dummy((width, size))


def _share_bar(bar: ShareBar, width: float) -> None:
    x, y = imgui.get_cursor_screen_pos()
    canvas, unit = imgui.get_window_draw_list(), _unit()
    high = 18 * unit
    total = sum(share.amount for share in bar.shares) or 1.0
    left = x
    for share in bar.shares:
        right = left + width * share.amount / total
        canvas.add_rect_filled((left, y), (right, y + high), pack_color(share.color))
        left = right
    imgui.dummy((width, high))
    rows = -(-len(bar.shares) // LEGEND_COLUMNS)
    column = (width + 20 * unit) / LEGEND_COLUMNS
    x, y = imgui.get_cursor_screen_pos()
    step = imgui.get_text_line_height_with_spacing()
    for place, share in enumerate(bar.shares):
        corner = x + place // rows * column, y + place % rows * step
        _legend_entry(share, *corner, column - 20 * unit)
    imgui.dummy((width, rows * step - imgui.get_style().item_spacing.y))


def _legend_entry(share: Share, x: float, y: float, width: float) -> None:
    canvas, unit, size = imgui.get_window_draw_list(), _unit(), imgui.get_font_size()
    middle = y + size / 2
    canvas.add_circle_filled((x + 5 * unit, middle), 5 * unit, pack_color(share.color), 16)
    canvas.add_text((x + 16 * unit, y), pack_color(QUIET), share.name)
    left = x + width - imgui.calc_text_size(share.value).x
    canvas.add_text((left, y), pack_color(INK), share.value)


def _choice(choice: Choice, width: float) -> SessionRequest | None:
    change = None
    imgui.begin_disabled(not choice.enabled)
    _label(choice.name, width)
    if imgui.begin_combo(f"##{choice.setting}", choice.value):
        for value in choice.choices:
            chosen, _ = imgui.selectable(value, value == choice.value)
            if chosen and value != choice.value:
                change = choice.request(choice.setting, value)
        imgui.end_combo()
    imgui.end_disabled()
    return change


def _slider(slider: Slider, width: float) -> SessionRequest | None:
    imgui.begin_disabled(not slider.enabled)
    _label(slider.name, width)
    moved, value = imgui.slider_float(
        f"##{slider.setting}",
        slider.value,
        slider.low,
        slider.high,
        "%.1f",
        imgui.SliderFlags_.always_clamp | imgui.SliderFlags_.no_input,
    )
    imgui.end_disabled()
    return slider.request(slider.setting, round(value, 1)) if moved else None


def _switch(switch: Switch, width: float) -> SessionRequest | None:
    changed, value = imgui.checkbox(switch.name, switch.value)
    return switch.request(switch.setting, value) if changed else None


def _label(name: str, width: float) -> None:
    """Write the name of a setting; what changes it has the right half of the panel."""
    x, y = imgui.get_cursor_pos()
    imgui.align_text_to_frame_padding()
    imgui.text_unformatted(name)
    imgui.same_line()
    imgui.set_cursor_pos((x + width / 2, y))
    imgui.set_next_item_width(width / 2)


def _log(log: LogLines, width: float) -> None:
    x, y = imgui.get_cursor_screen_pos()
    canvas, unit = imgui.get_window_draw_list(), _unit()
    step = imgui.get_text_line_height_with_spacing()
    canvas.push_clip_rect((x, y), (x + width, y + log.length * step), True)
    second, third = LOG_COLUMNS[0] * unit, sum(LOG_COLUMNS) * unit
    for place, (when, sender, text) in enumerate(log.rows):
        top = y + place * step
        canvas.add_text((x, top), pack_color(QUIET), when)
        canvas.add_text((x + second, top), pack_color(QUIET), sender)
        canvas.add_text((x + third, top), pack_color(INK), text)
    canvas.pop_clip_rect()
    imgui.dummy((width, log.length * step - imgui.get_style().item_spacing.y))


@cache
def _spec(color: Color, width: float) -> implot.Spec:
    return implot.Spec(line_color=ImVec4(*rgba(color)), line_weight=width)


def _contiguous(values: Any) -> Any:
    return np.ascontiguousarray(values)


_DRAW: dict[type, Callable[[Any, float], SessionRequest | None]] = {
    Fact: _fact,
    Note: _note,
    Plot: _plot,
    ShareBar: _share_bar,
    Choice: _choice,
    Slider: _slider,
    Switch: _switch,
    LogLines: _log,
}
"""What draws each kind of widget; it returns what the player asks for."""
