"""Framebuffers to draw parts of a picture in, antialiased."""

from collections import OrderedDict

import moderngl

from characters.rendering.programs import Programs
from characters.rendering.view import Rectangle

SAMPLES = 4
"""Samples a pixel of the ground, where the driver has that many."""

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
    """What a part of a picture is drawn in: the ground, and the figures above it.

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
        samples = min(SAMPLES, context.max_samples)
        fine = (FINER * size[0], FINER * size[1])
        self._context = context
        self._color = context.renderbuffer(size, 4, samples=samples)
        self._depth = context.depth_renderbuffer(size, samples=samples)
        self.ground = context.framebuffer([self._color], self._depth)
        """The camera's picture with marks and shadows, several samples a pixel."""
        self._figures = context.texture(fine, 4)
        self._figures.repeat_x = self._figures.repeat_y = False
        self._fine_depth = context.depth_renderbuffer(fine)
        self.figures = context.framebuffer([self._figures], self._fine_depth)
        """The characters on nothing, premultiplied, `FINER` times as large."""
        self.picture = context.texture(size, 4)
        """The result."""
        self.picture.repeat_x = self.picture.repeat_y = False
        self.result = context.framebuffer([self.picture])
        """To read the result from."""
        self._over = context.vertex_array(programs.over, [])

    def resolve(self, ground: moderngl.Framebuffer, figures: Rectangle | None) -> None:
        """Average the samples of the ground into the result, and lay the figures over it.

        Parameters
        ----------
        ground
            Where it was drawn: in `result` itself if nothing needed many samples.
        figures
            The part of the target with figures in it, if any.
        """
        if ground is not self.result:
            self._context.copy_framebuffer(self.result, ground)
        if figures is None:
            return
        self.result.use()
        self.result.viewport = figures.sides
        self._context.enable_only(moderngl.BLEND)
        self._context.blend_func = moderngl.ONE, moderngl.ONE_MINUS_SRC_ALPHA
        self._figures.use(0)
        self._over.render(moderngl.TRIANGLES, vertices=3)

    def release(self) -> None:
        """Give the card's memory back; a second call does nothing."""
        for framebuffer in (self.ground, self.figures, self.result):
            framebuffer.release()
        for buffer in (self._color, self._depth, self._fine_depth):
            buffer.release()
        for texture in (self._figures, self.picture):
            texture.release()
        self._over.release()


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
