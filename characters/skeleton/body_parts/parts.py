"""Joint numbers of all body parts of a skeleton, by name first, else by shape."""

from collections.abc import Mapping

import numpy as np

from cubeling.characters.skeleton.body_parts.fingers import find_fingers
from cubeling.characters.skeleton.body_parts.joint_tree import JointTree
from cubeling.characters.skeleton.body_parts.joint_words import SIDES
from cubeling.characters.skeleton.body_parts.limbs import limbs_by_name, limbs_by_shape
from cubeling.characters.skeleton.body_parts.trunk import find_trunk
from cubeling.characters.skeleton.pose import Skeleton

_MAX_TRUNK_SLOPE = 1.0  # rise over run: below it, the trunk is horizontal
_MAX_HOVERING = 0.5  # hip heights: paws that are farther above the hind feet are hands
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
    if not _stands_in_front(tree, found):
        found = _as_arms(found) | dict(known)
    _add_missing(found, find_trunk(tree, found))
    if _on_all_fours(tree, found):
        found = _as_front_legs(found) | dict(known)
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


def _stands_in_front(tree: JointTree, found: Mapping[str, int]) -> bool:
    """Return whether the front legs reach down as the hind legs do; else they are arms."""
    feet = [found[p] for p in ("leftFoot", "rightFoot") if p in found]
    paws = [found[p] for p in ("leftFrontFoot", "rightFrontFoot") if p in found]
    tops = [found[p] for p in ("leftUpperLeg", "rightUpperLeg") if p in found]
    if not (feet and paws and tops):
        return True
    ground, high = (float(tree.positions[joints, 1].mean()) for joints in (feet, tops))
    hover = float(tree.positions[paws, 1].mean()) - ground
    return hover < _MAX_HOVERING * (high - ground) or high <= ground


def _as_arms(found: Mapping[str, int]) -> dict[str, int]:
    """Return parts with the front legs as arms; hands have no toes."""
    arm_of = {side + front: side + arm for arm, front in _FRONT_OF_ARM.items() for side in SIDES}
    return {
        arm_of.get(part, part): joint for part, joint in found.items() if "FrontToes" not in part
    }


def _as_front_legs(found: Mapping[str, int]) -> dict[str, int]:
    """Return parts with the arms as front legs."""
    leg_of = {side + arm: side + front for arm, front in _FRONT_OF_ARM.items() for side in SIDES}
    return {leg_of.get(part, part): joint for part, joint in found.items()}
