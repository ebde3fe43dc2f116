"""The characters themselves, shaded, on their own layer."""

from collections.abc import Sequence

import moderngl

from cubeling.characters.rendering.camera_picture.occlusion import unit_cube_from_table
from cubeling.characters.rendering.geometry.surfaces import (
    CLIPPED,
    MIRRORED,
    ROOM,
    VERTEX_LIT,
)
from cubeling.characters.rendering.passes.cube_window import set_clipping
from cubeling.characters.rendering.passes.render_pass import RenderPass
from cubeling.characters.rendering.resources import CharacterLayer, FrameResources
from cubeling.characters.skeleton.pose import Array


class CharacterPass(RenderPass):
    """Draws the skinned characters on the character layer, whose depth hides what is covered."""

    def draw_layer(self, frame: FrameResources, layer: CharacterLayer) -> None:
        """Draw all characters, shaded, on the character layer."""
        layer.use()
        light, room, features = frame.light, frame.room, {VERTEX_LIT}
        if room is not None:
            room.use()
            features |= {ROOM} if room.texture is None else {ROOM, MIRRORED}
        uniforms = {} if room is None else room.uniforms(light)
        uniforms |= {"to_light": light.to_light, "key": light.key, "sky": light.sky}
        uniforms |= {"ground": light.ground, "eye": frame.camera_position}
        self._render(frame, layer, frozenset(features), moderngl.DEPTH_TEST, **uniforms)

    def _render(
        self,
        frame: FrameResources,
        layer: CharacterLayer,
        features: frozenset[str] = frozenset(),
        tests: int = moderngl.DEPTH_TEST,
        **uniforms: "bool | float | Sequence[float] | Array",
    ) -> None:
        """Draw all characters with programs of some features, where `tests` let them be seen."""
        frame.context.enable_only(tests)
        first_surface = 1
        for character in frame.characters:
            wanted, inside = features, character.inside
            if inside is not None:
                wanted |= {CLIPPED}
                uniforms["cube_from_table"] = unit_cube_from_table(inside, frame.camera_from_table)
            set_clipping(frame.context, inside is not None)
            character.skinned.render(
                frame.context,
                wanted,
                first_surface,
                clip_from_table=layer.clip_from_camera @ frame.camera_from_table,
                height=character.height,
                **uniforms,
            )
            first_surface += len(character.skinned.surfaces)
        set_clipping(frame.context, False)
