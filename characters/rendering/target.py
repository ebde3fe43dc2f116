"""Framebuffers to draw parts of a picture in, antialiased."""

from collections import OrderedDict

import moderngl

SAMPLES = 4
"""Samples a pixel, where the driver has that many."""

STEP = 128
"""Sizes are rounded up to it [px], so that a walking character does not ask for a new one each picture."""

KEPT = 6
"""How many sizes are kept."""


class Target:
    """A framebuffer with several samples a pixel, and one to read the result from.

    Parameters
    ----------
    context
        Where they live.
    size
        (width, height) [px].
    """

    def __init__(self, context: moderngl.Context, size: tuple[int, int]) -> None:
        samples = min(SAMPLES, context.max_samples)
        self._context = context
        self._color = context.renderbuffer(size, 4, samples=samples)
        self._depth = context.depth_renderbuffer(size, samples=samples)
        self.canvas = context.framebuffer([self._color], self._depth)
        """To draw into."""
        self.picture = context.texture(size, 4)
        """The result, after `resolve`."""
        self.picture.repeat_x = self.picture.repeat_y = False
        self.result = context.framebuffer([self.picture])
        """To read the result from."""

    def resolve(self) -> None:
        """Average the samples into the result."""
        self._context.copy_framebuffer(self.result, self.canvas)

    def release(self) -> None:
        """Give the card's memory back; a second call does nothing."""
        for owned in (self.canvas, self.result, self._color, self._depth, self.picture):
            owned.release()


class Targets:
    """The targets of a few sizes, the least used given up first.

    Parameters
    ----------
    context
        Where they live.
    """

    def __init__(self, context: moderngl.Context) -> None:
        self._context = context
        self._kept: OrderedDict[tuple[int, int], Target] = OrderedDict()

    def at_least(self, width: int, height: int) -> Target:
        """Return a target that is large enough, and little larger."""
        size = (-(-width // STEP) * STEP, -(-height // STEP) * STEP)
        target = self._kept.pop(size, None) or Target(self._context, size)
        self._kept[size] = target
        if len(self._kept) > KEPT:
            self._kept.popitem(last=False)[1].release()
        return target

    def release(self) -> None:
        """Give them all back; a second call does nothing."""
        while self._kept:
            self._kept.popitem()[1].release()
