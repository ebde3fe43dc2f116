"""The camera's picture, which everything else is drawn on."""

from characters.rendering.passes.render_pass import RenderPass
from characters.rendering.resources import FrameResources, Region
from characters.rendering.target import bgra_from_bgr


class BackgroundPass(RenderPass):
    """Uploads the region of the camera's picture."""

    def draw(self, frame: FrameResources, region: Region) -> None:
        """Fill the region with the camera's picture."""
        region.target.write(bgra_from_bgr(frame.picture[region.area.slices]))
