"""The hand that holds the cube, in front of the characters behind it."""

import moderngl
import numpy as np

from cubeling.characters.rendering.camera_picture.hand_cover import PictureCover
from cubeling.characters.rendering.passes.render_pass import RenderPass
from cubeling.characters.rendering.programs import ShaderPrograms, set_uniforms
from cubeling.characters.rendering.projection import NEAR_M
from cubeling.characters.rendering.resources import FrameResources
from cubeling.characters.rendering.share_texture import ShareTexture
from cubeling.characters.skeleton.pose import Array

COVER_UNIT = 7
"""Texture unit of the cover."""

HAND_DEPTH_M = 0.05
"""Depth of a hand in front of the cube that it holds: what is nearer still stands before it."""

MIN_SLOPE = 0.35
"""Cosine of the angle between the camera's axis and the table, below which the camera looks down on
a hand and a character: the higher one is in front. Above, it is the one that stands nearer."""


class HandOcclusionPass(RenderPass):
    """Takes from the character layer what the hand covers, with a soft edge."""

    def __init__(self, context: moderngl.Context, programs: ShaderPrograms) -> None:
        self._program = programs.load("cover", "cover")
        self._rectangle = context.vertex_array(self._program, [])
        self._texture = ShareTexture(context)
        self.owned = (self._rectangle, self._texture)

    def composite(self, frame: FrameResources, cover: PictureCover | None) -> None:
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
        to_clip = layer.clip_from_camera
        ray_from_clip = np.linalg.inv(to_clip[[0, 1, 3], :3])
        front = _front(frame.camera_from_table[:3, 1], cover.behind)
        depth = to_clip[2, 3] * front @ ray_from_clip
        depth[2] += to_clip[2, 2]
        self._texture.write(cover.share_in(shared)).use(COVER_UNIT)
        set_uniforms(
            self._program,
            cover=COVER_UNIT,
            cover_corner=(left, top),
            cover_size=(shared.width, shared.height),
            clip_area=[2.0 * end / side - 1.0 for end, side in zip(ends, size, strict=True)],
            depth=depth,
            fineness=float(layer.target.fineness),
        )
        framebuffer.depth_mask = False
        framebuffer.use()  # the mask takes effect here
        frame.context.enable_only(moderngl.DEPTH_TEST | moderngl.BLEND)
        frame.context.blend_func = moderngl.ZERO, moderngl.ONE_MINUS_SRC_ALPHA
        self._rectangle.render(moderngl.TRIANGLE_STRIP, vertices=4)
        framebuffer.depth_mask = True
        framebuffer.use()


def _front(up: Array, behind: Array) -> Array:
    """Return the plane in front of a hand, (3,) [1/m]: a point is on it if its product is 1.

    It is upright, so that all of a character that stands is on one side of it. `up` is the
    normal of the table, and `behind` a point behind the hand, (3,) [m] in the camera's frame.
    """
    axis = np.array([0.0, 0.0, 1.0])
    away = axis - up[2] * up
    slope = float(np.linalg.norm(away))
    away = axis if slope < MIN_SLOPE else away / slope
    return np.asarray(away / max(float(away @ behind) - HAND_DEPTH_M, NEAR_M))
