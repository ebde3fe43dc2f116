"""Paints a window with OpenGL."""

from collections.abc import Sequence
from typing import Any

import cv2
import glfw
import moderngl
import numpy as np

from cubeling.app.ui.canvas import Card
from cubeling.app.ui.window.card_textures import CardTextures
from cubeling.app.ui.window.painter import AROUND_BGR, Picture, Placement

VERTEX_SHADER = """
#version 330
out vec2 place;
void main() {
    vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1);
    place = vec2(corner.x, 1.0 - corner.y);
    gl_Position = vec4(corner * 2.0 - 1.0, 0.0, 1.0);
}
"""

FRAGMENT_SHADER = """
#version 330
uniform sampler2D picture;
uniform float brightness;
uniform bool mirrored;
in vec2 place;
out vec4 color;
void main() {
    vec2 seen = mirrored ? vec2(1.0 - place.x, place.y) : place;
    color = vec4(brightness * texture(picture, seen).bgr, 1.0);
}
"""


class GLPainter:
    """A `Painter` of a GLFW window and its context, into whose back buffer others may draw too."""

    def __init__(self, window: Any, context: moderngl.Context) -> None:
        self._window, self._context = window, context
        self._texture = context.texture((1, 1), 4)
        # OpenCV adds the fourth channel in a quarter of the time that a software driver takes.
        self._pixels = np.empty((1, 1, 4), np.uint8)
        self._cards = CardTextures(context, VERTEX_SHADER)
        self._program = context.program(
            vertex_shader=VERTEX_SHADER, fragment_shader=FRAGMENT_SHADER
        )
        self._quad = context.vertex_array(self._program, [])
        self._card_origin, self._window_size = (0, 0), (1, 1)

    def paint(
        self, picture: Picture, place: Placement, *, mirrored: bool, brightness: float
    ) -> None:
        """Upload a picture, and draw it into the back buffer."""
        height, width = picture.shape[:2]
        self._upload(picture)
        screen = self._context.detect_framebuffer(0)
        screen.use()
        self._window_size = wide, high = place.window
        screen.viewport = (0, 0, wide, high)
        # Without a graphics card, clearing what is drawn over takes a quarter of the time.
        if place.whole != place.window:
            blue, green, red = AROUND_BGR
            screen.clear(red / 255, green / 255, blue / 255)
        top = high - place.top
        screen.viewport = (place.left, top - place.shown[1], *place.shown)
        self._context.disable(moderngl.DEPTH_TEST | moderngl.BLEND | moderngl.CULL_FACE)
        # Without a graphics card, filtering takes twice as long as copying.
        exact = place.shown == (width, height)
        self._texture.filter = (moderngl.NEAREST if exact else moderngl.LINEAR,) * 2
        self._texture.use(0)
        self._program["mirrored"], self._program["brightness"] = mirrored, brightness
        self._quad.render(moderngl.TRIANGLE_STRIP, 4)
        self._card_origin = place.left, top
        self._cards.begin()

    def paint_cards(self, cards: Sequence[Card]) -> None:
        """Draw cards over what is in the back buffer."""
        screen = self._context.detect_framebuffer(0)
        screen.use()
        self._cards.draw(cards, screen, *self._card_origin)
        screen.viewport = (0, 0, *self._window_size)

    def show(self) -> None:
        """Swap the back buffer to the front, without waiting for the screen."""
        glfw.swap_buffers(self._window)

    def finish(self) -> None:
        """Wait until the driver has done all, the swap too."""
        self._context.finish()

    def pixels(self) -> Picture:
        """Return the back buffer, which is undefined after `show`."""
        wide, high = self._window_size
        screen = self._context.detect_framebuffer(0)
        data = screen.read((0, 0, wide, high), components=3, alignment=1)
        rows = np.frombuffer(data, np.uint8).reshape(high, wide, 3)
        return np.ascontiguousarray(rows[::-1, :, ::-1])

    def release(self) -> None:
        """Release the textures and shaders."""
        for each in (self._cards, self._quad, self._program, self._texture):
            each.release()

    def _upload(self, picture: Picture) -> None:
        height, width = picture.shape[:2]
        if (width, height) != self._texture.size:
            self._texture.release()
            self._texture = self._context.texture((width, height), 4)
            self._texture.repeat_x = self._texture.repeat_y = False
            self._pixels = np.empty((height, width, 4), np.uint8)
        cv2.cvtColor(picture, cv2.COLOR_BGR2BGRA, dst=self._pixels)
        self._texture.write(self._pixels)
