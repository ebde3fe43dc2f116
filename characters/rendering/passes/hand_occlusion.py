"""The hand that holds the cube, in front of the characters behind it."""

import moderngl

from characters.rendering.passes.render_pass import RenderPass
from characters.rendering.programs import ShaderPrograms, set_uniforms
from characters.rendering.resources import FrameResources
from characters.rendering.scene import Cover
from characters.rendering.share_texture import ShareTexture

COVER_UNIT = 7
"""Texture unit of the cover."""

HAND_DEPTH_M = 0.05
"""Depth of a hand in front of the cube that it holds: what is nearer still stands before it."""


class HandOcclusionPass(RenderPass):
    """Takes from the character layer what the hand covers, with a soft edge."""

    def __init__(self, context: moderngl.Context, programs: ShaderPrograms) -> None:
        self._program = programs.load("cover", "cover")
        self._rectangle = context.vertex_array(self._program, [])
        self._texture = ShareTexture(context)
        self.owned = (self._rectangle, self._texture)

    def composite(self, frame: FrameResources, cover: Cover | None) -> None:
        """Clear the character layer behind the hand."""
        layer = frame.layer
        if layer is None or cover is None:
            return
        shared = cover.area.intersection(layer.area)
        if shared is None:
            return
        framebuffer = layer.use()
        left, top = shared.x - layer.area.x, shared.y - layer.area.y
        size = layer.area.width, layer.area.height, layer.area.width, layer.area.height
        ends = left, top, left + shared.width, top + shared.height
        clip = layer.clip_from_camera[2:] @ [0.0, 0.0, cover.distance - HAND_DEPTH_M, 1.0]
        self._texture.write(cover.share).use(COVER_UNIT)
        set_uniforms(
            self._program,
            cover=COVER_UNIT,
            cover_corner=(cover.area.x - layer.area.x, cover.area.y - layer.area.y),
            cover_size=(cover.area.width, cover.area.height),
            clip_area=[2.0 * end / side - 1.0 for end, side in zip(ends, size, strict=True)],
            depth=float(clip[0] / clip[1]),
            fineness=float(layer.target.fineness),
        )
        framebuffer.depth_mask = False
        framebuffer.use()  # the mask takes effect here
        frame.context.enable_only(moderngl.DEPTH_TEST | moderngl.BLEND)
        frame.context.blend_func = moderngl.ZERO, moderngl.ONE_MINUS_SRC_ALPHA
        self._rectangle.render(moderngl.TRIANGLE_STRIP, vertices=4)
        framebuffer.depth_mask = True
        framebuffer.use()
