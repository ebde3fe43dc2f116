"""What is seen of the characters in each texel of their layer, for the passes that light it."""

import moderngl

from characters.rendering.deferred.buffers import MAX_SURFACES
from characters.rendering.geometry.surfaces import GEOMETRY
from characters.rendering.passes.characters import CharacterPass
from characters.rendering.passes.cube_window import clip_to, unit_cube_from_table
from characters.rendering.programs import set_uniforms
from characters.rendering.resources import FrameResources, Region


class DeferredGeometryPass(CharacterPass):
    """Draws the skinned characters on the geometry buffer (pass 1 of deferred shading)."""

    def draw(self, frame: FrameResources, region: Region) -> None:
        """Draw all characters."""
        layer = region.characters
        if layer is None:
            return
        framebuffer = layer.use_geometry()
        framebuffer.depth_mask = False  # the depth of real cubes stays
        framebuffer.clear()
        framebuffer.depth_mask = True
        framebuffer.use()  # the mask takes effect here
        frame.context.enable_only(moderngl.DEPTH_TEST)
        clip_from_table = layer.clip_from_camera @ frame.camera_from_table
        surface_id = 0
        for character in frame.characters:
            clip_to(frame.context, character)
            cube_from_table = unit_cube_from_table(frame, character.inside)
            for part in character.skinned.surfaces:
                surface_id += 1
                array = character.skinned.array(part.features | {GEOMETRY})
                set_uniforms(
                    array.program,
                    clip_from_table=clip_from_table,
                    camera_from_table=frame.camera_from_table,
                    cube_from_table=cube_from_table,
                    surface_id=float(min(surface_id, MAX_SURFACES)),
                )
                part.render(frame.context, array)
        clip_to(frame.context, None)
