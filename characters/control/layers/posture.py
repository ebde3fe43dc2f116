"""Posture, breath and sway of the body."""

from cubeling.characters.body.posture import NEUTRAL_EXPRESSIVITY, Posture
from cubeling.characters.body.sway import BodySway
from cubeling.characters.control.layers.layer import Found, FrameContext
from cubeling.characters.model.character import Character
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.pose import Pose

SHARE_IN_ACTION = 0.5
"""Share of a posture that stays in the midst of an action."""


def posture_share(context: FrameContext) -> float:
    """Return the share of a posture that is shown, 0…1."""
    return SHARE_IN_ACTION + (1.0 - SHARE_IN_ACTION) * context.rest


class PostureLayer:
    """Turns trunk, shoulders and head by posture, breath and sway."""

    def __init__(self, character: Character, seed: int) -> None:
        self._sway = BodySway(character.skeleton, character.anatomy, seed)
        self._posture = Posture(character.skeleton, character.anatomy, self._sway.joints)

    def update(self, pose: Pose, context: FrameContext) -> Found:
        """Return the pose with posture, breath and sway, and how full the lungs are."""
        expressivity, joints, posture = context.expressivity, self._sway.joints, None
        if expressivity is not NEUTRAL_EXPRESSIVITY:
            joints = self._posture.joints
            posture = self._posture.rotation_vectors(expressivity, posture_share(context))
        turns = self._sway.update(
            context.elapsed, context.frame.effort, context.rest, expressivity, posture
        )
        local = pose.rotations.copy()
        local[joints] = rotations.multiply(local.take(joints, 0), turns)
        moved = pose.with_rotations(local)
        return Found(moved, context.found(breath=self._sway.breath))
