"""The sum of the light on the characters, as the picture shows it."""

import moderngl

from cubeling.characters.rendering.deferred.buffers import buffer_triangle
from cubeling.characters.rendering.passes.render_pass import RenderPass
from cubeling.characters.rendering.programs import ShaderPrograms
from cubeling.characters.rendering.resources import CharacterLayer, FrameResources


class DeferredCompositePass(RenderPass):
    """Writes the light of each texel to the character layer."""

    def __init__(self, context: moderngl.Context, programs: ShaderPrograms) -> None:
        self._shown, self._linear = (
            buffer_triangle(context, programs, "deferred_composite", *names)
            for names in ((), ("LINEAR",))
        )
        self.owned = (self._shown, self._linear)

    def draw_layer(self, frame: FrameResources, layer: CharacterLayer) -> None:
        """Write all texels that show a character."""
        layer.use()
        self._draw(frame, layer, self._shown)

    def draw_light(self, frame: FrameResources, layer: CharacterLayer) -> None:
        """Write linear light, and 1, to the sum of the light buffer instead."""
        layer.use_sum().clear()
        self._draw(frame, layer, self._linear)

    def _draw(
        self, frame: FrameResources, layer: CharacterLayer, triangle: moderngl.VertexArray
    ) -> None:
        frame.context.enable_only(moderngl.NOTHING)
        layer.target.geometry.bind()
        layer.target.light.bind()
        triangle.render(moderngl.TRIANGLES, vertices=3)
