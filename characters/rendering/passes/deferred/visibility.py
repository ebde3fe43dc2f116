"""How much of the lamp, and of the light from all around, each pixel of the characters sees."""

import moderngl
import numpy as np

from characters.rendering.deferred.ambient_occlusion import AmbientOcclusion
from characters.rendering.deferred.blocker_map import CHARACTER_RANGE_TEXELS, BlockerMap
from characters.rendering.deferred.buffers import BUFFER_UNITS, PixelBuffer, buffer_triangle
from characters.rendering.passes.render_pass import RenderPass
from characters.rendering.programs import ShaderPrograms, set_uniforms
from characters.rendering.projection import grown_size
from characters.rendering.resources import CharacterLayer, FrameResources

DEPTH_TOLERANCE_M = 0.01
"""Difference in depth at which a pixel's value does not count for another [m]."""


class DeferredVisibilityPass(RenderPass):
    """Finds the share of the light that reaches each pixel, by colour for the lamp.

    It is found once for each pixel of the picture, as it changes slowly; the lighting takes it from
    there for each texel of the character layer. Characters and the table hide light.

    Parameters
    ----------
    blockers
        What hides the lamp, which the pass for the shadows has drawn; None if nothing does.
    occlusion
        What hides the light from all around; None if nothing does. The pass releases it.
    """

    def __init__(
        self,
        context: moderngl.Context,
        programs: ShaderPrograms,
        blockers: BlockerMap | None,
        occlusion: AmbientOcclusion | None,
    ) -> None:
        self._context = context
        self.is_occluded = occlusion is not None
        """Whether some of the light from all around is hidden."""
        self._blockers, self._occlusion = blockers, occlusion
        names = [*["SHADOWED"] * bool(blockers), *["OCCLUDED"] * bool(occlusion)]
        self._reduce, self._find, self._smooth = (
            buffer_triangle(context, programs, fragment, *defines)
            for fragment, defines in (
                ("pixel_geometry", ()),
                ("pixel_visibility", names),
                ("pixel_visibility_mean", ()),
            )
        )
        self._pixels: PixelBuffer | None = None
        arrays = (self._reduce, self._find, self._smooth)
        self.owned = arrays if occlusion is None else (*arrays, occlusion)
        set_uniforms(self._smooth.program, depth_tolerance=DEPTH_TOLERANCE_M)

    def draw_layer(self, frame: FrameResources, layer: CharacterLayer) -> None:
        """Find the visible light in each pixel of the characters."""
        pixels = self._pixels_of(layer)
        size = layer.area.width, layer.area.height
        self._context.enable_only(moderngl.NOTHING)
        self._reduce_geometry(frame, layer, pixels)
        if self._occlusion is not None:
            focal = float(frame.camera_matrix[1, 1])
            found = self._occlusion.draw(
                pixels.normal_id, pixels.position, size, focal, frame.table_plane
            )
            found.use(BUFFER_UNITS["occlusion"])
        pixels.bind()
        if self._blockers is not None:
            table_from_camera = np.asarray(np.linalg.inv(frame.camera_from_table), float)
            self._blockers.set_uniforms(
                self._find.program, table_from_camera, CHARACTER_RANGE_TEXELS
            )
        pixels.use_visibility(0, size)
        self._find.render(moderngl.TRIANGLES, vertices=3)
        pixels.use_visibility(1, size)
        pixels.visibility[0].use(BUFFER_UNITS["visibility"])
        set_uniforms(self._smooth.program, last_pixel=(size[0] - 1, size[1] - 1))
        self._smooth.render(moderngl.TRIANGLES, vertices=3)

    def set_uniforms(self, program: moderngl.Program, layer: CharacterLayer) -> None:
        """Bind what was found, and set the uniforms of a program that asks for it in a layer."""
        pixels = self._pixels_of(layer)
        pixels.visibility[1].use(BUFFER_UNITS["visibility"])
        pixels.position.use(BUFFER_UNITS["pixel_position"])
        set_uniforms(
            program,
            fineness=layer.target.fineness,
            last_pixel=(layer.area.width - 1, layer.area.height - 1),
            depth_tolerance=DEPTH_TOLERANCE_M,
        )

    def release(self) -> None:
        """Release the buffer of pixels too; a second call does nothing."""
        super().release()
        if self._pixels is not None:
            self._pixels.release()

    def _reduce_geometry(
        self, frame: FrameResources, layer: CharacterLayer, pixels: PixelBuffer
    ) -> None:
        """Take one texel for each pixel, and the table where there is no character."""
        pixels.framebuffer.use()
        pixels.framebuffer.viewport = (0, 0, layer.area.width, layer.area.height)
        layer.target.geometry.bind()
        matrix = frame.camera_matrix.copy()
        matrix[:2, 2] += 0.5 - np.array([layer.area.x, layer.area.y])
        set_uniforms(
            self._reduce.program,
            fineness=layer.target.fineness,
            ray_from_pixel=np.asarray(np.linalg.inv(matrix), float).T,
            plane=frame.table_plane,
        )
        self._reduce.render(moderngl.TRIANGLES, vertices=3)

    def _pixels_of(self, layer: CharacterLayer) -> PixelBuffer:
        """Return the buffer for the pixels of a layer; it grows, and never shrinks."""
        kept = self._pixels
        size = grown_size(None if kept is None else kept.position.size, layer.target.size)
        if size is not None:
            if kept is not None:
                self._context.detect_framebuffer(0).use()
                kept.release()
            self._pixels = kept = PixelBuffer(self._context, size)
        assert kept is not None
        return kept
