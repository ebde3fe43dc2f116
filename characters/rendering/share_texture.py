"""Shares of pixels on the graphics card."""

import moderngl
import numpy as np
from numpy.typing import NDArray

from cubeling.characters.rendering.projection import grown_size


class ShareTexture:
    """Keeps one texture that grows with the shares of pixels written to it."""

    def __init__(self, context: moderngl.Context) -> None:
        self._context = context
        self._texture: moderngl.Texture | None = None

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
