"""The light on what is seen, once for each texel, whatever the number of triangles."""

from functools import partial

import moderngl
import numpy as np

from cubeling.characters.rendering.deferred.buffers import (
    BUFFER_UNITS,
    MAX_SURFACES,
    buffer_triangle,
    surface_records,
)
from cubeling.characters.rendering.environment.room import ROOM_UNIT
from cubeling.characters.rendering.geometry.surfaces import MIRRORED, ROOM
from cubeling.characters.rendering.passes.deferred.occlusion import DeferredOcclusionPass
from cubeling.characters.rendering.passes.deferred.visibility import DeferredVisibilityPass
from cubeling.characters.rendering.passes.render_pass import RenderPass
from cubeling.characters.rendering.programs import ShaderPrograms, set_uniforms
from cubeling.characters.rendering.resources import CharacterLayer, FrameResources


class DeferredLightingPass(RenderPass):
    """Lights the geometry buffer (pass 2 of deferred shading): diffuse, specular and ambient.

    `visibility` says how much of the lamp's light arrives; None: all of it. `occlusion` says it of
    the light from all around; None: all of it, but less near the table. `scattering` says that a
    later pass spreads the light on skin.
    """

    def __init__(
        self,
        context: moderngl.Context,
        programs: ShaderPrograms,
        visibility: DeferredVisibilityPass | None,
        occlusion: DeferredOcclusionPass | None,
        scattering: bool,
    ) -> None:
        self._visibility, self._occlusion = visibility, occlusion
        features = [*["VISIBILITY"] * bool(visibility), *["OCCLUDED"] * bool(occlusion)]
        features += ["SCATTERED"] * scattering
        self._triangles: dict[tuple[str, ...], moderngl.VertexArray] = {}
        self._make = partial(buffer_triangle, context, programs, "deferred_lighting", *features)
        self._records = context.texture((2, MAX_SURFACES), 4, dtype="f4")
        self._records.filter = moderngl.NEAREST, moderngl.NEAREST
        self.owned = (self._records,)

    def draw_layer(self, frame: FrameResources, layer: CharacterLayer) -> None:
        """Light every texel that the geometry pass has covered."""
        records = surface_records(frame.characters)[:MAX_SURFACES].astype("f4")
        self._records.write(np.ascontiguousarray(records), viewport=(0, 0, 2, len(records)))
        light, rotation, room = frame.light, frame.camera_from_table[:3, :3], frame.room
        lit: tuple[str, ...] = ()
        if room is not None:
            lit = (ROOM,) if room.texture is None else (ROOM, MIRRORED)
        if lit not in self._triangles:
            self._triangles[lit] = self._make(*lit)
        triangle = self._triangles[lit]
        if room is not None:
            room.use()
            set_uniforms(
                triangle.program,
                table_from_camera=np.asarray(np.linalg.inv(frame.camera_from_table), float),
                room_map=ROOM_UNIT,
                **room.uniforms(light),
            )
        set_uniforms(
            triangle.program,
            to_light=rotation @ light.to_light,
            key=light.key,
            sky=light.sky,
            ground=light.ground,
            up=rotation[:, 1],
            table=frame.camera_from_table[:3, 3],
        )
        if self._visibility is not None:
            self._visibility.set_uniforms(triangle.program)
        if self._occlusion is not None:
            self._occlusion.bind()
        layer.use_light().clear()
        layer.target.light.is_scattered = False
        frame.context.enable_only(moderngl.NOTHING)
        layer.target.geometry.bind()
        self._records.use(BUFFER_UNITS["surfaces"])
        triangle.render(moderngl.TRIANGLES, vertices=3)

    def release(self) -> None:
        """Release the triangles too."""
        super().release()
        for triangle in self._triangles.values():
            triangle.release()
