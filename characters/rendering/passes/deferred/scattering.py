"""Light that spreads below the skin of the characters before it leaves again."""

import moderngl
import numpy as np

from cubeling.characters.rendering.deferred.buffers import buffer_triangle
from cubeling.characters.rendering.passes.render_pass import RenderPass
from cubeling.characters.rendering.programs import ShaderPrograms, set_uniforms
from cubeling.characters.rendering.resources import CharacterLayer, FrameResources

LEVEL_RADII_M = (0.0023, 0.0053, 0.0103)
"""Radii of the levels in human skin [m]. A Wendland function of a radius of 3.8 standard deviations
spreads as a Gaussian does; these stand for the four wider ones of d'Eon and Luebke ("Advanced
techniques for realistic real-time skin rendering", GPU Gems 3, 2007), the first for two."""

LEVEL_SHARES = ((0.231, 0.205, 0.007), (0.358, 0.004, 0.0), (0.078, 0.0, 0.0))
"""Share of each level in red, green and blue light, from the same fit."""

UNSCATTERED = tuple(1.0 - sum(shares) for shares in zip(*LEVEL_SHARES, strict=True))
"""Share of the light that leaves where it enters: the two narrowest Gaussians of the fit."""

LEVEL_DEPTH = 0.6
"""Difference in depth at which a level ends, as a share of its radius."""

OPEN_LIMITS = (0.7, 0.9)
"""Open share of the light from all around below which all levels count, and above which none."""

MIN_REACH_TEXELS = 1.0
"""Levels that reach less far are not seen: the light is left as it is."""


class DeferredScatteringPass(RenderPass):
    """Scatters the diffuse light of skin; if `adaptive`, with fewer taps where skin is open.

    The adaptive form needs ambient occlusion, which is part of the ambient light.
    """

    def __init__(self, context: moderngl.Context, programs: ShaderPrograms, adaptive: bool) -> None:
        features = ("ADAPTIVE",) if adaptive else ()
        self._triangle = buffer_triangle(context, programs, "deferred_scattering", *features)
        self.owned = (self._triangle,)
        set_uniforms(
            self._triangle.program,
            level_radius=LEVEL_RADII_M,
            level_depth=LEVEL_DEPTH,
            unscattered=UNSCATTERED,
            level_share=np.array(LEVEL_SHARES),
            open_limits=OPEN_LIMITS,
        )

    def draw_layer(self, frame: FrameResources, layer: CharacterLayer) -> None:
        """Replace the diffuse light of skin by what is scattered."""
        if self._reach(frame) * layer.target.fineness < MIN_REACH_TEXELS:
            return
        layer.use_scattered()
        frame.context.enable_only(moderngl.NOTHING)
        target = layer.target
        target.geometry.bind()
        target.light.bind()
        set_uniforms(
            self._triangle.program,
            focal=float(target.fineness * frame.camera_matrix[1, 1]),
        )
        self._triangle.render(moderngl.TRIANGLES, vertices=3)
        target.light.is_scattered = True

    def _reach(self, frame: FrameResources) -> float:
        """Return how far light spreads in the skin that is nearest to the camera [px]."""
        reaches = [0.0]
        for character in frame.characters:
            nearest, _ = frame.depths_of(character)
            scattering = max(each.material.scattering for each in character.skinned.surfaces)
            scale = character.height / character.skinned.geometry.height
            reaches.append(scale * scattering * LEVEL_RADII_M[-1] / nearest)
        return max(reaches) * float(frame.camera_matrix[1, 1])
