"""Which way a body faces at rest, in quarter turns.

The axes that all bodies share are +y up, +z ahead and +x to the left.
"""

import numpy as np

from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.anatomy import Anatomy
from cubeling.characters.skeleton.pose import Array, Skeleton

_MIN_LEVEL_PART = 0.4  # of a foot's length; toes that hang show no direction


def common_from_skeleton(skeleton: Skeleton, anatomy: Anatomy) -> Array:
    """Return the rotation (4,) from the axes of a skeleton to the common ones, by quarter turns.

    The sides of the body show its axis. Feet, and the trunk of an animal, tell what is ahead: some
    models have their sides exchanged.
    """
    positions = skeleton.rest.globals(skeleton)[:, :3, 3]
    legs = [positions[end] for end in _leg_ends(anatomy)]
    left, right = (
        _side_centre(positions, anatomy, "left"),
        _side_centre(positions, anatomy, "right"),
    )
    if not legs or left is None or right is None:
        return rotations.IDENTITY
    trunk = [positions[anatomy.joints[part]] for part in ("hips", "head") if part in anatomy.joints]
    if not trunk:
        return rotations.IDENTITY
    up = _nearest_axis(np.mean(trunk, axis=0) - np.mean(legs, axis=0))
    across = left - right
    ahead = np.cross(_nearest_axis(across - up * float(across @ up)), up)
    if float(_visible_ahead(positions, anatomy, up) @ ahead) < 0:
        ahead = -ahead
    return rotations.from_matrix(np.stack([np.cross(up, ahead), up, ahead]))


def _leg_ends(anatomy: Anatomy) -> list[int]:
    """Return the joints of the legs that are nearest to the ground."""
    return [
        anatomy.joints[
            next(part for part in (f"{leg}Toes", f"{leg}Foot") if part in anatomy.joints)
        ]
        for leg in ("left", "right", "leftFront", "rightFront")
        if f"{leg}Foot" in anatomy.joints
    ]


def _side_centre(positions: Array, anatomy: Anatomy, side: str) -> Array | None:
    """Return the centre (3,) of where limbs begin, which do not swing, or of all on a side."""
    own = {part: joint for part, joint in anatomy.joints.items() if part.startswith(side)}
    roots = [joint for part, joint in own.items() if part.endswith(("UpperLeg", "UpperArm"))]
    joints = roots or list(own.values())
    return positions[joints].mean(0) if joints else None


def _visible_ahead(positions: Array, anatomy: Anatomy, up: Array) -> Array:
    """Return the level part (3,) of the feet, or of an animal's trunk; zero if it is steep."""
    bones = [("leftFoot", "leftToes"), ("rightFoot", "rightToes")]
    if anatomy.kind == "quadruped":
        bones = [("hips", "head")]
    joints = anatomy.joints
    ends = [(joints[a], joints[b]) for a, b in bones if a in joints and b in joints]
    shown = np.zeros(3)
    for start, end in ends:
        bone = positions[end] - positions[start]
        level = bone - up * float(bone @ up)
        if np.linalg.norm(level) > _MIN_LEVEL_PART * np.linalg.norm(bone):
            shown += level
    return shown


def _nearest_axis(direction: Array) -> Array:
    """Return the one of ±x, ±y, ±z that is nearest to a direction."""
    axis = np.zeros(3)
    number = int(np.abs(direction).argmax())
    axis[number] = np.sign(direction[number]) or 1.0
    return axis
