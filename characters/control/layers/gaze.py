"""Gaze: head and eyes that follow a point."""

from characters.body.gaze import Gaze
from characters.control.layers.layer import FrameContext
from characters.control.layers.posture import posture_share
from characters.model.character import Character
from characters.skeleton.pose import Pose

HEAD_SHARE_IN_ACTION = 0.2
"""Part of its turn that the head makes while an action needs it."""


class GazeLayer:
    """Turns head and eyes to the point that the command names."""

    def __init__(self, character: Character, seed: int = 0) -> None:
        self._gaze = Gaze(character.skeleton, character.anatomy)

    def update(self, pose: Pose, context: FrameContext) -> Pose:
        """Return the pose with its gaze on the point."""
        pose = self._gaze.update(
            pose,
            context.gaze_target,
            context.elapsed,
            1.0 - (1.0 - HEAD_SHARE_IN_ACTION) * float(context.frame.acting),
            tempo=context.expressivity.tempo,
            head_drop=context.expressivity.head_drop * posture_share(context),
        )
        context.gaze_shift = self._gaze.shift
        return pose
