"""The characters themselves, shaded, on their own layer."""

from collections.abc import Sequence

import moderngl

from characters.rendering.passes.cube_window import clip_to, unit_cube_from_table
from characters.rendering.passes.render_pass import RenderPass
from characters.rendering.programs import set_uniforms
from characters.rendering.projection import Rectangle
from characters.rendering.resources import FrameResources, Region


class CharacterPass(RenderPass):
    """Draws the skinned characters on the character layer, whose depth hides what is covered."""

    def prepare(self, frame: FrameResources) -> Sequence[Rectangle]:
        """Return the area around the characters."""
        area = frame.character_area
        return () if area is None else (area,)

    def draw(self, frame: FrameResources, region: Region) -> None:
        """Draw all characters."""
        layer = region.characters
        if layer is None:
            return
        layer.use()
        context, light = frame.context, frame.light
        context.enable_only(moderngl.DEPTH_TEST)
        clip_from_table = layer.clip_from_camera @ frame.camera_from_table
        eye = frame.camera_position
        for character in frame.characters:
            clip_to(context, character)
            prepared: set[int] = set()
            for part in character.skinned.surfaces:
                program = part.array.program
                if program.glo not in prepared:
                    prepared.add(program.glo)
                    set_uniforms(
                        program,
                        clip_from_table=clip_from_table,
                        eye=eye,
                        to_light=light.to_light,
                        key=light.key,
                        sky=light.sky,
                        ground=light.ground,
                        height=character.height,
                        cube_from_table=unit_cube_from_table(frame, character.inside),
                    )
                part.render(context, part.array)
        clip_to(context, None)
