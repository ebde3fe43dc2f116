"""Which joints of a skeleton are its feet."""

import re
from collections.abc import Sequence

import numpy as np

from characters.skeleton.anatomy import Anatomy
from characters.skeleton.joint_names import read_name
from characters.skeleton.pose import Skeleton

Feet = Sequence[Sequence[int]]
"""The joints of each foot, from the ankle on; a paw may have one joint only."""

_EXTREMITY_NAME = re.compile(r"(?i:foot|toe|paw|hoof|hand)")
_FINGER_NAME = re.compile(r"(?i:thumb|finger|index|middle|ring|pinky|palm)")
_MAX_FOOT_HEIGHT = 0.15  # body heights above the lowest foot: what is higher is a hand


def find_feet(skeleton: Skeleton) -> tuple[tuple[int, ...], ...]:
    """Return the joints of each foot and paw, each from its ankle on, in the skeleton's order.

    Feet are recognised by the names of their joints, or by the shape of the skeleton if the names
    say nothing. Hands count as paws if they are as near to the ground as the feet.
    """
    named = [
        joint
        for joint, name in enumerate(skeleton.names)
        if _EXTREMITY_NAME.search(name) and not _FINGER_NAME.search(name)
    ]
    if not named:
        parts = Anatomy.guess(skeleton).joints
        named = sorted(joint for part, joint in parts.items() if _EXTREMITY_NAME.search(part))
    feet: dict[int, list[int]] = {}
    for joint in named:
        parent = skeleton.parents[joint]
        ankle = next((first for first, foot in feet.items() if parent in foot), joint)
        feet.setdefault(ankle, []).append(joint)
    heights = skeleton.rest.globals(skeleton)[:, 1, 3]
    lowest = {ankle: float(heights[foot].min()) for ankle, foot in feet.items()}
    limit = min(lowest.values(), default=0.0) + _MAX_FOOT_HEIGHT * np.ptp(heights)
    return tuple(tuple(foot) for ankle, foot in feet.items() if lowest[ankle] < limit)


def foot_joints_by_side(skeleton: Skeleton) -> tuple[list[int], list[int]]:
    """Return the joints of all left feet and of all right feet, hands and paws excluded.

    Feet are recognised by name, or by the shape of the skeleton if no joint is named as a foot.
    """
    feet = [
        joint
        for joint, name in enumerate(skeleton.names)
        if "foot" in name.lower() or "toe" in name.lower()
    ]
    left, right = (
        [joint for joint in feet if read_name(skeleton.names[joint]).side == side]
        for side in ("left", "right")
    )
    if feet:
        return left, right
    parts = Anatomy.guess(skeleton).joints
    left, right = (
        [parts[side + part] for part in ("Foot", "Toes") if side + part in parts]
        for side in ("left", "right")
    )
    return left, right
