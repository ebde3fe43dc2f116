"""The supersampled character layer, filtered down onto the picture."""

import math

import moderngl
import numpy as np

from characters.rendering.passes.render_pass import RenderPass
from characters.rendering.programs import ShaderPrograms, set_uniforms
from characters.rendering.resources import FrameResources, Region
from characters.rendering.scene import Softness

OWN_BLUR_PX = 0.35
"""Standard deviation of the blur of what is drawn: a pixel is the mean of four texels."""

MAX_SPREAD_PX = 1.5
"""More blur would show as a fourfold picture."""

GRAIN_SIDE, GRAIN_RANGE, GRAIN_SEED = 128, 6.0, 1
"""Texels along a side of the noise, a power of two; and the standard deviations that its 8 bits
span."""

GRAIN_STEP = np.array([53, 97])
"""Shift of the noise from picture to picture [px], so that it does not stand still."""


class ResolvePass(RenderPass):
    """Blends the character layer over the picture, as soft and as noisy as the picture is."""

    def __init__(self, context: moderngl.Context, programs: ShaderPrograms) -> None:
        self._sharp, self._soft, self._grainy = (
            context.vertex_array(programs.load("full_screen", "resolve", *defines), [])
            for defines in ((), ("SOFT",), ("GRAIN", "SOFT"))
        )
        grain = np.random.default_rng(GRAIN_SEED).standard_normal((GRAIN_SIDE, GRAIN_SIDE, 4))
        levels = np.clip(255 * (0.5 + grain / GRAIN_RANGE), 0, 255).round().astype(np.uint8)
        self._grain = context.texture((GRAIN_SIDE, GRAIN_SIDE), 4, levels.tobytes())
        self.owned = (self._sharp, self._soft, self._grainy, self._grain)
        self._pictures = 0

    def draw(self, frame: FrameResources, region: Region) -> None:
        """Blend the characters over the picture."""
        layer = region.characters
        if layer is None:
            return
        softness = frame.softness
        triangle = self._sharp
        if softness is not None:
            triangle = self._grainy if softness.noise > 0.0 else self._soft
        corner = layer.area.x - region.area.x, layer.area.y - region.area.y
        region.target.use((*corner, layer.area.width, layer.area.height))
        frame.context.enable_only(moderngl.BLEND)
        frame.context.blend_func = moderngl.ONE, moderngl.ONE_MINUS_SRC_ALPHA
        set_uniforms(triangle.program, corner=corner, fineness=float(layer.target.fineness))
        if softness is not None:
            self._soften(triangle.program, softness, frame)
        layer.target.characters_texture.use(0)
        triangle.render(moderngl.TRIANGLES, vertices=3)

    def _soften(self, program: moderngl.Program, softness: Softness, frame: FrameResources) -> None:
        """Set the uniforms for blur and noise."""
        self._pictures += 1
        shift = (self._pictures * GRAIN_STEP) % GRAIN_SIDE
        blur = softness.blur * frame.scale
        spread = math.sqrt(max(blur**2 - OWN_BLUR_PX**2, 0.0))
        self._grain.use(1)
        set_uniforms(
            program,
            spread=min(spread, MAX_SPREAD_PX),
            grain=1,
            shift=tuple(shift.tolist()),
            noise=GRAIN_RANGE * softness.noise / 255.0,
        )
