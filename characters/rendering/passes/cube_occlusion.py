"""The depth of the real cubes, which hide the characters behind them."""

import moderngl

from cubeling.characters.rendering.camera_picture.occlusion import UNIT_CUBE, camera_from_unit_cube
from cubeling.characters.rendering.passes.render_pass import RenderPass
from cubeling.characters.rendering.programs import ShaderPrograms, set_uniforms
from cubeling.characters.rendering.resources import CharacterLayer, FrameResources


class CubeOcclusionPass(RenderPass):
    """Clears the character layer and writes the depth of the real cubes, without colour."""

    def __init__(self, context: moderngl.Context, programs: ShaderPrograms) -> None:
        self._program = programs.load("cube", "depth_only")
        corners = context.buffer(UNIT_CUBE.astype("f4"))
        self._cube = context.vertex_array(self._program, [(corners, "3f", "position")])
        self.owned = (self._cube, corners)

    def draw_layer(self, frame: FrameResources, layer: CharacterLayer) -> None:
        """Clear the character layer and write depth."""
        framebuffer = layer.use()
        framebuffer.clear()
        if not layer.cubes:
            return
        framebuffer.color_mask = False, False, False, False
        framebuffer.use()  # the mask takes effect here
        frame.context.enable_only(moderngl.DEPTH_TEST)
        for box in layer.cubes:
            if box.is_open:  # `CubeWindowPass` draws it
                continue
            clip_from_cube = layer.clip_from_camera @ camera_from_unit_cube(box)
            set_uniforms(self._program, clip_from_cube=clip_from_cube)
            self._cube.render(moderngl.TRIANGLES)
        framebuffer.color_mask = True, True, True, True
        framebuffer.use()
