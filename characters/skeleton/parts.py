"""Joint numbers of all body parts of a skeleton, by name first, else by shape."""

from collections.abc import Mapping

import numpy as np

from characters.skeleton.fingers import find_fingers
from characters.skeleton.joint_tree import JointTree
from characters.skeleton.limbs import limbs_by_name, limbs_by_shape
from characters.skeleton.pose import Skeleton
from characters.skeleton.trunk import find_trunk

_MAX_TRUNK_SLOPE = 1.0  # rise over run: below it, the trunk is horizontal
_FRONT_OF_ARM = {
    "Shoulder": "FrontShoulder",
    "UpperArm": "FrontUpperLeg",
    "LowerArm": "FrontLowerLeg",
    "Hand": "FrontFoot",
}


def find_parts(skeleton: Skeleton, known: Mapping[str, int]) -> dict[str, int]:
    """Return joint numbers by part, including the `known` ones."""
    tree = JointTree(skeleton)
    found = dict(known)
    _add_missing(found, limbs_by_name(tree))
    _add_missing(found, limbs_by_shape(tree, found))
    _add_missing(found, find_trunk(tree, found))
    if _on_all_fours(tree, found):
        found = {_as_front(part): joint for part, joint in found.items()} | dict(known)
    _add_missing(found, find_fingers(tree, found))
    return found


def _add_missing(found: dict[str, int], more: Mapping[str, int]) -> None:
    """Add parts that are not found yet, of joints that have no part yet."""
    for part, joint in more.items():
        if part not in found and joint not in found.values():
            found[part] = joint


def _on_all_fours(tree: JointTree, found: Mapping[str, int]) -> bool:
    """Return whether the arms are front legs: the hands stand, and the trunk is horizontal."""
    hands = [found[p] for p in ("leftHand", "rightHand") if p in found]
    if not hands or "head" not in found or "hips" not in found:
        return False
    if tree.near_ground(found["hips"]):  # the zero pose of a recording, which does not stand
        return False
    arms = [found.get("leftUpperArm", hands[0]), found.get("leftUpperLeg", hands[0])]
    run = tree.positions[arms[0]] - tree.positions[arms[1]]
    level = abs(float(run[1])) < _MAX_TRUNK_SLOPE * float(np.hypot(run[0], run[2]))
    return level and all(map(tree.near_ground, hands))


def _as_front(part: str) -> str:
    """Return the front-leg part for a part of an arm; other parts are unchanged."""
    for side in ("left", "right"):
        if part.removeprefix(side) in _FRONT_OF_ARM and part.startswith(side):
            return side + _FRONT_OF_ARM[part.removeprefix(side)]
    return part
