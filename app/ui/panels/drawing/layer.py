"""Dear ImGui over what a window shows.

With software rendering it costs several milliseconds to draw the panels, and their content changes
a few times a second. So they are drawn into a texture again when something is to change, and each
frame shows the texture.
"""

from typing import Any

# imgui-bundle contains the GLFW library that both must share, and sets its path on import.
from imgui_bundle import imgui  # isort: skip
import glfw
import moderngl

from cubeling.app.preferences import PreferenceStore
from cubeling.app.ui.panels.drawing.backend import ImGuiBackend, ui_scale
from cubeling.app.ui.panels.drawing.board import PanelBoard
from cubeling.app.ui.panels.drawing.places import Rect
from cubeling.app.ui.panels.monitor import SessionMonitor
from cubeling.app.ui.playback.requests import SessionRequest

VERTEX_SHADER = """
#version 330
uniform vec4 part;  // left, bottom, width and height as shares of the window
out vec2 place;
void main() {
    place = part.xy + part.zw * vec2(gl_VertexID & 1, gl_VertexID >> 1);
    gl_Position = vec4(place * 2.0 - 1.0, 0.0, 1.0);
}
"""

FRAGMENT_SHADER = """
#version 330
uniform sampler2D panels;
in vec2 place;
out vec4 color;
void main() { color = texture(panels, place); }
"""

REFRESH_INTERVAL_S = 0.2
"""Time between two contents of the panels: nobody can read numbers that change faster."""

PREMULTIPLIED = moderngl.ONE, moderngl.ONE_MINUS_SRC_ALPHA
"""How colours are blended that were multiplied by their opacity."""


class PanelLayer:
    """The panels of a window; made after the window's own callbacks, closed before its context.

    Parameters
    ----------
    window
        GLFW's window.
    context
        Its OpenGL context.
    monitor
        What the panels show.
    preferences
        Which panels are open, and where; the layer changes them.
    """

    def __init__(
        self,
        window: Any,
        context: moderngl.Context,
        monitor: SessionMonitor,
        preferences: PreferenceStore,
    ) -> None:
        self._window, self._context = window, context
        self._backend = ImGuiBackend(window)
        self._board = PanelBoard(monitor, preferences)
        self._program = context.program(
            vertex_shader=VERTEX_SHADER, fragment_shader=FRAGMENT_SHADER
        )
        self._quad = context.vertex_array(self._program, [])
        self._canvas: moderngl.Framebuffer | None = None
        self._parts: list[Rect] = []
        self._refreshed_at = float("-inf")

    def toggle(self) -> None:
        """Show or hide the panels."""
        self._board.toggle()
        self._refreshed_at = float("-inf")

    @property
    def shown(self) -> bool:
        """Whether there is something to draw."""
        return self._board.shown

    @property
    def rects(self) -> list[Rect]:
        """Where panels lie: left, top, width and height in the window's coordinates."""
        return self._board.rects if self.shown else []

    @property
    def busy(self) -> bool:
        """Whether they are to be drawn again although nothing else has changed."""
        return self.shown and (self.has_mouse or self._board.settling)

    @property
    def has_mouse(self) -> bool:
        """Whether the mouse is on a panel, or drags something from there."""
        if not self.shown:
            return False
        x, y = glfw.get_cursor_pos(self._window)
        inside = any(
            0 <= x - left <= wide and 0 <= y - top <= high
            for left, top, wide, high in self._board.rects
        )
        return inside or imgui.get_io().want_capture_mouse

    def draw(self, bottom: float = 0.0) -> list[SessionRequest]:
        """Draw the panels over the window's back buffer; return what the player changed.

        They leave `bottom` of the window's height free, in its coordinates.
        """
        if not self.shown:
            return []
        size = glfw.get_framebuffer_size(self._window)
        if 0 in size:  # an iconified window
            return []
        if self._canvas is None or self._canvas.size != size:
            self._release_canvas()
            self._texture = self._context.texture(size, 4)
            self._texture.filter = moderngl.NEAREST, moderngl.NEAREST
            self._canvas = self._context.framebuffer([self._texture])
            self._refreshed_at = float("-inf")
        changes: list[SessionRequest] = []
        now = glfw.get_time()
        refresh = now - self._refreshed_at >= REFRESH_INTERVAL_S
        if refresh or self.has_mouse or self._board.settling:
            changes = self._draw_panels(self._canvas, bottom, refresh)
        if refresh:
            self._refreshed_at = now
        self._show(self._canvas)
        return changes

    def close(self) -> None:
        """Release what the panels need."""
        self._board.close()
        self._backend.close()
        self._release_canvas()
        self._quad.release()
        self._program.release()

    def _draw_panels(
        self, canvas: moderngl.Framebuffer, bottom: float, refresh: bool
    ) -> list[SessionRequest]:
        with self._backend.frame():
            changes = self._board.draw(ui_scale(self._window), bottom, refresh=refresh)
        canvas.use()
        canvas.clear()
        self._backend.render()
        width, height = imgui.get_draw_data().display_size
        self._parts = [
            (left / width, 1.0 - (top + high) / height, wide / width, high / height)
            for left, top, wide, high in self._board.rects
        ]
        return changes

    def _show(self, canvas: moderngl.Framebuffer) -> None:
        screen = self._context.detect_framebuffer(0)
        screen.use()
        screen.viewport = (0, 0, *canvas.size)
        self._texture.use(0)
        self._context.enable_only(moderngl.BLEND)
        self._context.blend_func = PREMULTIPLIED
        for part in self._parts:
            self._program["part"] = part
            self._quad.render(moderngl.TRIANGLE_STRIP, 4)
        self._context.disable(moderngl.BLEND)

    def _release_canvas(self) -> None:
        if self._canvas is not None:
            self._canvas.release()
            self._texture.release()
            self._canvas = None
