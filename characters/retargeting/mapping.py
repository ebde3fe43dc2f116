"""Which joints of a source drive each joint of a target.

Limbs are matched by body part. Chains that may have different numbers of joints (spine, neck,
tail) are matched by the position along the chain: where four joints follow two, each takes its
share of the bend.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.errors import CharacterError
from cubeling.characters.retargeting.rig import Rig, leg_pairs
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.pose import Array

_LIMB_BONES = (
    (("UpperArm", "LowerArm"), ("LowerArm", "Hand")),
    (("UpperLeg", "LowerLeg"), ("LowerLeg", "Foot")),
)
_TRUNK_PARTS = ("hips", "spine", "chest", "upperChest", "neck", "head")

Links = dict[int, tuple[int, int, float]]
"""Two joints of the source, and how far from the first to the second, by joint of the target."""


@dataclass(frozen=True)
class JointMapping:
    """Which two joints of the source drive each mapped joint, and how their share is divided."""

    joints: NDArray[np.intp]
    """Joints of the target, (n,), parents first."""

    sources: NDArray[np.intp]
    """Two joints of the source for each, (n, 2)."""

    shares: Array
    """Share of the second one, (n,), 0…1."""

    corrections: Array
    """Rotations (n, 4) from the target's rest pose to the source's, in the common axes."""


def map_joints(source: Rig, target: Rig) -> JointMapping:
    """Return how the joints of a target follow those of a source; refuse rigs of two kinds."""
    _require_same_kind(source, target)
    links: Links = {joint: (driver, driver, 0.0) for joint, driver in _pairs(source, target)}
    links |= _chain_links(source, target)
    joints = sorted(links)
    corrections = _rest_corrections(source, target)
    return JointMapping(
        np.array(joints),
        np.array([links[joint][:2] for joint in joints]),
        np.array([links[joint][2] for joint in joints]),
        np.array([corrections.get(joint, rotations.IDENTITY) for joint in joints]),
    )


def _require_same_kind(source: Rig, target: Rig) -> None:
    for role, rig in (("source", source), ("target", target)):
        if rig.anatomy.joint("hips") is None or rig.anatomy.kind == "other":
            raise CharacterError(
                f"retargeting: the {role} is neither a person nor a quadruped "
                f"(found: {', '.join(rig.anatomy.joints) or 'none'}); say which joints are hips, "
                "legs and head in a [joints] table"
            )
    if source.anatomy.kind != target.anatomy.kind:
        raise CharacterError(
            f"retargeting: the motion is of a {source.anatomy.kind} and the character is a "
            f"{target.anatomy.kind}; use a motion of the same kind"
        )


def _pairs(source: Rig, target: Rig) -> list[tuple[int, int]]:
    """Return pairs of joints with the same body part, or without one but with the same name."""
    source_parts, target_parts = source.anatomy.parts, target.anatomy.parts
    by_name = {name: joint for joint, name in enumerate(source.skeleton.names)}
    unnamed_parts = [
        (joint, by_name[name])
        for joint, name in enumerate(target.skeleton.names)
        if name in by_name
        and joint not in target_parts
        and by_name[name] not in source_parts
        and _is_below_hips(target, joint)
        and _is_below_hips(source, by_name[name])
    ]
    return unnamed_parts + [
        (joint, source.anatomy.joints[part])
        for part, joint in target.anatomy.joints.items()
        if part in source.anatomy.joints
        and part not in _TRUNK_PARTS
        and not part.startswith("tail")
    ]


def _is_below_hips(rig: Rig, joint: int) -> bool:
    """Return whether a joint is below the hips; joints above them place the body."""
    return rig.anatomy.joints["hips"] in rig.chain_to(joint)[:-1]


def _chain_links(source: Rig, target: Rig) -> Links:
    """Return what the joints of trunk and tail follow."""
    links: Links = {}
    for followers, drivers in zip(*_trunk_segments(target, source), strict=True):
        links |= _follow(followers, drivers)
    tails = [
        [rig.anatomy.joints[part] for part in rig.anatomy.joints if part.startswith("tail")]
        for rig in (target, source)
    ]
    if all(tails):
        links |= _follow(*tails)
    return links


def _trunk_segments(*rigs: Rig) -> tuple[list[list[int]], ...]:
    """Return the trunk of each rig, cut at the parts that all of them have, ends included."""
    trunks = [_trunk(rig) for rig in rigs]
    cuts: list[list[int]] = [[] for _ in rigs]
    candidates = [[rig.anatomy.joint(part) for rig in rigs] for part in ("hips", "neck", "head")]
    candidates.insert(1, [_top_of_spine(rig) for rig in rigs])
    for joints in candidates:
        if all(j is not None and j in trunk for j, trunk in zip(joints, trunks, strict=True)):
            for cut, joint, trunk in zip(cuts, joints, trunks, strict=True):
                cut.append(trunk.index(joint) if joint is not None else 0)
    return tuple(
        [trunk[a : b + 1] for a, b in zip(cut, [*cut[1:], cut[-1]], strict=True)]
        for trunk, cut in zip(trunks, cuts, strict=True)
    )


def _trunk(rig: Rig) -> list[int]:
    """Return the joints from the hips to the head, or as far up as there are any."""
    present = [j for part in _TRUNK_PARTS if (j := rig.anatomy.joint(part)) is not None]
    chain = rig.chain_to(max(present, key=lambda joint: len(rig.chain_to(joint))))
    hips = rig.anatomy.joints["hips"]
    return chain[chain.index(hips) :] if hips in chain else [hips]


def _top_of_spine(rig: Rig) -> int | None:
    present = [j for part in _TRUNK_PARTS[1:4] if (j := rig.anatomy.joint(part)) is not None]
    return present[-1] if present else None


def _follow(followers: Sequence[int], drivers: Sequence[int]) -> Links:
    """Return what the joints of a chain follow in a chain of another length, by their order."""
    links: Links = {}
    for number, joint in enumerate(followers):
        position = number / max(len(followers) - 1, 1) * (len(drivers) - 1)
        first = min(int(position), len(drivers) - 1)
        second = min(first + 1, len(drivers) - 1)
        links[joint] = (drivers[first], drivers[second], position - first)
    return links


def _rest_corrections(source: Rig, target: Rig) -> dict[int, Array]:
    """Return by joint the rotation from the target's rest pose to the source's.

    The limbs of people are aligned bone by bone, so it does not matter whether a model rests with
    its arms out or down. Trunks are upright in any rest pose and keep their own curves.
    Quadrupeds rest standing and keep their own stance.
    """
    corrections: dict[int, Array] = {}
    if target.anatomy.kind != "humanoid":
        return corrections
    for side in ("left", "right"):
        for bones in _LIMB_BONES:
            turn = rotations.IDENTITY
            for start, end in bones:
                own = target.direction(side + start, side + end)
                other = source.direction(side + start, side + end)
                joint = target.anatomy.joint(side + start)
                if own is not None and other is not None:
                    aligned = rotations.between(rotations.rotate(turn, own), other)
                    turn = rotations.multiply(aligned, turn)
                if joint is not None:  # a bone whose end is unknown goes on like the one above
                    corrections[joint] = turn
            hand = target.anatomy.joint(side + bones[-1][1])
            if hand is not None and bones[-1][1] == "Hand":  # hand and fingers follow the arm
                parts = target.anatomy.joints.values()
                corrections |= {j: turn for j in parts if hand in target.chain_to(j)}
    for theirs, own_leg in leg_pairs(source, target):
        flat = rotations.multiply(
            source.flat_foot(theirs), rotations.conjugate(target.flat_foot(own_leg))
        )
        corrections |= {j: flat for j in (own_leg.foot, own_leg.toes) if j is not None}
    return corrections
