"""What every pass has in common."""

from collections.abc import Sequence
from typing import Protocol

from characters.rendering.projection import Rectangle
from characters.rendering.resources import CharacterLayer, FrameResources, Region


class Releasable(Protocol):
    """An object of the graphics card."""

    def release(self) -> object:
        """Release it; a second call does nothing."""


class RenderPass:
    """One step in drawing a picture.

    Once a frame, the stage calls `prepare` and `draw_layer` of one pass after the other. Then it
    asks for the hand, and calls `draw` of all passes for each region of the picture that something
    is drawn in. Between passes, only the framebuffers and what `FrameResources` holds are shared: a
    pass sets the blending, the tests and the uniforms that it needs. `Region` says which
    framebuffers there are.
    """

    owned: Sequence[Releasable] = ()
    """Vertex arrays and buffers of this pass, which `release` releases."""

    def prepare(self, frame: FrameResources) -> Sequence[Rectangle]:
        """Make ready for a frame, and return the areas of the picture that this pass changes."""
        return ()

    def draw_layer(self, frame: FrameResources, layer: CharacterLayer) -> None:
        """Draw on the layer of the characters, whatever the hand hides of it.

        The driver is at work on it already while the hand is found.
        """

    def draw(self, frame: FrameResources, region: Region) -> None:
        """Draw one region of the picture."""

    def release(self) -> None:
        """Release what the pass owns; a second call does nothing."""
        for each in self.owned:
            each.release()
