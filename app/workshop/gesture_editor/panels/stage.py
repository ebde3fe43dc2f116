"""The character, what is chosen about the picture of it, and what has just happened."""

from pathlib import Path

import moderngl
import numpy as np
from imgui_bundle import imgui
from numpy.typing import NDArray

from cubeling.app.ui.palette import ANGRY, INK, PAPER
from cubeling.app.ui.panels.drawing.style import pack_color
from cubeling.app.workshop.gesture_editor.editing.actions import choose_character, toggle_sectors
from cubeling.app.workshop.gesture_editor.panels.ui import ACCENT, GAP, LARGE, SMALL, Rect, Ui
from cubeling.app.workshop.gesture_editor.session import EditorSession
from cubeling.app.workshop.gesture_editor.shown_space import ShownSpace
from cubeling.characters.behaviour import CENTRES_Z_CM, Place

CHARACTER_WIDTH, SECTORS_WIDTH = 78.0, 86.0
"""Widths of the buttons over the picture [design units]."""

LINE_OPACITY, SECTOR_OPACITY = 0.4, 0.5
"""How much the borders of sectors, and the sector of the hand, cover."""


class StagePanel:
    """Shows the pictures of a session's preview; it does not release the context."""

    def __init__(self, context: moderngl.Context) -> None:
        self._context = context
        self._texture: moderngl.Texture | None = None
        self._shown: NDArray[np.uint8] | None = None

    def draw(self, ui: Ui, session: EditorSession, rect: Rect, dense: float) -> None:
        """Draw the character; `dense` is the number of pixels of a unit of `rect`."""
        ui.places["stage"] = rect
        size = max(round(rect[2] * dense), 1), max(round(rect[3] * dense), 1)
        texture = self._upload(session.picture(size))
        canvas, corner = imgui.get_window_draw_list(), (rect[0] + rect[2], rect[1] + rect[3])
        canvas.add_image_rounded(
            imgui.ImTextureRef(texture.glo), rect[:2], corner, (0, 0), (1, 1),
            pack_color((255, 255, 255)), 12.0 * ui.unit,
        )  # fmt: skip
        document = ui.state.document
        if ui.state.sectors_shown or ui.map_held:
            place = None if document.hand_key is None else document.hand_key.place
            space = session.space
            if space is not None:
                _space(space, place, np.array(rect[:2]), dense, ui.unit)
        _choices(ui, rect)
        if ui.state.message:
            _message(ui, rect)

    def release(self) -> None:
        """Release the texture; a second call does nothing."""
        if self._texture is not None:
            self._texture.release()
        self._texture = self._shown = None

    def _upload(self, picture: NDArray[np.uint8]) -> moderngl.Texture:
        """Return the texture of a picture, which is written when the picture is another one."""
        size = picture.shape[1], picture.shape[0]
        if self._texture is None or self._texture.size != size:
            self.release()
            self._texture = self._context.texture(size, 3, alignment=1)
            self._texture.swizzle = "BGR1"
            self._texture.filter = moderngl.NEAREST, moderngl.NEAREST
        if self._shown is not picture:
            self._texture.write(np.ascontiguousarray(picture))
            self._shown = picture
        return self._texture


def _choices(ui: Ui, rect: Rect) -> None:
    """Draw who performs, on the left, and what shows the gesture space, on the right."""
    names = [(name, Path(name).stem) for name in ui.state.characters]
    margin = 10.0 * ui.unit
    imgui.set_cursor_screen_pos((rect[0] + margin, rect[1] + margin))
    longest = max(imgui.calc_text_size(label).x for _, label in names) / ui.unit + 20.0
    wide = max(CHARACTER_WIDTH, longest) * len(names) + GAP * (len(names) - 1)
    imgui.begin_group()
    name = ui.choose("character", names, (ui.state.character,), wide, len(names))
    imgui.end_group()
    if name is not None:
        ui.state = choose_character(ui.state, name)
    left = rect[0] + rect[2] - margin - SECTORS_WIDTH * ui.unit
    imgui.set_cursor_screen_pos((left, rect[1] + margin))
    with ui.font(SMALL):
        if ui.button("sectors", "Sectors", SECTORS_WIDTH, chosen=ui.state.sectors_shown):
            ui.do(toggle_sectors)


def _message(ui: Ui, rect: Rect) -> None:
    """Write what happened, over the lower edge; a long line is wrapped."""
    unit, words = ui.unit, ui.state.message
    size = imgui.calc_text_size(words, wrap_width=rect[2] - 60.0 * unit)
    left = rect[0] + (rect[2] - size.x) / 2
    top = rect[1] + rect[3] - size.y - 22.0 * unit
    across, down = 16.0 * unit, 8.0 * unit
    canvas = imgui.get_window_draw_list()
    corners = (left - across, top - down), (left + size.x + across, top + size.y + down)
    canvas.add_rect_filled(*corners, pack_color(ANGRY if ui.state.alarming else INK), LARGE * unit)
    imgui.set_cursor_screen_pos((left, top))
    imgui.push_text_wrap_pos(left + size.x + 1.0 - imgui.get_window_pos().x)
    ui.label(words, PAPER)
    imgui.pop_text_wrap_pos()


def _space(
    space: ShownSpace, place: Place | None, origin: NDArray[np.float64], dense: float, unit: float
) -> None:
    """Draw the sectors at the distance of a place, and the one that it is in."""

    def places(pixels: NDArray[np.float64]) -> list[tuple[float, float]]:
        return [(float(x), float(y)) for x, y in origin + pixels / dense]

    canvas = imgui.get_window_draw_list()
    for line in space.borders(CENTRES_Z_CM["ZMiddle" if place is None else place.z]):
        start, end = places(line)
        canvas.add_line(start, end, pack_color(ACCENT, LINE_OPACITY), 1.2 * unit)
    if place is not None and not place.contact:
        corners = places(space.sector(place))
        canvas.add_convex_poly_filled([*corners], pack_color(ACCENT, SECTOR_OPACITY))
