"""What every pass has in common."""

from collections.abc import Sequence
from typing import Protocol

from cubeling.characters.rendering.camera_picture.hand_cover import PictureCover
from cubeling.characters.rendering.resources import CharacterLayer, FrameResources


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

    def composite(self, frame: FrameResources, cover: PictureCover | None) -> None:
        """Change the picture of the frame, in place; `cover` is the hand.

        The picture is in memory: a software driver takes several times as long as OpenCV to change
        it.
        """

    def release(self) -> None:
        """Release what the pass owns; a second call does nothing."""
        for each in self.owned:
            each.release()
