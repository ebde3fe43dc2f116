"""Framebuffers that regions of a picture are drawn in."""

from collections import OrderedDict
from collections.abc import Callable
from functools import cached_property, partial
from typing import Generic, TypeVar

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

MAX_PICTURES, MAX_LAYERS = 12, 3
"""How many targets of each kind are kept."""


class PictureTarget:
    """What a region of the picture is drawn in; `size` is (width, height) [px]."""

    def __init__(self, context: moderngl.Context, size: tuple[int, int]) -> None:
        self._texture = _texture(context, size)
        self._framebuffer = context.framebuffer([self._texture])

    def use(self, viewport: tuple[int, int, int, int]) -> None:
        """Draw on it from now on, in a viewport (x, y, width, height) [px]."""
        self._framebuffer.use()
        self._framebuffer.viewport = viewport

    def clear(self) -> None:
        """Draw on it from now on, with black on all of it."""
        self._framebuffer.use()
        self._framebuffer.clear()

    def write(self, bgra: Image) -> None:
        """Fill the first texels, (height, width, 4), first row first."""
        self._texture.write(bgra, viewport=(0, 0, bgra.shape[1], bgra.shape[0]))

    def read(self, width: int, height: int) -> Image:
        """Return the first texels, (height, width, 3)."""
        return read_bytes(self._framebuffer, (0, 0, width, height), 3)

    def release(self) -> None:
        """Release the buffers; a second call does nothing."""
        self._framebuffer.release()
        self._texture.release()


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


Target = TypeVar("Target", PictureTarget, LayerTarget)


class TargetCache(Generic[Target]):
    """Keeps a few targets of different sizes; the least recently used is released first.

    `make` returns a new one of a size (width, height) [px].
    """

    def __init__(self, make: Callable[[tuple[int, int]], Target], limit: int) -> None:
        self._make: Callable[[tuple[int, int]], Target] = make
        self._limit = limit
        self._kept: OrderedDict[tuple[int, int], Target] = OrderedDict()

    def at_least(self, width: int, height: int) -> Target:
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
        target = self._kept.pop(chosen, None) or self._make(chosen)
        self._kept[chosen] = target
        if len(self._kept) > self._limit:
            self._kept.popitem(last=False)[1].release()
        return target

    def release(self) -> None:
        """Release all targets; a second call does nothing."""
        while self._kept:
            self._kept.popitem()[1].release()


class RenderTargets:
    """The targets of a quality."""

    def __init__(self, context: moderngl.Context, quality: Quality) -> None:
        self.pictures = TargetCache(partial(PictureTarget, context), MAX_PICTURES)
        """For regions of the picture."""
        self.layers = TargetCache(
            partial(LayerTarget, context, fineness=quality.fineness), MAX_LAYERS
        )
        """For the characters."""

    def release(self) -> None:
        """Release all targets; a second call does nothing."""
        self.pictures.release()
        self.layers.release()


def read_bytes(
    framebuffer: moderngl.Framebuffer, box: tuple[int, int, int, int], components: int
) -> Image:
    """Return the texels of a box (x, y, width, height), (height, width, components)."""
    data = framebuffer.read(box, components=components, alignment=1)
    return np.frombuffer(data, np.uint8).reshape(box[3], box[2], components)


def bgra_from_bgr(picture: Image) -> Image:
    """Return a contiguous copy of a picture (height, width, 3) with a fourth, opaque channel."""
    return np.asarray(cv2.cvtColor(picture, cv2.COLOR_BGR2BGRA), np.uint8)


def _texture(context: moderngl.Context, size: tuple[int, int]) -> moderngl.Texture:
    texture = context.texture(size, 4)
    texture.repeat_x = texture.repeat_y = False
    return texture
