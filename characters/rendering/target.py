"""Framebuffers to draw parts of a picture in, antialiased."""

from collections import OrderedDict

import cv2
import moderngl
import numpy as np
from numpy.typing import NDArray

from characters.rendering.programs import Programs, assign
from characters.rendering.scene import Rectangle

Image = NDArray[np.uint8]

FINER = 2
"""How much finer a figure is drawn than the picture, along each side. Its triangles are about as
large as a pixel: many samples a pixel then cost software rendering more than more pixels do."""

STEP = 64
"""Sizes are rounded up to it [px], so that a walking character does not ask for a new one
each picture."""

WASTE = 1.5
"""How much larger than needed a target may be: all of it is averaged, but a new one costs more."""

KEPT = 12
"""How many sizes are kept."""


class Target:
    """What a part of a picture is drawn in: the camera's picture, and the figures above it.

    Parameters
    ----------
    context, programs
        Where to draw.
    size
        (width, height) [px].
    """

    def __init__(
        self, context: moderngl.Context, programs: Programs, size: tuple[int, int]
    ) -> None:
        fine = (FINER * size[0], FINER * size[1])
        self._context = context
        self._figures = context.texture(fine, 4)
        self._figures.repeat_x = self._figures.repeat_y = False
        self._fine_depth = context.depth_renderbuffer(fine)
        self.figures = context.framebuffer([self._figures], self._fine_depth)
        """The characters on nothing, premultiplied, `FINER` times as large."""
        self.picture = context.texture(size, 4)
        """The camera's picture with all that is drawn on it."""
        self.picture.repeat_x = self.picture.repeat_y = False
        self.result = context.framebuffer([self.picture])
        """Draws on `picture`. Marks and shadows are smooth by themselves."""
        self._over = context.vertex_array(programs.over, [])

    def lay(self, patch: Image) -> None:
        """Take a part of the camera's picture, (height, width, 4), its first row first."""
        self.picture.write(patch, viewport=(0, 0, patch.shape[1], patch.shape[0]))

    def combine(self, fine: "Target", place: Rectangle) -> None:
        """Lay the figures of some target over the picture of this one.

        Parameters
        ----------
        fine
            Its figures start in its first texel; this target itself, or another.
        place
            Where they belong in this target.
        """
        self.result.use()
        self.result.viewport = place.sides
        self._context.enable_only(moderngl.BLEND)
        self._context.blend_func = moderngl.ONE, moderngl.ONE_MINUS_SRC_ALPHA
        assign(self._over.program, corner=(place.x, place.y))
        fine._figures.use(0)
        self._over.render(moderngl.TRIANGLES, vertices=3)

    def release(self) -> None:
        """Give the card's memory back; a second call does nothing."""
        for framebuffer in (self.figures, self.result):
            framebuffer.release()
        self._fine_depth.release()
        for texture in (self._figures, self.picture):
            texture.release()
        self._over.release()


class Patches:
    """One texture that takes patches of pictures, made anew when one is larger.

    Parameters
    ----------
    context
        Where it lives.
    """

    def __init__(self, context: moderngl.Context) -> None:
        self._context = context
        self._texture: moderngl.Texture | None = None

    def upload(self, patch: Image) -> moderngl.Texture:
        """Send a patch (height, width, 3) to the first texels of the texture, first row first."""
        height, width = patch.shape[:2]
        texture = self._texture
        if texture is None or texture.width < width or texture.height < height:
            room = (0, 0) if texture is None else texture.size
            self.release()
            texture = self._context.texture((max(room[0], width), max(room[1], height)), 3)
            texture.repeat_x = texture.repeat_y = False
            self._texture = texture
        texture.write(np.ascontiguousarray(patch), viewport=(0, 0, width, height), alignment=1)
        return texture

    def release(self) -> None:
        """Give the card's memory back; a second call does nothing."""
        if self._texture is not None:
            self._texture.release()
            self._texture = None


def widened(part: Image) -> Image:
    """Return a part of a picture (height, width, 3) with a fourth, opaque channel, in one piece."""
    return np.asarray(cv2.cvtColor(part, cv2.COLOR_BGR2BGRA), np.uint8)


class Targets:
    """The targets of a few sizes, the least used given up first.

    Parameters
    ----------
    context, programs
        Where to draw.
    """

    def __init__(self, context: moderngl.Context, programs: Programs) -> None:
        self._context = context
        self._programs = programs
        self._kept: OrderedDict[tuple[int, int], Target] = OrderedDict()

    def at_least(self, width: int, height: int) -> Target:
        """Return a target that is large enough, and not much larger."""
        size = (-(-width // STEP) * STEP, -(-height // STEP) * STEP)
        fitting = [
            kept
            for kept in self._kept
            if kept[0] >= width
            and kept[1] >= height
            and kept[0] * kept[1] <= WASTE * size[0] * size[1]
        ]
        chosen = min(fitting, key=lambda kept: kept[0] * kept[1], default=size)
        target = self._kept.pop(chosen, None) or Target(self._context, self._programs, chosen)
        self._kept[chosen] = target
        if len(self._kept) > KEPT:
            self._kept.popitem(last=False)[1].release()
        return target

    def release(self) -> None:
        """Give them all back; a second call does nothing."""
        while self._kept:
            self._kept.popitem()[1].release()
