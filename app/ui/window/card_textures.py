"""Cards on the graphics side: each is uploaded once, and drawn as long as it stays the same."""

from collections.abc import Sequence

import cv2
import moderngl
import numpy as np
from numpy.typing import NDArray

from cubeling.app.ui.canvas import Card
from cubeling.app.ui.window.kept_cards import KeptCards

FRAGMENT_SHADER = """
#version 330
uniform sampler2D card;
in vec2 place;
out vec4 color;
void main() { color = texture(card, place).bgra; }
"""


class CardTextures:
    """Draws cards over what is in a framebuffer, pixel for pixel.

    `vertex_shader` gives `place`, from the top left corner of what is drawn. Whoever creates it
    releases it, before the context; a second `release` does nothing.
    """

    def __init__(self, context: moderngl.Context, vertex_shader: str) -> None:
        self._context = context
        self._program = context.program(
            vertex_shader=vertex_shader, fragment_shader=FRAGMENT_SHADER
        )
        self._quad = context.vertex_array(self._program, [])
        self._kept = KeptCards(self._upload, lambda texture: texture.release())

    def begin(self) -> None:
        """Begin a picture: what the last one did not use is released."""
        self._kept.begin()

    def draw(
        self, cards: Sequence[Card], screen: moderngl.Framebuffer, left: int, top: int
    ) -> None:
        """Draw cards, those in front last; (left, top) is the origin of their places.

        `left` and `top` are from the framebuffer's lower left corner [px].
        """
        self._context.enable_only(moderngl.BLEND)
        self._context.blend_func = moderngl.SRC_ALPHA, moderngl.ONE_MINUS_SRC_ALPHA
        for card in cards:
            height, width = card.opacity.shape
            screen.viewport = left + card.x, top - card.y - height, width, height
            self._kept.of(card).use(0)
            self._quad.render(moderngl.TRIANGLE_STRIP, 4)
        self._context.disable(moderngl.BLEND)

    def release(self) -> None:
        """Release the textures and the shader."""
        self._kept.clear()
        self._quad.release()
        self._program.release()

    def _upload(self, card: Card) -> moderngl.Texture:
        height, width = card.opacity.shape
        opacity: NDArray[np.uint8] = np.round(255 * card.opacity).astype(np.uint8)
        pixels = cv2.merge([*cv2.split(card.color), opacity])
        texture = self._context.texture((width, height), 4, pixels.tobytes())
        texture.filter = moderngl.NEAREST, moderngl.NEAREST
        return texture
