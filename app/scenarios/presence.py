"""Whether the character is visible."""

from cubeling.tracking import CubeControls

HIDE_DELAY_S = 0.6
"""How long the character stays when the cube is hidden: fingers hide it for moments."""


class Presence:
    """Shows the character while the cube is visible (AvatAR), and for a moment longer [s]."""

    def __init__(self, hide_delay: float = HIDE_DELAY_S) -> None:
        self._hide_delay = hide_delay
        self._last_seen: float | None = None

    def update(self, controls: CubeControls) -> bool:
        """Return whether to show the character in this frame."""
        now = controls.timestamp
        if controls.visible:
            self._last_seen = now
        if controls.camera_from_table is None or self._last_seen is None:
            return False
        return now - self._last_seen <= self._hide_delay
