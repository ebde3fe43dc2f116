"""The share of the light from all around that reaches the characters."""

import moderngl
import numpy as np

from characters.rendering.ambient_occlusion import AmbientOcclusion
from characters.rendering.deferred_buffers import (
    NORMAL_UNIT,
    OCCLUSION_UNIT,
    POSITION_UNIT,
    PixelGeometry,
)
from characters.rendering.passes.render_pass import RenderPass
from characters.rendering.programs import ShaderPrograms, set_uniforms
from characters.rendering.resources import CharacterLayer, FrameResources, Region

DEPTH_TOLERANCE_M = 0.01
"""Difference in depth at which a pixel's value does not count for a texel [m]."""


class DeferredOcclusionPass(RenderPass):
    """Finds the ambient occlusion of the characters, by themselves and by the table.

    It is found once for each pixel of the picture, as it changes slowly; passes that come later ask
    for it in each texel of the character layer.
    """

    def __init__(self, context: moderngl.Context, programs: ShaderPrograms) -> None:
        self._context = context
        self._reduce = context.vertex_array(programs.load("full_screen", "geometry_of_pixels"), [])
        set_uniforms(self._reduce.program, normal_id=NORMAL_UNIT, position=POSITION_UNIT)
        self._occlusion = AmbientOcclusion(context, programs)
        self._pixels: PixelGeometry | None = None
        self._found: moderngl.Texture | None = None
        self.owned = (self._reduce, self._occlusion)

    def draw(self, frame: FrameResources, region: Region) -> None:
        """Find the open share of each pixel of the characters."""
        layer = region.characters
        if layer is None:
            return
        size = layer.area.width, layer.area.height
        pixels = self._pixels_of(layer)
        pixels.framebuffer.use()
        pixels.framebuffer.viewport = (0, 0, *size)
        self._context.enable_only(moderngl.NOTHING)
        layer.target.geometry.bind()
        matrix = frame.camera_matrix.copy()
        matrix[:2, 2] += 0.5 - np.array([layer.area.x, layer.area.y])
        up, table = frame.camera_from_table[:3, 1], frame.camera_from_table[:3, 3]
        set_uniforms(
            self._reduce.program,
            fineness=layer.target.fineness,
            # Points of the table are at a distance along the ray of the pixel: a linear form.
            ray_from_pixel=np.asarray(np.linalg.inv(matrix), float).T,
            plane=up / (up @ table),
        )
        self._reduce.render(moderngl.TRIANGLES, vertices=3)
        focal = float(frame.camera_matrix[1, 1])
        self._found = self._occlusion.draw(pixels.normal_id, pixels.position, size, focal)

    def set_uniforms(self, program: moderngl.Program, layer: CharacterLayer) -> None:
        """Bind what was found, and set the uniforms of a program that asks for it in a layer."""
        assert self._found is not None
        self._found.use(OCCLUSION_UNIT)
        set_uniforms(
            program,
            occlusion=OCCLUSION_UNIT,
            fineness=layer.target.fineness,
            last_pixel=(layer.area.width - 1, layer.area.height - 1),
            depth_tolerance=DEPTH_TOLERANCE_M,
        )

    def release(self) -> None:
        """Release the geometry of pixels too; a second call does nothing."""
        super().release()
        if self._pixels is not None:
            self._pixels.release()

    def _pixels_of(self, layer: CharacterLayer) -> PixelGeometry:
        """Return textures for the pixels of a layer; they grow, and never shrink."""
        size = layer.target.picture_texture.size
        kept = self._pixels
        if kept is None or kept.position.width < size[0] or kept.position.height < size[1]:
            if kept is not None:
                size = max(size[0], kept.position.width), max(size[1], kept.position.height)
                self._context.detect_framebuffer(0).use()
                kept.release()
            self._pixels = kept = PixelGeometry(self._context, size)
        return kept
