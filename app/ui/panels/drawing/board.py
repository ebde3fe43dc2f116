"""The panels of a window: which are open and where, and what the player changes on them."""

import math
from dataclasses import dataclass

from imgui_bundle import imgui, implot

from cubeling.app.preferences import PreferenceStore
from cubeling.app.ui.palette import INK, QUIET
from cubeling.app.ui.panels import PANELS
from cubeling.app.ui.panels.content import Widget
from cubeling.app.ui.panels.drawing.places import (
    Rect,
    Size,
    corner_of,
    entry_of,
    free_place,
    overlap,
    place_at,
    place_of,
)
from cubeling.app.ui.panels.drawing.style import (
    TITLE_SIZE,
    load_fonts,
    pack_color,
    use_card_style,
    use_plot_style,
)
from cubeling.app.ui.panels.drawing.widgets import draw_widgets
from cubeling.app.ui.panels.monitor import SessionMonitor
from cubeling.app.ui.playback.requests import SessionRequest

TOP, GAP = 84.0, 12.0
"""Height of the window's top that is left to the hint, and gap between panels [design units]."""

LIST = "list"
"""Name of the panel that opens and closes the others."""

LIST_WIDTH = 132.0
"""Its width [design units]."""

MEASURED_AFTER = 2
"""Frames after which the size of a new panel is known; it is drawn out of sight before."""

MIN_DRAG_PX = 2.0
"""A panel that is farther from its place was dragged there."""

WINDOW_FLAGS = (
    imgui.WindowFlags_.always_auto_resize
    | imgui.WindowFlags_.no_title_bar
    | imgui.WindowFlags_.no_saved_settings
    | imgui.WindowFlags_.no_nav
    | imgui.WindowFlags_.no_focus_on_appearing
)


@dataclass
class _OpenPanel:
    """A panel on the screen."""

    place: Size | None = None
    """Shares of the free width to its left and of the free height above it; None for a new one."""

    chosen: bool = False
    """Whether the player chose the place."""

    frames: int = 0
    """In how many frames it was drawn."""

    corner: Size = (0.0, 0.0)
    """Its top left corner [px]."""

    size: Size = (0.0, 0.0)
    """Its width and height [px]."""

    content: tuple[Widget, ...] | None = None
    """What it shows; None before it was computed."""


class PanelBoard:
    """Draws the open panels; the window calls it within a frame of Dear ImGui.

    It needs Dear ImGui's context until it is closed.

    Parameters
    ----------
    monitor
        What the panels show.
    preferences
        Which panels are open, and where; the board changes them.
    """

    def __init__(self, monitor: SessionMonitor, preferences: PreferenceStore) -> None:
        self._monitor, self._preferences = monitor, preferences
        implot.create_context()
        use_plot_style()
        load_fonts()
        self._scale = 0.0
        self._display: Size = (0.0, 0.0)
        self._popup = False
        self._open = {LIST: _OpenPanel()}
        for entry in preferences.now.panels:
            name, place = place_of(entry)
            if name in PANELS or name == LIST:  # a newer program may have had others
                self._open[name] = _OpenPanel(place, place is not None)

    @property
    def shown(self) -> bool:
        """Whether there is something to draw."""
        return self._preferences.now.panels_shown and self._monitor.step is not None

    def toggle(self) -> None:
        """Show or hide the panels."""
        self._preferences.change(panels_shown=not self._preferences.now.panels_shown)

    @property
    def rects(self) -> list[Rect]:
        """What was drawn lately: left, top, width and height in the window's coordinates.

        It is the whole window while a list of choices is open.
        """
        if self._popup:
            return [(0.0, 0.0, *imgui.get_io().display_size)]
        return [(*panel.corner, *panel.size) for panel in self._open.values() if panel.place]

    @property
    def settling(self) -> bool:
        """Whether a panel is new and has no place yet."""
        return any(panel.place is None for panel in self._open.values())

    def draw(self, scale: float, bottom: float, *, refresh: bool) -> list[SessionRequest]:
        """Draw the panels, and return what the player changed.

        Parameters
        ----------
        scale
            How large, in the window's coordinates for a design unit.
        bottom
            Height of the window's bottom that is left to the timeline, in its coordinates.
        refresh
            Whether they show what there is now, and not what they showed last.
        """
        size = imgui.get_io().display_size
        display = size.x, size.y - bottom
        resized = display != self._display or scale != self._scale
        if scale != self._scale:
            use_card_style(scale)
        self._display, self._scale = display, scale
        changes: list[SessionRequest] = []
        for name, panel in list(self._open.items()):
            if name != LIST and (refresh or panel.content is None):
                panel.content = PANELS[name].content(self._monitor)
            changes += self._draw(name, panel, resized)
        self._popup = imgui.is_popup_open("", imgui.PopupFlags_.any_popup)
        if changes:
            for panel in self._open.values():
                panel.content = None
        return changes

    def close(self) -> None:
        """Release what the plots need."""
        implot.destroy_context()

    def _draw(self, name: str, panel: _OpenPanel, resized: bool) -> list[SessionRequest]:
        self._put(panel, resized)
        imgui.begin(f"##{name}", None, WINDOW_FLAGS)
        width = (LIST_WIDTH if name == LIST else PANELS[name].width) * self._scale
        closed = _header("Panels" if name == LIST else PANELS[name].title, width)
        changes: list[SessionRequest] = []
        if name == LIST:
            self._draw_list()
        else:
            changes = draw_widgets(panel.content or (), width)
        corner, size = imgui.get_window_pos(), imgui.get_window_size()
        imgui.end()
        self._resize(panel, (size.x, size.y))
        panel.frames += 1
        if panel.place is not None and math.dist(corner, panel.corner) > MIN_DRAG_PX:
            panel.corner, panel.chosen = (corner.x, corner.y), True
            panel.place = place_at(panel.corner, panel.size, self._display)
            self._note()
        if closed and name == LIST:
            self.toggle()
        elif closed:
            self._set_open(name, False)
        return changes

    def _resize(self, panel: _OpenPanel, size: Size) -> None:
        """Note a panel's size; one that has grown too large for its place gets another one."""
        grown, panel.size = size[1] > panel.size[1], size
        if not grown or panel.chosen or panel.place is None:
            return
        rect = (*panel.corner, *size)
        outside = panel.corner[1] + size[1] > self._display[1]
        if outside or any(overlap(rect, each) for each in self._others(panel)):
            panel.place = None

    def _others(self, panel: _OpenPanel) -> list[Rect]:
        """Return where the other panels lie."""
        return [
            (*each.corner, *each.size)
            for each in self._open.values()
            if each.place is not None and each is not panel
        ]

    def _put(self, panel: _OpenPanel, resized: bool) -> None:
        """Set where a panel is drawn, unless it stays where it is."""
        if panel.frames < MEASURED_AFTER:
            imgui.set_next_window_pos((-1e4, -1e4))
            return
        if panel.place is None:
            top, gap = TOP * self._scale, GAP * self._scale
            corner = free_place(panel.size, self._others(panel), self._display, top, gap)
            panel.place = place_at(corner, panel.size, self._display)
        elif not resized and panel.frames > MEASURED_AFTER:
            return
        panel.corner = corner_of(panel.place, panel.size, self._display)
        imgui.set_next_window_pos(panel.corner)

    def _draw_list(self) -> None:
        for name, panel in PANELS.items():
            changed, is_open = imgui.checkbox(panel.title, name in self._open)
            if changed:
                self._set_open(name, is_open)

    def _set_open(self, name: str, is_open: bool) -> None:
        if is_open:
            self._open[name] = _OpenPanel()
        else:
            del self._open[name]
        self._note()

    def _note(self) -> None:
        """Note which panels are open, and where the player wants them."""
        entries = [
            entry_of(name, panel.place) if panel.chosen and panel.place else name
            for name, panel in self._open.items()
            if panel.chosen or name != LIST
        ]
        self._preferences.change(panels=tuple(entries))


def _header(title: str, width: float) -> bool:
    """Draw a title and a cross; return whether the cross was clicked."""
    x, y = imgui.get_cursor_screen_pos()
    imgui.push_font(None, TITLE_SIZE)
    imgui.text_unformatted(title)
    high = imgui.get_font_size()
    imgui.pop_font()
    imgui.same_line()
    side = 0.5 * high
    left, top = x + width - side, y + 0.25 * high
    imgui.set_cursor_screen_pos((left - side / 2, y))
    clicked = imgui.invisible_button("close", (2 * side, high))
    color = pack_color(INK if imgui.is_item_hovered() else QUIET)
    canvas = imgui.get_window_draw_list()
    for start, end in ((0.0, 1.0), (1.0, 0.0)):
        canvas.add_line(
            (left, top + start * side), (left + side, top + end * side), color, 0.1 * high
        )
    return clicked
