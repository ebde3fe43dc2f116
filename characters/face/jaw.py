"""The jaw as a joint, for faces without morphs that speak."""

import math

import numpy as np

from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.anatomy import Anatomy
from cubeling.characters.skeleton.pose import Pose, Skeleton

OPEN_RAD = math.radians(18)
"""Rotation of a jaw that is wide open [rad]."""


class JawJoint:
    """Opens the mouth of a character by its jaw joint; without one it does nothing."""

    def __init__(self, skeleton: Skeleton, anatomy: Anatomy) -> None:
        self._joint = anatomy.joint("jaw")
        if self._joint is not None:
            parent = int(skeleton.parents[self._joint])
            matrix = skeleton.rest.globals(skeleton)[parent] if parent >= 0 else np.eye(4)
            # The character's x axis, about which a jaw falls open, as the joint's parent has it.
            axis = matrix[:3, :3].T @ [1.0, 0.0, 0.0]
            self._axis = axis / np.linalg.norm(axis)

    def __bool__(self) -> bool:
        return self._joint is not None

    def open_by(self, pose: Pose, opening: float) -> Pose:
        """Return a pose with the jaw opened further, 0…1."""
        if self._joint is None or opening <= 0.0:
            return pose
        turned = pose.rotations.copy()
        turn = rotations.from_rotation_vector(OPEN_RAD * opening * self._axis)
        turned[self._joint] = rotations.multiply(turn, turned[self._joint])
        return pose.with_rotations(turned)
