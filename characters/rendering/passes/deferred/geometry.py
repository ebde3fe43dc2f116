"""What is seen of the characters in each texel of their layer, for the passes that light it."""

from cubeling.characters.rendering.geometry.surfaces import GEOMETRY
from cubeling.characters.rendering.passes.characters import CharacterPass
from cubeling.characters.rendering.resources import CharacterLayer, FrameResources


class DeferredGeometryPass(CharacterPass):
    """Draws the skinned characters on the geometry buffer (pass 1 of deferred shading)."""

    def draw_layer(self, frame: FrameResources, layer: CharacterLayer) -> None:
        """Draw depth, normals and colours of all characters for the lighting pass."""
        framebuffer = layer.use_geometry()
        framebuffer.depth_mask = False  # the depth of real cubes stays
        framebuffer.clear()
        framebuffer.depth_mask = True
        framebuffer.use()  # the mask takes effect here
        self._render(frame, layer, frozenset([GEOMETRY]), camera_from_table=frame.camera_from_table)
