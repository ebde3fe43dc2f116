"""The bundled explorer's skeleton: four heads high, in a relaxed A-pose, facing +z."""

from characters.authoring.rig import build_skeleton
from characters.authoring.shapes import Vector
from characters.pose import Skeleton

JOINTS: dict[str, tuple[str, Vector]] = {
    "root": ("", (0.0, 0.0, 0.0)),
    "hips": ("root", (0.0, 0.84, 0.0)),
    "spine1": ("hips", (0.0, 0.92, -0.01)),
    "spine2": ("spine1", (0.0, 1.01, -0.015)),
    "chest": ("spine2", (0.0, 1.10, -0.015)),
    "neck": ("chest", (0.0, 1.225, -0.01)),
    "head": ("neck", (0.0, 1.295, 0.0)),
    "LeftEyelid": ("head", (0.068, 1.463, 0.11)),
    "LeftShoulder": ("chest", (0.045, 1.185, -0.01)),
    "LeftArm": ("LeftShoulder", (0.15, 1.175, -0.012)),
    "LeftForeArm": ("LeftArm", (0.30, 0.985, -0.02)),
    "LeftHand": ("LeftForeArm", (0.43, 0.815, 0.005)),
    "LeftUpLeg": ("hips", (0.092, 0.805, 0.0)),
    "LeftLeg": ("LeftUpLeg", (0.104, 0.45, 0.012)),
    "LeftFoot": ("LeftLeg", (0.11, 0.095, -0.015)),
    "LeftToe": ("LeftFoot", (0.118, 0.03, 0.10)),
}
"""Parent and place of each joint [m]; the right side is the mirror image."""

EYE_RADII = (0.052, 0.066, 0.066)
"""Of an eyeball, a solid of revolution about x, so that an eyelid can turn over it [m]."""


def build_human_skeleton() -> Skeleton:
    """Return the skeleton in its relaxed A-pose, facing +z."""
    return build_skeleton(JOINTS)
