"""Cards on the graphics side: each is uploaded once, and drawn as long as it stays the same."""

from collections.abc import Sequence

import cv2
import moderngl
import numpy as np
from numpy.typing import NDArray

from cubeling.app.ui.canvas import Card

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
        # A card is kept with its texture: its arrays are then those of no other card.
        self._kept: dict[tuple[int, int], tuple[Card, moderngl.Texture]] = {}
        self._used: dict[tuple[int, int], tuple[Card, moderngl.Texture]] = {}

    def begin(self) -> None:
        """Begin a picture: what the last one did not use is released."""
        for key in self._kept.keys() - self._used.keys():
            self._kept.pop(key)[1].release()
        self._used = {}

    def draw(
        self, cards: Sequence[Card], screen: moderngl.Framebuffer, left: int, top: int
    ) -> None:
        """Draw cards, those in front last; (left, top) is the origin of their places.

        `left` and `top` are from the framebuffer's lower left corner [px].
        """
        self._context.enable_only(moderngl.BLEND)
        self._context.blend_func = moderngl.SRC_ALPHA, moderngl.ONE_MINUS_SRC_ALPHA
        for card in cards:
            key = id(card.color), id(card.opacity)
            if key not in self._kept:
                self._kept[key] = card, self._upload(card)
            self._used[key] = kept = self._kept[key]
            height, width = card.opacity.shape
            screen.viewport = left + card.x, top - card.y - height, width, height
            kept[1].use(0)
            self._quad.render(moderngl.TRIANGLE_STRIP, 4)
        self._context.disable(moderngl.BLEND)

    def release(self) -> None:
        """Release the textures and the shader."""
        self._used = {}
        self.begin()
        self._quad.release()
        self._program.release()

    def _upload(self, card: Card) -> moderngl.Texture:
        height, width = card.opacity.shape
        opacity: NDArray[np.uint8] = np.round(255 * card.opacity).astype(np.uint8)
        pixels = cv2.merge([*cv2.split(card.color), opacity])
        texture = self._context.texture((width, height), 4, pixels.tobytes())
        texture.filter = moderngl.NEAREST, moderngl.NEAREST
        return texture
