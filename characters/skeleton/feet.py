"""Which joints are the feet of a skeleton."""

import re

from characters.skeleton.anatomy import Anatomy
from characters.skeleton.pose import Skeleton

# "LeftFoot", "foot_l", "Foot.L.001", "FootL" and their like.
_LEFT = re.compile(r"(?i:left|(?:^|[._\s])l(?:[._\s]|$))|[a-z]L(?:$|[^a-z])")
_RIGHT = re.compile(r"(?i:right|(?:^|[._\s])r(?:[._\s]|$))|[a-z]R(?:$|[^a-z])")


def find_feet(skeleton: Skeleton) -> tuple[list[int], list[int]]:
    """Return the joints of the left and the right foot: by their names, else by their place."""
    feet = [
        joint
        for joint, name in enumerate(skeleton.names)
        if "foot" in name.lower() or "toe" in name.lower()
    ]
    left = [joint for joint in feet if _LEFT.search(skeleton.names[joint])]
    right = [joint for joint in feet if _RIGHT.search(skeleton.names[joint])]
    if feet:
        return left, right
    parts = Anatomy.guess(skeleton).joints
    left, right = (
        [parts[side + part] for part in ("Foot", "Toes") if side + part in parts]
        for side in ("left", "right")
    )
    return left, right
