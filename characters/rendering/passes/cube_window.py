"""The inside of an open cube: a room with a character in it, seen through holes in its walls."""

from dataclasses import replace

import moderngl
import numpy as np

from cubeling.characters.rendering.camera_picture.occlusion import UNIT_CUBE, camera_from_unit_cube
from cubeling.characters.rendering.geometry.character_cache import CharacterInstance
from cubeling.characters.rendering.passes.render_pass import RenderPass
from cubeling.characters.rendering.passes.shadows import ShadowMap, key_share
from cubeling.characters.rendering.programs import ShaderPrograms, set_uniforms
from cubeling.characters.rendering.resources import CharacterLayer, FrameResources
from cubeling.characters.rendering.scene import Box
from cubeling.characters.skeleton.pose import Array

OPEN_COSINES = (0.02, 0.25)
"""Cosines of a wall's angle to the camera from which on light comes in through it, and all of it:
the holes are in the walls that look at the camera, so the light changes smoothly as the cube
turns."""

GL_CLIP_DISTANCE0 = 0x3000
"""OpenGL's switch of the first of six clip distances."""

MIN_SLOPE = 0.35
"""Least height of the direction to the light above the inner floor, for the shadow on it."""

_NORMALS = np.repeat(
    [sign * np.roll([0.0, 0.0, 1.0], axis) for axis in range(3) for sign in (1, -1)], 6, axis=0
)
_OUTWARD = np.array([sign * np.eye(3)[axis] for axis in range(3) for sign in (1, -1)])


class CubeWindowPass(RenderPass):
    """Draws open cubes on the character layer: the depth of their rims, and the rooms inside."""

    def __init__(self, context: moderngl.Context, programs: ShaderPrograms) -> None:
        self._context, self._programs = context, programs
        vertices = np.hstack([UNIT_CUBE, _NORMALS]).astype("f4")
        corners = context.buffer(vertices)
        content = [(corners, "3f 3f", "position", "normal")]
        self._empty, self._lived_in = (
            context.vertex_array(programs.load("cube_window", "cube_window", *defines), content)
            for defines in ((), ("SHADOW",))
        )
        self.owned = (self._empty, self._lived_in, corners)
        self._shadow: ShadowMap | None = None
        self._resident: tuple[CharacterInstance, Array] | None = None

    def prepare(self, frame: FrameResources) -> None:
        """Render the shadow of the character inside."""
        inside = (each for each in frame.characters if each.inside is not None)
        resident = next(inside, None)
        self._resident = None
        if resident is not None and resident.inside is not None and resident.inside.is_open:
            self._resident = resident, self._render_shadow(frame, resident)

    def draw_layer(self, frame: FrameResources, layer: CharacterLayer) -> None:
        """Draw the open cubes."""
        boxes = tuple(box for box in layer.cubes if box.is_open)
        if not boxes:
            return
        layer.use()
        # Blending keeps nothing: a nearer cube hides a farther one, also with its rim.
        self._context.enable_only(moderngl.DEPTH_TEST)
        for box in boxes:
            array = self._empty
            if self._resident is not None and self._resident[0].inside is box:
                array = self._lived_in
                self._set_shadow(frame, array.program, *self._resident)
            set_uniforms(
                array.program,
                clip_from_cube=layer.clip_from_camera @ camera_from_unit_cube(box),
                opening=box.opening,
                **_uniforms_inside(frame, box),
                key=frame.light.key,
                sky=frame.light.sky,
            )
            array.render(moderngl.TRIANGLES)

    def release(self) -> None:
        """Release the shadow map too; a second call does nothing."""
        super().release()
        if self._shadow is not None:
            self._shadow.release()
            self._shadow = None

    def _render_shadow(self, frame: FrameResources, resident: CharacterInstance) -> Array:
        """Render the shadow map of a character; return its floor's frame, (4, 4) [m]."""
        if self._shadow is None:
            self._shadow = ShadowMap(self._context, self._programs)
        floor_from_table = np.asarray(np.linalg.inv(_unscale(resident.place)), float)
        turn = floor_from_table[:3, :3]
        to_light = turn @ frame.light.to_light
        to_light[1] = max(to_light[1], MIN_SLOPE)
        light = replace(frame.light, to_light=to_light / np.linalg.norm(to_light))
        caster = replace(resident, enclosing=resident.enclosing @ turn.T + floor_from_table[:3, 3])
        self._shadow.render(caster, light, key_share(light), floor_from_table)
        return floor_from_table

    def _set_shadow(
        self,
        frame: FrameResources,
        program: moderngl.Program,
        resident: CharacterInstance,
        floor_from_table: Array,
    ) -> None:
        box, shadow = resident.inside, self._shadow
        assert box is not None
        assert shadow is not None
        table_from_cube = np.linalg.inv(frame.camera_from_table) @ camera_from_unit_cube(box)
        shadow.texture().use(0)
        set_uniforms(
            program,
            factors=0,
            floor_from_cube=floor_from_table @ table_from_cube,
            area=shadow.area,
            extent=shadow.extent,
            edge=box.edge,
        )


def set_clipping(context: moderngl.Context, is_on: bool) -> None:
    """Cut off what a character inside a cube has outside of it, or nothing."""
    for number in range(6):
        (context.enable_direct if is_on else context.disable_direct)(GL_CLIP_DISTANCE0 + number)


def _uniforms_inside(frame: FrameResources, box: Box) -> dict[str, Array]:
    """Return where camera, light and up are from a cube whose edge is 1 long."""
    turn = np.asarray(box.camera_from_box[:3, :3]).T
    eye = -turn @ box.camera_from_box[:3, 3] / box.edge
    table = turn @ frame.camera_from_table[:3, :3]
    sights = eye - 0.5 * _OUTWARD
    cosines = (sights * _OUTWARD).sum(axis=1) / np.maximum(np.linalg.norm(sights, axis=1), 1e-9)
    share = np.clip((cosines - OPEN_COSINES[0]) / (OPEN_COSINES[1] - OPEN_COSINES[0]), 0.0, 1.0)
    # A direction along a wall would divide by zero in the shader.
    to_light = table @ frame.light.to_light
    to_light = np.where(np.abs(to_light) < 1e-4, 1e-4, to_light)
    return {
        "eye": eye,
        "up": table[:, 1],
        "to_light": to_light,
        "open_faces": box.opening * share * share * (3.0 - 2.0 * share),
    }


def _unscale(place: Array) -> Array:
    """Return a placement without its scale, (4, 4) [m]."""
    rigid = np.array(place, float)
    rigid[:3, :3] /= np.linalg.norm(rigid[:3, :3], axis=0)
    return rigid
