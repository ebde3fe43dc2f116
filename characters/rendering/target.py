"""Framebuffers that regions of a picture are drawn in."""

from collections import OrderedDict
from functools import cached_property

import cv2
import moderngl
import numpy as np
from numpy.typing import NDArray

from characters.rendering.deferred.buffers import GeometryBuffer, LightBuffer
from characters.rendering.projection import texture_size
from characters.rendering.quality import Quality

Image = NDArray[np.uint8]

MAX_WASTE = 1.5
"""How many times more pixels than needed a target may have: all are filtered, but a new target
costs more."""

MAX_TARGETS, MAX_DEFERRED_TARGETS = 12, 3
"""How many targets are kept; those of deferred shading take ten times as much memory."""


class RenderTarget:
    """Two layers that a region is drawn in: the camera's picture, and the characters above it.

    `size` is (width, height) [px], `fineness` that of the characters' layer, see `Quality`.
    """

    def __init__(self, context: moderngl.Context, size: tuple[int, int], fineness: int) -> None:
        self._context = context
        self.fineness = fineness
        """Texels of the characters' layer for each pixel, along each side."""
        fine_size = (fineness * size[0], fineness * size[1])
        self.characters_texture = _texture(context, fine_size)
        """The characters on a transparent ground, premultiplied, `fineness` times as large."""
        self._depth = context.depth_renderbuffer(fine_size)
        self._characters = context.framebuffer([self.characters_texture], self._depth)
        self.picture_texture = _texture(context, size)
        """The camera's picture with everything that is drawn on it."""
        self._picture = context.framebuffer([self.picture_texture])

    @cached_property
    def geometry(self) -> GeometryBuffer:
        """What is seen in each texel of the characters' layer; made when first asked for."""
        return GeometryBuffer(self._context, self.characters_texture.size, self._depth)

    @cached_property
    def light(self) -> LightBuffer:
        """The light of each texel of the characters' layer; made when first asked for."""
        return LightBuffer(self._context, self.characters_texture.size)

    def use_picture(self, viewport: tuple[int, int, int, int]) -> None:
        """Draw on the picture, in a viewport (x, y, width, height) [px]."""
        self._picture.use()
        self._picture.viewport = viewport

    def use_characters(self, width: int, height: int) -> moderngl.Framebuffer:
        """Draw on the character layer, whose first texels stand for width × height pixels."""
        self._characters.use()
        self._characters.viewport = (0, 0, self.fineness * width, self.fineness * height)
        return self._characters

    def write(self, bgra: Image) -> None:
        """Fill the first texels of the picture, (height, width, 4), first row first."""
        self.picture_texture.write(bgra, viewport=(0, 0, bgra.shape[1], bgra.shape[0]))

    def read(self, width: int, height: int) -> Image:
        """Return the first texels of the picture, (height, width, 3)."""
        data = self._picture.read((0, 0, width, height), components=3, alignment=1)
        return np.frombuffer(data, np.uint8).reshape(height, width, 3)

    def release(self) -> None:
        """Release the buffers; a second call does nothing."""
        for name in ("geometry", "light"):
            if name in self.__dict__:
                self.__dict__[name].release()
        for framebuffer in (self._characters, self._picture):
            framebuffer.release()
        for attachment in (self._depth, self.characters_texture, self.picture_texture):
            attachment.release()


class RenderTargets:
    """Keeps targets of a few sizes for a quality; the least recently used is released first."""

    def __init__(self, context: moderngl.Context, quality: Quality) -> None:
        self._context, self._fineness = context, quality.fineness
        self._limit = MAX_DEFERRED_TARGETS if quality.deferred else MAX_TARGETS
        self._kept: OrderedDict[tuple[int, int], RenderTarget] = OrderedDict()

    def at_least(self, width: int, height: int) -> RenderTarget:
        """Return a target that is large enough, and not much larger."""
        size = texture_size(width, height)
        fitting = [
            kept
            for kept in self._kept
            if kept[0] >= width
            and kept[1] >= height
            and kept[0] * kept[1] <= MAX_WASTE * size[0] * size[1]
        ]
        chosen = min(fitting, key=lambda kept: kept[0] * kept[1], default=size)
        target = self._kept.pop(chosen, None) or RenderTarget(self._context, chosen, self._fineness)
        self._kept[chosen] = target
        if len(self._kept) > self._limit:
            self._kept.popitem(last=False)[1].release()
        return target

    def release(self) -> None:
        """Release all targets; a second call does nothing."""
        while self._kept:
            self._kept.popitem()[1].release()


def bgra_from_bgr(picture: Image) -> Image:
    """Return a contiguous copy of a picture (height, width, 3) with a fourth, opaque channel."""
    return np.asarray(cv2.cvtColor(picture, cv2.COLOR_BGR2BGRA), np.uint8)


def _texture(context: moderngl.Context, size: tuple[int, int]) -> moderngl.Texture:
    texture = context.texture(size, 4)
    texture.repeat_x = texture.repeat_y = False
    return texture
