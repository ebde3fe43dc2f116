"""The shadow of one character on the table: sharp under its feet, softer with height."""

import moderngl
import numpy as np
from numpy.typing import NDArray

from characters.rendering.geometry.skinning import SkinnedCharacter
from characters.rendering.light import TO_LIGHT
from characters.rendering.passes.cubes import Outlines
from characters.rendering.programs import Programs, assign

Array = NDArray[np.float64]

SIDE = 80
"""Texels along the map; a character covers about half of them."""

TAPS = 10
"""Of the blur on each side; `TAPS` in `blur.frag` too."""

SLOPE = TO_LIGHT[[0, 2]] / TO_LIGHT[1]
"""How far (x, z) a point's shadow is from right below it for each metre of height, negated."""

LEVELS = (0.0, 0.1, 0.4, 1.0)
"""Heights at which the shadow is blurred apart, as shares of the character's."""

KEY_BLUR = (0.010, 0.022, 0.05, 0.10)
"""Standard deviation of the key light's blur at each height, as shares of the character's height:
a lamp of about 25° across, as a window or a ceiling light is from a desk."""

SKY_BLUR = (0.022, 0.05, 0.11, 0.13)
"""The same for light from all sides."""

SKY_KEEPS = (0.78, 0.7, 0.48, 0.2)
"""How much of the sky a surface at each height keeps from the table below it."""

MARGIN = 0.22
"""Room for the blur around the character, as a share of its height."""


class Shadow:
    """The map of one character's shadow, and its drawing onto the table.

    Parameters
    ----------
    context, programs
        Where to draw.
    """

    def __init__(self, context: moderngl.Context, programs: Programs) -> None:
        self._context = context
        self._programs = programs
        self._maps = [context.texture((2 * SIDE, SIDE), 4) for _ in range(2)]
        for texture in self._maps:
            texture.repeat_x = texture.repeat_y = False
        self._targets = [context.framebuffer([texture]) for texture in self._maps]
        self._screen = context.vertex_array(programs.blur, [])
        self._keep = context.vertex_array(programs.keep, [])
        self._table = context.vertex_array(programs.shadow, [])
        self._area, self._reach = np.zeros(4), np.zeros(4)

    def cast(
        self, character: SkinnedCharacter, enclosing: Array, height: float, key_share: Array
    ) -> Array:
        """Make the map of a character that was just posed.

        Parameters
        ----------
        character
            Its skinned vertices are read.
        enclosing
            Points of the table frame around it, (n, 3).
        height
            Of the character on the table [m].
        key_share
            Share of the key light in what reaches the table, (3,).

        Returns
        -------
        NDArray
            Corners of the rectangle on the table that the shadow may reach, (4, 3).
        """
        self._reach = _reach(enclosing, height)
        self._area = area = _area(self._reach, height)
        caster, context = self._programs.caster, self._context
        assign(caster, area=area, slope=SLOPE, levels=LEVELS)
        for target in reversed(self._targets):
            target.use()
            target.viewport = (0, 0, 2 * SIDE, SIDE)
            target.clear()
        # What faces away from the light is kept: it is nearest to the table, and soles touch it.
        context.enable_only(moderngl.BLEND | moderngl.CULL_FACE)
        context.front_face = "ccw"
        context.blend_equation = moderngl.MAX, moderngl.MAX
        context.blend_func = moderngl.ONE, moderngl.ONE
        for first, count, double_sided in character.coarse_runs:
            (context.disable if double_sided else context.enable)(moderngl.CULL_FACE)
            character.caster.render(vertices=count, first=first, instances=2)
        context.blend_equation = moderngl.FUNC_ADD, moderngl.FUNC_ADD
        context.enable_only(moderngl.NOTHING)
        self._soften(height)
        self._weigh(key_share)
        x, z = self._reach[[0, 2, 2, 0]], self._reach[[1, 1, 3, 3]]
        return np.stack([x, np.zeros(4), z], axis=1)

    def _soften(self, height: float) -> None:
        """Blur the map where there may be a shadow: along x, then along z."""
        blur = self._programs.blur
        texels = SIDE / self._area[2] * height
        assign(blur, side=SIDE)
        x, z, width, depth = self._used()
        halves = [
            (half, _gaussians(texels * np.array(deviations)))
            for half, deviations in ((0, KEY_BLUR), (SIDE, SKY_BLUR))
        ]
        for source, target, direction in ((0, 1, (1, 0)), (1, 0, (0, 1))):
            self._targets[target].use()
            self._maps[source].use(0)
            assign(blur, direction=direction)
            for half, weights in halves:
                self._targets[target].viewport = (x + half, z, width, depth)
                assign(blur, weights=weights, left=half)
                self._screen.render(moderngl.TRIANGLES, vertices=3)

    def _weigh(self, key_share: Array) -> None:
        """Put into one map what is left of the light: it has fewer texels than the table pixels."""
        assign(self._programs.keep, side=SIDE, key=key_share, sky_keeps=SKY_KEEPS)
        self._targets[1].use()
        x, z, width, depth = self._used()
        # One texel more on each side: the table reads between texels.
        self._targets[1].viewport = (x - 1, z - 1, width + 2, depth + 2)
        self._maps[0].use(0)
        self._keep.render(moderngl.TRIANGLES, vertices=3)

    def _used(self) -> tuple[int, int, int, int]:
        """Return the texels of a half where there may be a shadow: first x and z, and how many."""
        area = self._area
        x, z = np.floor((self._reach[:2] - area[:2]) / area[2] * SIDE).astype(int).tolist()
        right, far = np.ceil((self._reach[2:] - area[:2]) / area[2] * SIDE).astype(int).tolist()
        return x, z, right - x, far - z

    def draw(self, clip_from_table: Array, outlines: Outlines) -> None:
        """Darken the table in the framebuffer in use, but where `outlines` of cubes hide it."""
        program = self._programs.shadow
        assign(program, clip_from_table=clip_from_table, area=self._area, reach=self._reach)
        assign(program, cubes=outlines.count, longest=outlines.longest)
        assign(program, outlines=outlines.sides)
        self._maps[1].use(0)
        self._table.render(moderngl.TRIANGLE_STRIP, vertices=4)

    def release(self) -> None:
        """Give the card's memory back; a second call does nothing."""
        self._screen.release()
        self._keep.release()
        self._table.release()
        for target, texture in zip(self._targets, self._maps, strict=True):
            target.release()
            texture.release()


def _reach(enclosing: Array, height: float) -> Array:
    """Return lowest x and z, highest x and z that a character's shadows may reach [m]."""
    feet = enclosing[:, [0, 2]]
    fallen = feet - SLOPE * np.maximum(enclosing[:, 1:2], 0.0)
    low = np.minimum(feet.min(axis=0), fallen.min(axis=0)) - MARGIN * height
    high = np.maximum(feet.max(axis=0), fallen.max(axis=0)) + MARGIN * height
    return np.concatenate([low, high])


def _area(reach: Array, height: float) -> Array:
    """Return origin x, z and side of the square that the map covers, and the character's height.

    The side grows in steps and the origin moves by whole texels, so that edges do not crawl.
    """
    low, high = reach[:2], reach[2:]
    step = height / 8
    side = (np.ceil((high - low).max() / step) + 1) * step
    texel = side / SIDE
    origin = np.floor((low + high - side) / 2 / texel) * texel
    return np.array([*origin, side, height])


def _gaussians(deviations: Array) -> Array:
    """Return one half of four normalised kernels, (taps, 4)."""
    taps = np.arange(TAPS)[:, None]
    kernels = np.exp(-0.5 * (taps / np.maximum(deviations, 0.3)) ** 2)
    kernels /= kernels[0] + 2.0 * kernels[1:].sum(axis=0)
    return np.asarray(kernels)
