"""How much of the light from all around reaches each texel of the characters."""

import moderngl

from characters.rendering.deferred.ambient_occlusion import NOTHING_M, AmbientOcclusion
from characters.rendering.deferred.buffers import BUFFER_UNITS, GrowingBuffer, HiddenBuffer
from characters.rendering.geometry.surfaces import BEHIND
from characters.rendering.passes.characters import CharacterPass
from characters.rendering.programs import ShaderPrograms
from characters.rendering.resources import CharacterLayer, FrameResources

KNOWN_UNIT = 5
"""Texture unit of what is in front, after those of materials (see `TEXTURE_UNITS`)."""


class DeferredOcclusionPass(CharacterPass):
    """Finds what characters and the table hide of the light from all around, for the lighting.

    It draws the characters twice more, to know where what is seen ends, and what is behind it: an
    arm before a leg hides no more than it is thick.
    """

    def __init__(self, context: moderngl.Context, programs: ShaderPrograms) -> None:
        self._context = context
        self._occlusion = AmbientOcclusion(context, programs)
        self._hidden = GrowingBuffer(context, HiddenBuffer)
        self.owned = (self._occlusion, self._hidden)

    def draw_layer(self, frame: FrameResources, layer: CharacterLayer) -> None:
        """Find the open share of each texel, and bind it for the lighting."""
        hidden = self._hidden.at_least(layer.target.geometry.position.size)
        self._draw_hidden(frame, layer, hidden)
        fineness, geometry = layer.target.fineness, layer.target.geometry
        self._context.enable_only(moderngl.NOTHING)
        self._open = self._occlusion.draw(
            geometry.normal_id,
            geometry.position,
            (fineness * layer.area.width, fineness * layer.area.height),
            fineness * float(frame.camera_matrix[1, 1]),
            frame.table_plane,
            hidden.behind,
        )

    def bind(self) -> None:
        """Bind what was found to the unit of the lighting."""
        self._open.use(BUFFER_UNITS["occlusion"])

    def _draw_hidden(
        self, frame: FrameResources, layer: CharacterLayer, hidden: HiddenBuffer
    ) -> None:
        """Draw where what is seen ends, then what is behind that."""
        context, fineness = self._context, layer.target.fineness
        hidden.target.use()
        hidden.target.clear(NOTHING_M, NOTHING_M, NOTHING_M, NOTHING_M)
        size = fineness * layer.area.width, fineness * layer.area.height
        hidden.target.viewport = (0, 0, *size)
        context.blend_equation = moderngl.MIN, moderngl.MIN
        for is_next in (False, True):
            known = layer.target.geometry.position
            if is_next:
                known = hidden.copy()
            known.use(KNOWN_UNIT)
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
