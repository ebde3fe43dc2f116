"""How much of the lamp what is seen of the characters sees."""

import moderngl
import numpy as np

from cubeling.characters.rendering.deferred.blocker_map import CHARACTER_RANGE_TEXELS, BlockerMap
from cubeling.characters.rendering.deferred.buffers import (
    BUFFER_UNITS,
    GrowingBuffer,
    PixelBuffer,
    buffer_triangle,
)
from cubeling.characters.rendering.deferred.cells import cell_count, cell_uniforms
from cubeling.characters.rendering.passes.render_pass import RenderPass
from cubeling.characters.rendering.programs import ShaderPrograms, set_uniforms
from cubeling.characters.rendering.resources import CharacterLayer, FrameResources

PLANE_TOLERANCE_CELLS = 1.5
"""Distance from the plane of a triangle at which a cell's value does not count for it, in cells."""

TILE_CELLS = 4
"""Cells along each side of the tiles whose samples differ."""

MIN_CELL_M = 0.25e-3
"""Size of a cell on characters, at least, unless a pixel is larger [m]: the map of the blockers has
texels of about a millimetre, and rounds over several of them."""


class DeferredVisibilityPass(RenderPass):
    """Finds the share of the lamp's light that reaches each cell, by colour.

    It is found once for each pixel of the picture, or for larger cells close up, as it changes
    slowly; the lighting takes it from there for each texel of the character layer. `blockers` is
    what hides the lamp, which the pass for the shadows has drawn.
    """

    def __init__(
        self, context: moderngl.Context, programs: ShaderPrograms, blockers: BlockerMap
    ) -> None:
        self._context, self._blockers = context, blockers
        self._reduce, self._find, self._smooth = arrays = [
            buffer_triangle(context, programs, fragment)
            for fragment in ("pixel_geometry", "pixel_visibility", "pixel_visibility_mean")
        ]
        self._pixels = GrowingBuffer(context, PixelBuffer)
        self.found: PixelBuffer
        """What was found for the last layer, in its first cells."""
        self.size = 0, 0
        """How many cells across and down."""
        self.owned = (*arrays, self._pixels)

    def draw_layer(self, frame: FrameResources, layer: CharacterLayer) -> None:
        """Find the visible light in each cell of the characters."""
        fineness = layer.target.fineness
        stride = max(fineness, int(MIN_CELL_M * fineness / frame.pixel_m))
        self.size = size = cell_count(layer.texels, stride)
        self._cells = cell_uniforms(layer.texels, stride)
        self.found = pixels = self._pixels.at_least(size)
        self._context.enable_only(moderngl.NOTHING)
        pixels.framebuffer.use()
        pixels.framebuffer.viewport = (0, 0, *size)
        layer.target.geometry.bind()
        set_uniforms(self._reduce.program, **self._cells)
        self._reduce.render(moderngl.TRIANGLES, vertices=3)
        pixels.bind()
        table_from_camera = np.asarray(np.linalg.inv(frame.camera_from_table), float)
        self._blockers.set_uniforms(self._find.program, table_from_camera, CHARACTER_RANGE_TEXELS)
        cell_m = stride * frame.pixel_m / fineness
        self._cells["plane_tolerance"] = PLANE_TOLERANCE_CELLS * cell_m
        set_uniforms(self._find.program, tile_m=TILE_CELLS * cell_m)
        pixels.use_visibility(0, size)
        self._find.render(moderngl.TRIANGLES, vertices=3)
        pixels.use_visibility(1, size)
        pixels.visibility[0].use(BUFFER_UNITS["visibility"])
        set_uniforms(self._smooth.program, **self._cells)
        self._smooth.render(moderngl.TRIANGLES, vertices=3)

    def set_uniforms(self, program: moderngl.Program) -> None:
        """Bind what was found, and set the uniforms of a program that asks for it."""
        self.found.visibility[1].use(BUFFER_UNITS["visibility"])
        self.found.position.use(BUFFER_UNITS["pixel_position"])
        set_uniforms(program, **self._cells)
