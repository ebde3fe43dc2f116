"""What the camera sees of a character that goes here and there."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from app.speaking.performance import View, framed
from characters import Character, Clip, Pose

Focus = tuple[NDArray[np.float64], float]
"""What is seen: a centre (3,) and a radius in the character frame [m]."""

MAX_PATH_SHARE = 1.5
"""Ways longer than this part of the character's size are followed by the camera."""

PATH_ROOM = 1.25
"""What a way takes of the picture, in its lengths: it comes nearer too."""


FOLLOW_LAG_S = 0.4
"""Lag with which a camera follows a character that plays [s]."""


def camera_focus(character: Character, clip: Clip, view: View) -> Callable[[int], Focus]:
    """Return what the camera sees in a frame: it stands still for short ways and follows longer."""
    track = clip.poses.translations[:, 0] - clip.poses.translations[0, 0]
    centre, radius = framed(character, clip.poses[0], view)
    low, high = track.min(0), track.max(0)
    way = float(np.linalg.norm(high - low))
    if view == "body" and way <= MAX_PATH_SHARE * 2.0 * radius:
        middle, seen = centre + (low + high) / 2, radius + PATH_ROOM * way / 2
        return lambda _number: (middle, seen)
    return lambda number: (centre + track[number], radius)


class FollowingCamera:
    """Follows the root joint of a character that plays."""

    def __init__(self, character: Character, view: View) -> None:
        self._character, self._view = character, view
        self._centre, self._radius = np.zeros(3), 0.0
        self._followed = np.zeros(3)
        self._last: float | None = None

    def focus(self, pose: Pose, now: float) -> Focus:
        """Return what is seen of a pose with its root where it stands, at a time [s]."""
        place = pose.translations[0]
        if self._last is None:
            middle, self._radius = framed(self._character, pose, self._view)
            self._centre, self._followed, self._last = middle - place, place, now
        kept = np.exp(-(now - self._last) / FOLLOW_LAG_S)
        self._followed, self._last = place + (self._followed - place) * kept, now
        return self._centre + self._followed, self._radius
