"""Hips, spine, neck, head, jaw and tail of a skeleton whose limbs are known."""

from collections.abc import Mapping, Sequence

import numpy as np

from cubeling.characters.skeleton.body_parts.joint_tree import JointTree
from cubeling.characters.skeleton.joint_chains import longest_chain_of

_MAX_FARTHER_HIPS = 0.15  # body sizes: how much farther from the thighs a joint named hips may be

Named = Mapping[str, Sequence[int]]
"""Joints by the part of the trunk that their names say, the surest first."""


def find_trunk(tree: JointTree, found: Mapping[str, int]) -> dict[str, int]:
    """Return the parts of the trunk; `found` are the limbs, and declared parts."""
    named = {
        part: sorted(
            (j for j, name in enumerate(tree.names) if name.trunk == part and not name.side),
            key=lambda joint: -tree.names[joint].certainty,
        )
        for part in ("hips", "head", "jaw", "tail", "neck", "chest", "upperChest")
    }
    head = found.get("head", _named_head(tree, named["head"], found))
    hips = found.get("hips", _hips(tree, found, named["hips"], head))
    if hips is None:
        return {}
    trunk = {"hips": hips}
    junction = _junction(tree, hips, found)
    if head is None:
        head = _unnamed_head(tree, hips, junction, found)
    if head is not None and tree.is_below(head, hips) and head != hips:
        trunk["head"] = head
        trunk |= _spine(tree, hips, head, junction, named)
    jaws = [j for j in named["jaw"] if head is not None and tree.is_below(j, head)]
    trunk |= {"jaw": jaws[0]} if jaws else {}
    sure = [joint for joint in named["tail"] if tree.names[joint].certainty == 1.0]
    tail = longest_chain_of(sure or named["tail"], tree.chains)
    return trunk | {f"tail{number}": joint for number, joint in enumerate(tail[:32], 1)}


def _named_head(tree: JointTree, named: Sequence[int], found: Mapping[str, int]) -> int | None:
    """Return the joint named head that shares most of its ancestors with the limbs.

    A target at which the head looks, or a piece of the mesh, may be named so too.
    """
    limbs = [found[p] for p in ("leftUpperLeg", "rightUpperLeg", "leftUpperArm") if p in found]
    shared = {head: sum(len(tree.shared_chain([head, j])) for j in limbs) for head in named}
    return max(named, key=lambda head: (tree.names[head].certainty, shared[head]), default=None)


def _hips(
    tree: JointTree, found: Mapping[str, int], named: Sequence[int], head: int | None
) -> int | None:
    """Return the joint above both legs and the trunk.

    Of several it is one named hips, but none far from the thighs: that is a root on the ground.
    """
    legs = [found[p] for p in ("leftUpperLeg", "rightUpperLeg") if p in found]
    upper = [head] if head is not None else []
    upper = upper or [found[p] for p in ("leftUpperArm", "rightUpperArm") if p in found]
    if not legs + upper:
        return named[0] if named else None
    carriers = [joint for joint in tree.shared_chain(legs + upper) if joint not in legs]
    carrying = [joint for joint in carriers if joint in named]
    if len(legs) < 2:
        return carrying[-1] if carrying else next(iter(named), None)
    if not carriers:
        below = [joint for joint in named if all(tree.is_below(leg, joint) for leg in legs)]
        return below[-1] if below else None
    thighs = tree.positions[legs].mean(0)
    away = {j: float(np.linalg.norm(tree.positions[j] - thighs)) for j in carriers}
    limit = away[carriers[-1]] + _MAX_FARTHER_HIPS * tree.size
    near = [joint for joint in carrying if away[joint] <= limit]
    return near[-1] if near else carriers[-1]


def _junction(tree: JointTree, hips: int, found: Mapping[str, int]) -> int | None:
    """Return the joint from which both arms, or both front legs, branch off."""
    for part in ("Shoulder", "UpperArm", "FrontShoulder", "FrontUpperLeg"):
        both = [found[side + part] for side in ("left", "right") if side + part in found]
        if len(both) == 2:
            shared = [j for j in tree.shared_chain(both) if j not in both]
            common = [joint for joint in shared if tree.is_below(joint, hips)]
            return common[-1] if common else None
    return None


def _unnamed_head(
    tree: JointTree, hips: int, junction: int | None, found: Mapping[str, int]
) -> int | None:
    """Return the end of the highest chain in the middle of the body: an unnamed head."""
    taken = set(found.values())
    middle = [
        joint
        for joint, chain in enumerate(tree.chains)
        if (hips if junction is None else junction) in chain[:-1]
        and not taken.intersection(chain)
        and not tree.names[joint].auxiliary
        and tree.names[joint].trunk != "tail"
        and tree.in_middle(joint)
    ]
    return max(middle, key=lambda j: (len(tree.chains[j]), tree.positions[j, 1]), default=None)


def _spine(
    tree: JointTree, hips: int, head: int, junction: int | None, named: Named
) -> dict[str, int]:
    """Return the joints between hips and head."""
    chain = tree.chains[head]
    between = list(chain[chain.index(hips) + 1 : -1])
    necks = [joint for joint in between if joint in named["neck"]]
    if necks:
        first_neck = between.index(necks[0])
    elif junction in between:
        first_neck = between.index(junction) + 1
    else:
        first_neck = len(between)
    spine, neck = between[:first_neck], between[first_neck:]
    found = {"neck": neck[0]} if neck else {}
    if not spine:
        return found
    chests = [joint for joint in spine if joint in named["chest"]]
    found["spine"] = spine[0]
    if chests and chests[0] != spine[0]:
        above = spine[spine.index(chests[0]) + 1 :]
        return found | {"chest": chests[0]} | ({"upperChest": above[-1]} if above else {})
    if len(spine) == 2:
        found["chest"] = spine[1]
    elif len(spine) > 2:
        found |= {"chest": spine[len(spine) // 2], "upperChest": spine[-1]}
    return found
