"""What every pass has in common."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import Protocol

from characters.rendering.hidden_table import hidden_table
from characters.rendering.projection import Rectangle, clip_from_camera
from characters.rendering.resources import CharacterLayer, FrameResources, Region
from characters.rendering.scene import Cover
from characters.rendering.target import bgra_from_bgr


class Releasable(Protocol):
    """An object of the graphics card."""

    def release(self) -> object:
        """Release it; a second call does nothing."""


class RenderPass:
    """One step in drawing a picture.

    Once a frame, the stage calls `prepare` of all passes, then `draw_layer` of one after the other.
    Then it asks for the hand, and calls `composite` of one after the other. Between passes, only
    the framebuffers and what `FrameResources` holds are shared: a pass sets the blending, the tests
    and the uniforms that it needs.
    """

    owned: Sequence[Releasable] = ()
    """Vertex arrays and buffers of this pass, which `release` releases."""

    def prepare(self, frame: FrameResources) -> None:
        """Make ready for a frame."""

    def draw_layer(self, frame: FrameResources, layer: CharacterLayer) -> None:
        """Draw on the layer of the characters, whatever the hand hides of it.

        The driver is at work on it already while the hand is found.
        """

    def composite(self, frame: FrameResources, cover: Cover | None) -> None:
        """Change the picture of the frame, in place; `cover` is the hand."""

    def release(self) -> None:
        """Release what the pass owns; a second call does nothing."""
        for each in self.owned:
            each.release()


class RegionPass(RenderPass, ABC):
    """A pass that draws on regions of the picture on the graphics card.

    They are uploaded and read back, which takes time: other passes change the picture in memory.
    """

    areas: Sequence[Rectangle] = ()
    """The areas of the picture that this pass changes in a frame; `prepare` sets them."""

    @abstractmethod
    def draw(self, frame: FrameResources, region: Region) -> None:
        """Draw one region."""

    def composite(self, frame: FrameResources, cover: Cover | None) -> None:
        """Draw all regions. Where they overlap, the last one is right."""
        drawn = []
        for area in self.areas:
            hidden = hidden_table(frame.hidden_by_cubes, cover, area)
            region = Region(
                area,
                frame.targets.pictures.at_least(area.width, area.height),
                clip_from_camera(frame.camera_matrix, area) @ frame.camera_from_table,
                None if hidden is None else frame.hidden.write(hidden),
            )
            region.target.write(bgra_from_bgr(frame.picture[area.slices]))
            self.draw(frame, region)
            drawn.append(region.target.read(area.width, area.height))
        for area, pixels in zip(self.areas, drawn, strict=True):
            frame.picture[area.slices] = pixels
