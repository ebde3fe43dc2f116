"""Feet that stay where they landed."""

import numpy as np

from cubeling.characters.control.layers.layer import FrameContext
from cubeling.characters.ik.legs import LegIK, find_legs
from cubeling.characters.locomotion.foot_lock import FootLock
from cubeling.characters.model.character import Character
from cubeling.characters.motion.motion import RootDelta
from cubeling.characters.skeleton.pose import Pose


class FootLockLayer:
    """Holds planted feet by inverse kinematics, for controllers that know which feet are down."""

    def __init__(self, character: Character, seed: int = 0) -> None:
        legs = find_legs(character.skeleton)
        self.lock = None
        if legs is not None:
            self.lock = FootLock(legs, character.height, _bending_toes(character, legs))
        """What holds the feet; None without legs that bend."""

    def update(self, pose: Pose, context: FrameContext) -> Pose:
        """Return the pose with its planted feet held."""
        frame, scale = context.frame, context.scale
        if self.lock is None or frame.feet_down is None:
            return pose
        place = RootDelta(frame.place.x / scale, frame.place.z / scale, frame.place.yaw)
        return self.lock.apply(pose, place, frame.feet_down, frame.standing, context.elapsed)


def _bending_toes(character: Character, legs: LegIK) -> list[bool]:
    """Return for each leg whether its toes move any skin; without a skin, all do."""
    meshes = character.meshes
    moved = {joint for mesh in meshes for joint in np.unique(mesh.joints[mesh.weights > 0.0])}
    moving = character.skeleton.with_ancestors(moved)
    return [not meshes or toes in moving for toes in legs.indices[legs.joints[:, 4]]]
