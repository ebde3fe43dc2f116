"""Whether the character is to be seen."""

from tracking import CubeControls

GRACE = 0.6
"""How long the character stays when the cube is hidden [s]: fingers hide it for moments."""


class Presence:
    """The character is there while the cube is seen (AvatAR), with a short grace.

    Its state is kept while it is hidden, so it comes back as it was.
    """

    def __init__(self) -> None:
        self._seen: float | None = None

    def update(self, controls: CubeControls) -> bool:
        """Return whether to show the character in this frame."""
        if controls.visible:
            self._seen = controls.timestamp
        known = controls.camera_from_table is not None
        return known and self._seen is not None and controls.timestamp - self._seen <= GRACE
