"""What is nearer or further than the camera's focus, blurred as its lens blurs."""

import moderngl

from cubeling.characters.rendering.deferred.buffers import BUFFER_UNITS, buffer_triangle
from cubeling.characters.rendering.passes.deferred.composite import DeferredCompositePass
from cubeling.characters.rendering.passes.render_pass import RenderPass
from cubeling.characters.rendering.programs import ShaderPrograms, set_uniforms
from cubeling.characters.rendering.resources import CharacterLayer, FrameResources
from cubeling.characters.rendering.scene import Focus

MIN_RADIUS_TEXELS = 1.0
"""A smaller circle of confusion is not seen: texels are half as large as pixels."""

MAX_RADIUS_TEXELS = 24.0
"""A larger one would show its single taps."""


class DepthOfFieldPass(RenderPass):
    """Gathers the light of each texel from its circle of confusion.

    Where there is something to blur, it takes the place of the composite, which leaves it the light
    linear and apart: what a blurred edge does not cover is what was drawn before, as the room in an
    open cube. Otherwise the composite draws. The pass releases it.
    """

    def __init__(
        self,
        context: moderngl.Context,
        programs: ShaderPrograms,
        composite: DeferredCompositePass,
    ) -> None:
        self._composite = composite
        self._triangle = buffer_triangle(context, programs, "depth_of_field")
        self.owned = (self._triangle, composite)

    def draw_layer(self, frame: FrameResources, layer: CharacterLayer) -> None:
        """Draw the characters, sharp in the focus alone."""
        focus = frame.scene.view.focus
        texels = layer.target.fineness * float(frame.camera_matrix[1, 1])
        widest = 0.0 if focus is None else texels * _widest(frame, focus)
        if focus is None or widest < MIN_RADIUS_TEXELS:
            self._composite.draw_layer(frame, layer)
            return
        self._composite.draw_light(frame, layer)
        framebuffer = layer.use()
        framebuffer.depth_mask = False
        framebuffer.use()  # the mask takes effect here
        frame.context.enable_only(moderngl.BLEND | moderngl.DEPTH_TEST)
        frame.context.blend_func = moderngl.ONE, moderngl.ONE_MINUS_SRC_ALPHA
        layer.target.light.sum.use(BUFFER_UNITS["light"])
        set_uniforms(
            self._triangle.program,
            half_aperture=0.5 * texels * focus.aperture,
            focus=(focus.nearest, focus.furthest),
            widest=min(widest, MAX_RADIUS_TEXELS),
            clip_depth=layer.clip_from_camera[2, 2:],
            last_texel=(layer.texels[0] - 1, layer.texels[1] - 1),
        )
        self._triangle.render(moderngl.TRIANGLES, vertices=3)
        framebuffer.depth_mask = True
        framebuffer.use()


def _widest(frame: FrameResources, focus: Focus) -> float:
    """Return the radius of the largest circle of confusion of all characters, as a tangent."""
    depths = (depth for character in frame.characters for depth in frame.depths_of(character))
    return max(map(focus.radius, depths), default=0.0)
