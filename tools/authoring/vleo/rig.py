"""Vleo's skeleton, and the effects that are hidden at rest."""

import numpy as np

from cubeling.characters.skeleton.pose import Pose, Skeleton
from tools.authoring.modelling.rig import build_skeleton
from tools.authoring.modelling.shapes import Vector

FEET = ("LeftFrontFoot", "RightFrontFoot", "LeftHindFoot", "RightHindFoot")
HEARTS = ("heart1", "heart2", "heart3")
BURSTS = ("burst1", "burst2", "burst3")
NECK = ("neck1", "neck2", "neck3")
TAIL = ("tail1", "tail2", "tail3", "tail4", "tail5")
BACK = ("hips", "spine1", "spine2", "chest")
HIDDEN_SCALE = 1e-3
"""Scale of a hidden joint; not zero, so that its matrix can be inverted."""

_JOINT_POSITIONS: dict[str, tuple[str, Vector]] = {
    "root": ("", (0.0, 0.0, 0.0)),
    "hips": ("root", (0.0, 0.112, -0.045)),
    "spine1": ("hips", (0.0, 0.115, -0.012)),
    "spine2": ("spine1", (0.0, 0.117, 0.018)),
    "chest": ("spine2", (0.0, 0.122, 0.045)),
    "neck1": ("chest", (0.0, 0.145, 0.066)),
    "neck2": ("neck1", (0.0, 0.171, 0.079)),
    "neck3": ("neck2", (0.0, 0.196, 0.086)),
    "head": ("neck3", (0.0, 0.221, 0.094)),
    "jaw": ("head", (0.0, 0.2235, 0.124)),
    "lips": ("head", (0.0, 0.2150, 0.190)),
    "belly": ("spine1", (0.0, 0.100, -0.005)),
    "tail1": ("hips", (0.0, 0.094, -0.090)),
    "tail2": ("tail1", (0.0, 0.083, -0.125)),
    "tail3": ("tail2", (0.0, 0.077, -0.161)),
    "tail4": ("tail3", (0.0, 0.079, -0.197)),
    "tail5": ("tail4", (0.0, 0.092, -0.232)),
    "LeftEye": ("head", (0.0305, 0.2640, 0.1410)),
    "LeftFrontUpperLeg": ("chest", (0.036, 0.098, 0.052)),
    "LeftFrontLowerLeg": ("LeftFrontUpperLeg", (0.041, 0.058, 0.030)),
    "LeftFrontFoot": ("LeftFrontLowerLeg", (0.043, 0.020, 0.053)),
    "LeftHindUpperLeg": ("hips", (0.036, 0.100, -0.046)),
    "LeftHindLowerLeg": ("LeftHindUpperLeg", (0.043, 0.058, -0.026)),
    "LeftHindFoot": ("LeftHindLowerLeg", (0.045, 0.020, -0.052)),
}
EYE_CENTRE_M = np.array(_JOINT_POSITIONS["LeftEye"][1])
"""Centre of the left eyeball, character frame [m]."""
MOUTH_M = (0.0, 0.222, 0.200)
"""Origin of kisses and shouts, character frame [m]."""


def skeleton() -> Skeleton:
    """Return the skeleton in its bind pose: axes as the character's, scales one."""
    effects: dict[str, tuple[str, Vector]] = dict.fromkeys(HEARTS + BURSTS, ("root", MOUTH_M))
    return build_skeleton(_JOINT_POSITIONS | effects)


def shipped_skeleton(bound: Skeleton) -> Skeleton:
    """Return the bundled skeleton, with hidden effects."""
    scales = np.ones((len(bound), 3))
    for name in (*HEARTS, *BURSTS):
        scales[bound.index(name)] = HIDDEN_SCALE
    rest = Pose(bound.rest.translations, bound.rest.rotations, scales)
    return Skeleton(bound.names, bound.parents, rest)
