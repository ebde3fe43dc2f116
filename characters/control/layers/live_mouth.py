"""The mouth of a live voice, whose words nobody knows."""

from dataclasses import replace

import numpy as np

from cubeling.characters.control.layers.layer import FrameContext
from cubeling.characters.face.jaw import JawJoint
from cubeling.characters.face.visemes.mouth_morphs import MouthMorphs, jaw_opening
from cubeling.characters.face.visemes.sets import MOUTH_SHAPES
from cubeling.characters.model.character import Character
from cubeling.characters.skeleton.pose import Pose
from cubeling.characters.speech.mouth import MouthWeights

SHAPE_OF = {"open": "aa", "spread": "I", "rounded": "U", "hiss": "SS"}
"""The shape for each of `MouthWeights`."""

NEUTRAL_LEVEL = 1
"""The level of emphasis that is shown."""


class LiveMouthLayer:
    """Shows the shape of the mouth that it was told last."""

    def __init__(self, character: Character, seed: int = 0) -> None:
        self.mouth = MouthWeights(0.0, 0.0, 0.0, 0.0)
        """The shape of the mouth."""
        self._count = len(character.morphs)
        self._morphs = MouthMorphs.of(character.morphs)
        self._jaw = JawJoint(character.skeleton, character.anatomy)

    def update(self, pose: Pose, context: FrameContext) -> Pose:
        """Return the pose with the mouth in its shape."""
        shapes = np.zeros((3, len(MOUTH_SHAPES)))
        for name, shape in SHAPE_OF.items():
            shapes[NEUTRAL_LEVEL, MOUTH_SHAPES.index(shape)] = getattr(self.mouth, name)
        if not self._morphs:
            return self._jaw.open_by(pose, jaw_opening(shapes))
        weights = np.zeros(self._count) if pose.morphs is None else pose.morphs.copy()
        weights[self._morphs.numbers] += self._morphs.of_shapes(shapes)
        return replace(pose, morphs=weights)
