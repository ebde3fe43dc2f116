"""Dear ImGui in the look of the cards: their paper, ink and font, at the scale of the screen."""

import tempfile
from pathlib import Path

import imgui_bundle
from imgui_bundle import ImVec2, imgui, implot
from PIL import ImageFont

from cubeling.app.ui.palette import ACTION_COLORS, INK, PAPER, QUIET, RULE, Color, between

FONT_SIZE, TITLE_SIZE = 15.0, 19.0
"""Height of the text and of titles [design units]."""

PANEL_OPACITY = 0.97
"""Opacity of a panel: a little more than a card's, as its text is smaller."""

ROUNDING, PADDING = 14.0, 14.0
"""Radius of a panel's corners, and width of its frame [design units]."""

FALLBACK_FONT = Path(imgui_bundle.__file__).parent / "assets/fonts/Roboto/Roboto-Regular.ttf"
"""Has the letters that the cards' font lacks, such as those of names with accents."""

_COLORS: dict[str, tuple[Color, float]] = {
    "text": (INK, 1.0),
    "text_disabled": (QUIET, 1.0),
    "window_bg": (PAPER, PANEL_OPACITY),
    "popup_bg": (PAPER, 1.0),
    "border": (RULE, 0.0),
    "frame_bg": (RULE, 0.7),
    "frame_bg_hovered": (RULE, 1.0),
    "frame_bg_active": (RULE, 1.0),
    "button": (RULE, 0.7),
    "button_hovered": (RULE, 1.0),
    "button_active": (RULE, 1.0),
    "header": (RULE, 0.8),
    "header_hovered": (RULE, 1.0),
    "header_active": (RULE, 1.0),
    "check_mark": (PAPER, 1.0),
    "checkbox_selected_bg": (ACTION_COLORS["idle"], 1.0),
    "slider_grab": (ACTION_COLORS["idle"], 1.0),
    "slider_grab_active": (between(ACTION_COLORS["idle"], INK, 0.25), 1.0),
    "scrollbar_bg": (PAPER, 0.0),
}
"""Colours and opacities of Dear ImGui, by the names of `imgui.Col_`."""


def use_card_style(scale: float) -> None:
    """Draw everything from the next frame on as on the cards, `scale` times as large."""
    style = imgui.get_style()
    for name, (color, opacity) in _COLORS.items():
        style.set_color_(imgui.Col_[name], rgba(color, opacity))
    style.font_size_base, style.font_scale_dpi = FONT_SIZE, scale
    style.window_rounding = ROUNDING * scale
    style.popup_rounding = style.frame_rounding = style.grab_rounding = 7.0 * scale
    style.window_padding = ImVec2(PADDING * scale, 0.6 * PADDING * scale)
    style.frame_padding = ImVec2(8.0 * scale, 4.0 * scale)
    style.item_spacing = ImVec2(8.0 * scale, 5.0 * scale)
    style.item_inner_spacing = ImVec2(6.0 * scale, 4.0 * scale)
    style.grab_min_size, style.scrollbar_size = 14.0 * scale, 10.0 * scale
    style.window_border_size = style.popup_border_size = 0.0


def use_plot_style() -> None:
    """Draw plots as the cards' curves: without a frame."""
    plot = implot.get_style()
    plot.plot_padding = ImVec2(0.0, 0.0)
    plot.plot_border_size = 0.0
    plot.plot_min_size = ImVec2(1.0, 1.0)
    plot.set_color_(implot.Col_.frame_bg, rgba(PAPER, 0.0))
    plot.set_color_(implot.Col_.plot_bg, rgba(RULE, 0.35))


def load_fonts() -> None:
    """Load the cards' font, which is Pillow's own."""
    fonts = imgui.get_io().fonts
    data = ImageFont.load_default(int(FONT_SIZE))
    assert isinstance(data, ImageFont.FreeTypeFont), "Pillow has FreeType, as the cards need it"
    with tempfile.TemporaryDirectory() as folder:  # Dear ImGui takes the name of a file, at once
        file = Path(folder) / "font.ttf"
        file.write_bytes(data.font_bytes)
        fonts.add_font_from_file_ttf(str(file), FONT_SIZE)
    if FALLBACK_FONT.exists():
        merge = imgui.ImFontConfig()
        merge.merge_mode = True
        fonts.add_font_from_file_ttf(str(FALLBACK_FONT), FONT_SIZE, merge)


def rgba(color: Color, opacity: float = 1.0) -> tuple[float, float, float, float]:
    """Return a colour as Dear ImGui takes it.

    >>> rgba((0, 0, 255), 0.5)
    (1.0, 0.0, 0.0, 0.5)
    """
    blue, green, red = color
    return red / 255, green / 255, blue / 255, opacity


def pack_color(color: Color, opacity: float = 1.0) -> int:
    """Return a colour as Dear ImGui's draw lists take it."""
    blue, green, red = color
    return round(255 * opacity) << 24 | blue << 16 | green << 8 | red
