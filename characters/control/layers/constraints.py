"""Constraints: twist bones and the like, that turn as other joints do."""

from cubeling.characters.body.constraints import ConstrainedJoints
from cubeling.characters.control.layers.layer import FrameContext
from cubeling.characters.model.character import Character
from cubeling.characters.skeleton.pose import Pose


class ConstraintLayer:
    """Turns the constrained joints of a character; what turns other joints comes before."""

    def __init__(self, character: Character, seed: int = 0) -> None:
        self._joints = ConstrainedJoints(character.skeleton, character.constraints)

    def update(self, pose: Pose, context: FrameContext) -> Pose:
        """Return the pose with its constrained joints turned."""
        return self._joints.apply(pose)
