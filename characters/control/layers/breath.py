"""Breath that shows in a morph of the chest."""

import numpy as np

from cubeling.characters.control.layers.layer import FrameContext
from cubeling.characters.model.character import Character
from cubeling.characters.skeleton.pose import Pose

BREATH_MORPH = "breath"
"""The morph of a full chest."""


class BreathLayer:
    """Sets the morph of the chest; a character without one is left alone."""

    def __init__(self, character: Character, seed: int = 0) -> None:
        morphs = character.morphs
        self._count = len(morphs)
        self._morph = morphs.index(BREATH_MORPH) if BREATH_MORPH in morphs else None

    def update(self, pose: Pose, context: FrameContext) -> Pose:
        """Return the pose with the chest filled by the breath."""
        if self._morph is None:
            return pose
        weights = np.zeros(self._count) if pose.morphs is None else pose.morphs.copy()
        weights[self._morph] += context.breath
        return pose.with_morphs(weights)
