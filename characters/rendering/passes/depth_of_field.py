"""What is nearer or further than the camera's focus, blurred as its lens blurs."""

import moderngl

from characters.rendering.deferred_buffers import NORMAL_UNIT, POSITION_UNIT, SUM_UNIT
from characters.rendering.passes.deferred_composite import DeferredCompositePass
from characters.rendering.passes.render_pass import RenderPass
from characters.rendering.programs import ShaderPrograms, set_uniforms
from characters.rendering.projection import NEAR_M
from characters.rendering.resources import FrameResources, Region
from characters.rendering.scene import Focus

MIN_RADIUS_TEXELS = 1.0
"""A smaller circle of confusion is not seen: texels are half as large as pixels."""

MAX_RADIUS_TEXELS = 24.0
"""A larger one would show its single taps."""


class DepthOfFieldPass(RenderPass):
    """Gathers the light of each texel from its circle of confusion.

    It draws what the composite drew, which it asks to leave it linear and apart where there is
    something to blur.
    """

    def __init__(
        self,
        context: moderngl.Context,
        programs: ShaderPrograms,
        composite: DeferredCompositePass,
    ) -> None:
        self._composite = composite
        self._triangle = context.vertex_array(programs.load("full_screen", "depth_of_field"), [])
        self.owned = (self._triangle,)
        set_uniforms(
            self._triangle.program,
            normal_id=NORMAL_UNIT,
            position=POSITION_UNIT,
            light=SUM_UNIT,
        )

    def draw(self, frame: FrameResources, region: Region) -> None:
        """Draw the characters, sharp in the focus alone."""
        layer, focus = region.characters, frame.scene.view.focus
        if layer is None or focus is None:
            return
        texels = layer.target.fineness * float(frame.camera_matrix[1, 1])
        widest = texels * _widest(frame, focus)
        if widest < MIN_RADIUS_TEXELS:
            return
        self._composite.draw_light(frame, layer)
        layer.use()
        frame.context.enable_only(moderngl.NOTHING)
        layer.target.light.sum.use(SUM_UNIT)
        set_uniforms(
            self._triangle.program,
            half_aperture=0.5 * texels * focus.aperture,
            focus=(focus.nearest, focus.furthest),
            widest=min(widest, MAX_RADIUS_TEXELS),
            last_texel=(
                layer.target.fineness * layer.area.width - 1,
                layer.target.fineness * layer.area.height - 1,
            ),
        )
        self._triangle.render(moderngl.TRIANGLES, vertices=3)


def _widest(frame: FrameResources, focus: Focus) -> float:
    """Return the radius of the largest circle of confusion of all characters, as a tangent."""
    row = frame.camera_from_table[2]
    radii = [0.0]
    for character in frame.characters:
        depths = character.enclosing @ row[:3] + row[3]
        radii += [focus.radius(max(float(depth), NEAR_M)) for depth in (depths.min(), depths.max())]
    return max(radii)
