"""The bundled explorer's skeleton: three and a half heads high, in an A-pose, facing +z."""

import numpy as np

from cubeling.characters.skeleton.pose import Skeleton
from tools.authoring.modelling.rig import build_skeleton
from tools.authoring.modelling.shapes import Array, Vector

_BODY: dict[str, tuple[str, Vector]] = {
    "root": ("", (0.0, 0.0, 0.0)),
    "hips": ("root", (0.0, 0.84, 0.0)),
    "spine1": ("hips", (0.0, 0.91, -0.01)),
    "spine2": ("spine1", (0.0, 0.99, -0.015)),
    "chest": ("spine2", (0.0, 1.07, -0.015)),
    "neck": ("chest", (0.0, 1.19, -0.01)),
    "head": ("neck", (0.0, 1.245, 0.0)),
    "LeftEye": ("head", (0.0442, 1.4309, 0.0719)),
    "Cowlick": ("head", (0.01, 1.66, -0.03)),
    "HairTop": ("head", (0.0, 1.625, -0.161)),
    "LeftHairBack": ("head", (0.099, 1.501, -0.161)),
    "LeftHairSide": ("head", (0.192, 1.476, 0.020)),
    "Hood": ("chest", (0.0, 1.205, -0.065)),
    "Backpack": ("chest", (0.0, 1.13, -0.115)),
    "LeftString": ("chest", (0.036, 1.14, 0.112)),
    "LeftShoulder": ("chest", (0.045, 1.15, -0.01)),
    "LeftArm": ("LeftShoulder", (0.148, 1.138, -0.012)),
    "LeftForeArm": ("LeftArm", (0.298, 0.95, -0.02)),
    "LeftHand": ("LeftForeArm", (0.425, 0.785, 0.005)),
    "LeftUpLeg": ("hips", (0.092, 0.805, 0.0)),
    "LeftLeg": ("LeftUpLeg", (0.104, 0.45, 0.012)),
    "LeftFoot": ("LeftLeg", (0.11, 0.095, -0.015)),
    "LeftToe": ("LeftFoot", (0.118, 0.03, 0.10)),
}

FINGERS: dict[str, tuple[Vector, ...]] = {
    "Thumb": ((0.024, 0.030, 0.006), (0.056, 0.062, 0.014), (0.088, 0.074, 0.020)),
    "Index": ((0.080, 0.034, 0.0), (0.118, 0.040, 0.006), (0.150, 0.041, 0.020)),
    "Middle": ((0.084, 0.002, 0.0), (0.126, 0.002, 0.006), (0.160, 0.001, 0.022)),
    "Pinky": ((0.078, -0.029, 0.0), (0.110, -0.035, 0.006), (0.138, -0.037, 0.018)),
}
"""Knuckle, middle joint and tip of each finger from the wrist: along the forearm, to the front
and towards the body [m]."""


def along_forearm() -> Array:
    """Return the axes of `FINGERS` as rows, (3, 3): along the forearm, to the front, inward."""
    elbow, wrist = (np.array(_BODY[f"Left{name}"][1]) for name in ("ForeArm", "Hand"))
    along = (wrist - elbow) / np.linalg.norm(wrist - elbow)
    front = np.array([0.0, 0.0, 1.0]) - along[2] * along
    front /= np.linalg.norm(front)
    return np.stack([along, front, np.cross(along, front)])


def in_hand(points: tuple[Vector, ...]) -> list[Vector]:
    """Return points in the axes of `FINGERS` in the character frame [m]."""
    placed = np.array(_BODY["LeftHand"][1]) + np.array(points) @ along_forearm()
    return [(x, y, z) for x, y, z in placed.tolist()]


def _fingers() -> dict[str, tuple[str, Vector]]:
    joints = {}
    for finger, points in FINGERS.items():
        knuckle, middle, _ = in_hand(points)
        joints[f"LeftHand{finger}1"] = ("LeftHand", knuckle)
        joints[f"LeftHand{finger}2"] = (f"LeftHand{finger}1", middle)
    return joints


JOINT_POSITIONS = _BODY | _fingers()
"""Parent and position of each joint [m]; the right side is the mirror image."""


def build_human_skeleton() -> Skeleton:
    """Return the skeleton in its relaxed A-pose, facing +z."""
    return build_skeleton(JOINT_POSITIONS)
