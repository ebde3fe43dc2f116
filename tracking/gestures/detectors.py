"""The gestures that are made in a moment, each with its detector."""

from collections.abc import Callable
from typing import Protocol

from cubeling.registry import Registry
from cubeling.tracking.geometry.arrays import Array


class GestureDetector(Protocol):
    """Recognises one gesture of the hand that holds the cube."""

    def update(self, timestamp: float, pose: Array, velocity: Array) -> bool:
        """Return whether the gesture is complete in this frame.

        Parameters
        ----------
        timestamp
            That of the frame [s]; frames in which the cube is not seen are left out.
        pose
            `camera_from_cube`, (4, 4) [m].
        velocity
            Velocity and angular velocity in the camera frame, (6,) [m/s, rad/s]; zero after a gap.
        """


DETECTORS = Registry[Callable[[], GestureDetector]](
    {
        "shaken": "cubeling.tracking.gestures.shaking:ShakeDetector",
    }
)
"""Makes the detector of each gesture, by the name that `CubeControls.gestures` gives it; a new one
is registered here."""
