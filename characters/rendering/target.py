"""Framebuffers that characters are drawn in."""

from collections import OrderedDict
from functools import cached_property

import moderngl
import numpy as np
from numpy.typing import NDArray

from cubeling.characters.rendering.deferred.buffers import GeometryBuffer, LightBuffer
from cubeling.characters.rendering.projection import texture_size

Image = NDArray[np.uint8]

MAX_WASTE = 1.5
"""How many times more pixels than needed a target may have: all are filtered, but a new target
costs more."""

MAX_TARGETS = 3
"""How many targets are kept."""


class LayerTarget:
    """What the characters are drawn in, above the picture.

    `size` is (width, height) [px], `fineness` that of the layer, see `Quality`.
    """

    def __init__(self, context: moderngl.Context, size: tuple[int, int], fineness: int) -> None:
        self._context = context
        self.size = size
        """(width, height) [px]."""
        self.fineness = fineness
        """Texels for each pixel, along each side."""
        fine_size = (fineness * size[0], fineness * size[1])
        self.characters_texture = _texture(context, fine_size)
        """The characters on a transparent ground, premultiplied, `fineness` times as large."""
        self._depth = context.depth_renderbuffer(fine_size)
        self.framebuffer = context.framebuffer([self.characters_texture], self._depth)
        """Draws on that."""

    def read(self, width: int, height: int) -> Image:
        """Return the texels of the first width × height pixels, (rows, columns, 4) BGRA."""
        columns, rows = self.fineness * width, self.fineness * height
        return read_bytes(self.framebuffer, (0, 0, columns, rows), 4)

    @cached_property
    def geometry(self) -> GeometryBuffer:
        """What is seen in each texel; made when first asked for."""
        return GeometryBuffer(self._context, self.characters_texture.size, self._depth)

    @cached_property
    def light(self) -> LightBuffer:
        """The light of each texel; made when first asked for."""
        return LightBuffer(self._context, self.characters_texture.size)

    def release(self) -> None:
        """Release the buffers; a second call does nothing."""
        for name in ("geometry", "light"):
            if name in self.__dict__:
                self.__dict__[name].release()
        for each in (self.framebuffer, self._depth, self.characters_texture):
            each.release()


class TargetCache:
    """Keeps a few targets of different sizes; the least recently used is released first."""

    def __init__(self, context: moderngl.Context, fineness: int) -> None:
        self._context, self._fineness = context, fineness
        self._kept: OrderedDict[tuple[int, int], LayerTarget] = OrderedDict()

    def at_least(self, width: int, height: int) -> LayerTarget:
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
        target = self._kept.pop(chosen, None) or LayerTarget(self._context, chosen, self._fineness)
        self._kept[chosen] = target
        if len(self._kept) > MAX_TARGETS:
            self._kept.popitem(last=False)[1].release()
        return target

    def release(self) -> None:
        """Release all targets; a second call does nothing."""
        while self._kept:
            self._kept.popitem()[1].release()


def read_bytes(
    framebuffer: moderngl.Framebuffer, box: tuple[int, int, int, int], components: int
) -> Image:
    """Return the texels of a box (x, y, width, height), (height, width, components)."""
    data = framebuffer.read(box, components=components, alignment=1)
    return np.frombuffer(data, np.uint8).reshape(box[3], box[2], components)


def _texture(context: moderngl.Context, size: tuple[int, int]) -> moderngl.Texture:
    texture = context.texture(size, 4)
    texture.repeat_x = texture.repeat_y = False
    return texture
