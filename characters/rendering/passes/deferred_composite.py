"""The sum of the light on the characters, as the picture shows it."""

import moderngl

from characters.rendering.deferred_buffers import (
    AMBIENT_UNIT,
    DIFFUSE_UNIT,
    NORMAL_UNIT,
    SPECULAR_UNIT,
)
from characters.rendering.passes.render_pass import RenderPass
from characters.rendering.programs import ShaderPrograms, set_uniforms
from characters.rendering.resources import FrameResources, Region


class DeferredCompositePass(RenderPass):
    """Writes the light of each texel to the character layer."""

    def __init__(self, context: moderngl.Context, programs: ShaderPrograms) -> None:
        self._triangle = context.vertex_array(
            programs.load("full_screen", "deferred_composite"), []
        )
        self.owned = (self._triangle,)
        set_uniforms(
            self._triangle.program,
            normal_id=NORMAL_UNIT,
            diffuse=DIFFUSE_UNIT,
            specular=SPECULAR_UNIT,
            ambient=AMBIENT_UNIT,
        )

    def draw(self, frame: FrameResources, region: Region) -> None:
        """Write all texels that show a character."""
        layer = region.characters
        if layer is None:
            return
        layer.use()
        frame.context.enable_only(moderngl.NOTHING)
        layer.target.geometry.bind()
        layer.target.light.bind()
        self._triangle.render(moderngl.TRIANGLES, vertices=3)
