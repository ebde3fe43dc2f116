"""How much of the light from all around reaches each texel of the characters."""

import math
from dataclasses import replace

import moderngl
import numpy as np

from cubeling.characters.rendering.deferred.ambient_occlusion import AmbientOcclusion
from cubeling.characters.rendering.deferred.buffers import (
    BUFFER_UNITS,
    DepthLayerBuffer,
    GrowingBuffer,
    buffer_triangle,
)
from cubeling.characters.rendering.deferred.cells import cell_count, cell_uniforms
from cubeling.characters.rendering.geometry.surfaces import BEHIND
from cubeling.characters.rendering.passes.characters import CharacterPass
from cubeling.characters.rendering.programs import ShaderPrograms, set_uniforms
from cubeling.characters.rendering.resources import CharacterLayer, FrameResources
from cubeling.characters.skeleton.pose import Array

KNOWN_UNIT = 5
"""Texture unit of what is in front, after those of materials (see `TEXTURE_UNITS`)."""

MAX_RADIUS_CELLS = 400.0
"""Cells that the radius of the occlusion covers at most. Close up, a cell is several texels: the
work does not grow, and occlusion that changes within a four-hundredth of the radius is rare."""


class DeferredOcclusionPass(CharacterPass):
    """Finds what characters and the table hide of the light from all around, for the lighting.

    It draws the characters twice more, to know where what is seen ends, and what is behind it: an
    arm before a leg hides no more than it is thick.
    """

    def __init__(self, context: moderngl.Context, programs: ShaderPrograms) -> None:
        self._context = context
        self._occlusion = AmbientOcclusion(context, programs)
        self._layers = GrowingBuffer(context, DepthLayerBuffer)
        self._first = buffer_triangle(context, programs, "depth_layers")
        self.owned = (self._occlusion, self._layers, self._first)

    def draw_layer(self, frame: FrameResources, layer: CharacterLayer) -> None:
        """Find the open share of each texel, and bind it for the lighting."""
        fineness, geometry = layer.target.fineness, layer.target.geometry
        radius_texels = self._occlusion.settings.radius_m * fineness / frame.pixel_m
        stride = math.ceil(radius_texels / MAX_RADIUS_CELLS)
        self._context.enable_only(moderngl.NOTHING)
        layers = self._draw_layers(frame, layer, stride)
        self._open = self._occlusion.draw(
            geometry.normal_id,
            geometry.position,
            layers.depths,
            layer.texels,
            fineness * float(frame.camera_matrix[1, 1]),
            frame.table_plane,
            stride,
        )

    def bind(self) -> None:
        """Bind what was found to the unit of the lighting."""
        self._open.use(BUFFER_UNITS["occlusion"])

    def _draw_layers(
        self, frame: FrameResources, layer: CharacterLayer, stride: int
    ) -> DepthLayerBuffer:
        """Draw where what is seen begins and ends, then what is behind that."""
        context, cells = self._context, cell_count(layer.texels, stride)
        layers = self._layers.at_least(cells)
        layers.target.use()
        layers.target.viewport = (0, 0, *cells)
        layer.target.geometry.bind()
        set_uniforms(self._first.program, **cell_uniforms(layer.texels, stride))
        self._first.render(moderngl.TRIANGLES, vertices=3)
        to_cells = cells_from_texels(layer.texels, stride)
        layer = replace(layer, clip_from_camera=to_cells @ layer.clip_from_camera)
        context.blend_equation = moderngl.MIN, moderngl.MIN
        for is_next in (False, True):
            layers.copy().use(KNOWN_UNIT)
            self._render(
                frame,
                layer,
                frozenset([BEHIND]),
                tests=moderngl.BLEND,
                camera_from_table=frame.camera_from_table,
                known=KNOWN_UNIT,
                is_next=is_next,
            )
        context.blend_equation = moderngl.FUNC_ADD, moderngl.FUNC_ADD
        return layers


def cells_from_texels(size: tuple[int, int], stride: int) -> Array:
    """Return what brings a projection to texels to one to cells, (4, 4).

    The middle of a cell is that of the texel in its middle.
    """
    scale = np.eye(4)
    for axis, (texels, cells) in enumerate(zip(size, cell_count(size, stride), strict=True)):
        middle = (texels / 2 - stride // 2 - 0.5) / stride + 0.5
        scale[axis, axis] = texels / (stride * cells)
        scale[axis, 3] = 2.0 * middle / cells - 1.0
    return scale
