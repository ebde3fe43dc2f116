"""The hand in front of a cube, on the graphics card: it hides what is drawn behind it."""

from dataclasses import dataclass

import moderngl
import numpy as np
from numpy.typing import NDArray

from characters.rendering.programs import set_uniforms
from characters.rendering.projection import Rectangle, grown_size
from characters.rendering.scene import Cover

COVER_UNIT = 7
"""Texture unit of the cover."""


@dataclass(frozen=True)
class PictureCover:
    """A cover of the picture, uploaded."""

    area: Rectangle
    """Where it is in the picture."""

    distance: float
    """Of the surface behind it from the camera, along its axis [m]."""

    share: NDArray[np.uint8]
    """Share of each pixel that is covered, 0…255, (height, width)."""

    texture: moderngl.Texture
    """The same, in the first texels."""

    def set_uniforms(self, program: moderngl.Program, area: Rectangle) -> None:
        """Bind the texture, and set the uniforms of a program that draws an area of the picture."""
        self.texture.use(COVER_UNIT)
        set_uniforms(
            program,
            cover=COVER_UNIT,
            cover_corner=(self.area.x - area.x, self.area.y - area.y),
            cover_size=(self.area.width, self.area.height),
        )


class ShareTexture:
    """Keeps one texture that grows with the shares of pixels written to it."""

    def __init__(self, context: moderngl.Context) -> None:
        self._context = context
        self._texture: moderngl.Texture | None = None

    def upload(self, cover: Cover) -> PictureCover:
        """Return a cover, given in pixels of the picture, uploaded."""
        height, width = cover.share.shape
        area = Rectangle(cover.x, cover.y, width, height)
        return PictureCover(area, cover.distance, cover.share, self.write(cover.share))

    def write(self, share: NDArray[np.uint8]) -> moderngl.Texture:
        """Return the texture with shares (height, width) 0…255 in its first texels."""
        height, width = share.shape
        texture = self._at_least((width, height))
        texture.write(np.ascontiguousarray(share), viewport=(0, 0, width, height))
        return texture

    def _at_least(self, needed: tuple[int, int]) -> moderngl.Texture:
        size = grown_size(None if self._texture is None else self._texture.size, needed)
        if size is not None:
            self.release()
            self._texture = self._context.texture(size, 1, alignment=1)
        assert self._texture is not None
        return self._texture

    def release(self) -> None:
        """Release the texture; a second call does nothing."""
        if self._texture is not None:
            self._texture.release()
            self._texture = None
