"""What the camera sees of a character that goes here and there."""

import numpy as np

from cubeling.app.speaking.speech_video import focus_of
from cubeling.app.speaking.view import View
from cubeling.app.ui.clip_video import Focus
from cubeling.characters import Character, Pose

FOLLOW_LAG_S = 0.4
"""Lag with which a camera follows a character [s]."""


class FollowingCamera:
    """Follows the root joint of a character."""

    def __init__(self, character: Character, view: View) -> None:
        self._character, self._view = character, view
        self._centre, self._radius = np.zeros(3), 0.0
        self._followed = np.zeros(3)
        self._last: float | None = None

    def focus(self, pose: Pose, now: float) -> Focus:
        """Return what is seen of a pose with its root where it stands, at a time [s]."""
        place = pose.translations[0]
        if self._last is None:
            middle, self._radius = focus_of(self._character, pose, self._view)
            self._centre, self._followed, self._last = middle - place, place, now
        kept = np.exp(-(now - self._last) / FOLLOW_LAG_S)
        self._followed, self._last = place + (self._followed - place) * kept, now
        return self._centre + self._followed, self._radius
