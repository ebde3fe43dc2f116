"""Which joints of a skeleton are its feet."""

from collections.abc import Sequence

import numpy as np

from cubeling.characters.skeleton.anatomy import SIDES, Anatomy
from cubeling.characters.skeleton.body_parts.joint_names import JointName, read_names
from cubeling.characters.skeleton.masks import subtree
from cubeling.characters.skeleton.pose import Skeleton

Feet = Sequence[Sequence[int]]
"""The joints of each foot, from the ankle on; a paw may have one joint only."""

_MAX_FOOT_HEIGHT = 0.15  # body heights above the lowest foot: what is higher is a hand


def find_feet(skeleton: Skeleton) -> tuple[tuple[int, ...], ...]:
    """Return the joints of each foot and paw, each from its ankle on, in the skeleton's order.

    They are those of its anatomy; a body without legs has feet where joints are named so. What
    does not come near the ground is a hand.
    """
    ankles: Sequence[int] = sorted(Anatomy.guess(skeleton).feet)
    if not ankles:
        names = read_names(skeleton.names)
        named = [joint for joint, name in enumerate(names) if _is_foot(name)]
        ankles = [joint for joint in named if skeleton.parents[joint] not in named]
    heights = skeleton.rest.globals(skeleton)[:, 1, 3]
    feet = [tuple(subtree(skeleton, ankle)) for ankle in ankles]
    lowest = [float(heights[list(foot)].min()) for foot in feet]
    limit = min(lowest, default=0.0) + _MAX_FOOT_HEIGHT * float(np.ptp(heights))
    return tuple(foot for foot, height in zip(feet, lowest, strict=True) if height < limit)


def foot_joints_by_side(skeleton: Skeleton) -> tuple[list[int], list[int]]:
    """Return the joints of the left foot and of the right one, the hind feet of an animal."""
    parts = Anatomy.guess(skeleton).joints
    left, right = (
        [parts[side + part] for part in ("Foot", "Toes") if side + part in parts] for side in SIDES
    )
    return left, right


def _is_foot(name: JointName) -> bool:
    return name.leg.get("Foot", 0.0) > 0.5 or name.leg.get("Toes", 0.0) > 0.5
