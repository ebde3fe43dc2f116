"""The supersampled character layer, filtered down onto the picture."""

import moderngl

from characters.rendering.passes.render_pass import RenderPass
from characters.rendering.programs import ShaderPrograms, set_uniforms
from characters.rendering.resources import FrameResources, Region


class ResolvePass(RenderPass):
    """Blends the character layer over the picture."""

    def __init__(self, context: moderngl.Context, programs: ShaderPrograms) -> None:
        self._program = programs.load("full_screen", "resolve")
        self._triangle = context.vertex_array(self._program, [])
        self.owned = (self._triangle,)

    def draw(self, frame: FrameResources, region: Region) -> None:
        """Blend the characters over the picture."""
        layer = region.characters
        if layer is None:
            return
        corner = layer.area.x - region.area.x, layer.area.y - region.area.y
        region.target.use_picture((*corner, layer.area.width, layer.area.height))
        frame.context.enable_only(moderngl.BLEND)
        frame.context.blend_func = moderngl.ONE, moderngl.ONE_MINUS_SRC_ALPHA
        set_uniforms(self._program, corner=corner)
        layer.target.characters_texture.use(0)
        self._triangle.render(moderngl.TRIANGLES, vertices=3)
