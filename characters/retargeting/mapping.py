"""Which joint of one body moves which joint of another.

Limbs are joined part by part. Chains that may have different numbers of joints (spine, neck,
tail) are joined by how far along they are: where four joints follow two, each takes its share of
the bend.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from characters.errors import CharacterError
from characters.retargeting.body import Body
from characters.skeleton import rotations
from characters.skeleton.pose import Array

_LIMB = (
    (("UpperArm", "LowerArm"), ("LowerArm", "Hand")),
    (("UpperLeg", "LowerLeg"), ("LowerLeg", "Foot")),
)
_TRUNK = ("hips", "spine", "chest", "upperChest", "neck", "head")


@dataclass(frozen=True)
class Mapping:
    """For each joint that is moved: between which two joints of the source, and how far."""

    joints: NDArray[np.intp]
    """Joints of the target, (n,), parents first."""

    sources: NDArray[np.intp]
    """Two joints of the source for each, (n, 2)."""

    shares: Array
    """How far from the first to the second, (n,), 0…1."""

    corrections: Array
    """Rotations (n, 4) that bring the target's rest pose to the source's, in the common axes."""


def map_joints(source: Body, target: Body) -> Mapping:
    """Return how the joints of a body follow those of another.

    Raises
    ------
    CharacterError
        If the bodies are of different kinds, or one has no hips.
    """
    _require_same_kind(source, target)
    links = {joint: (one, one, 0.0) for joint, one in _shared(source, target)}
    links |= _chains(source, target)
    joints = sorted(links)
    corrections = _corrections(source, target)
    return Mapping(
        np.array(joints),
        np.array([links[joint][:2] for joint in joints]),
        np.array([links[joint][2] for joint in joints]),
        np.array([corrections.get(joint, rotations.IDENTITY) for joint in joints]),
    )


def _require_same_kind(source: Body, target: Body) -> None:
    for role, body in (("source", source), ("target", target)):
        if body.part("hips") is None or body.anatomy.kind == "other":
            raise CharacterError(
                f"retargeting: the {role} has neither a person's nor a quadruped's joints "
                f"(found: {', '.join(body.anatomy.joints) or 'none'}); say which joints are hips, "
                "legs and head in a [joints] table"
            )
    if source.anatomy.kind != target.anatomy.kind:
        raise CharacterError(
            f"retargeting: the motion is a {source.anatomy.kind}'s and the character is a "
            f"{target.anatomy.kind}; take a motion of its kind"
        )


def _shared(source: Body, target: Body) -> list[tuple[int, int]]:
    """Return pairs of joints that are the same part, or nothing but have the same name."""
    parts = (source.anatomy.parts, target.anatomy.parts)
    names = {name: joint for joint, name in enumerate(source.skeleton.names)}
    strands = [
        (joint, names[name])
        for joint, name in enumerate(target.skeleton.names)
        if name in names
        and joint not in parts[1]
        and names[name] not in parts[0]
        and target.skeleton.parents[joint] >= 0
        and _carried(target, joint)
        and _carried(source, names[name])
    ]
    return strands + [
        (joint, source.anatomy.joints[part])
        for part, joint in target.anatomy.joints.items()
        if part in source.anatomy.joints and part not in _TRUNK and not part.startswith("tail")
    ]


def _carried(body: Body, joint: int) -> bool:
    """Return whether a joint hangs on the hips; what is above them places the body."""
    return body.anatomy.joints["hips"] in body.line(joint)[:-1]


def _chains(source: Body, target: Body) -> dict[int, tuple[int, int, float]]:
    """Return what the joints of trunk and tail follow."""
    links: dict[int, tuple[int, int, float]] = {}
    for mine, theirs in zip(*_segments(target, source), strict=True):
        links |= _follow(mine, theirs)
    tails = [
        [body.anatomy.joints[part] for part in body.anatomy.joints if part.startswith("tail")]
        for body in (target, source)
    ]
    if all(tails):
        links |= _follow(*tails)
    return links


def _segments(*bodies: Body) -> tuple[list[list[int]], ...]:
    """Return the trunk of each body, cut at the parts that all of them have, ends included."""
    tops = [_top_of_spine(body) for body in bodies]
    lines = [_trunk(body) for body in bodies]
    marks: list[list[int]] = [[] for _ in bodies]
    named = [[body.part(part) for body in bodies] for part in ("hips", "neck", "head")]
    named.insert(1, tops)
    for joints in named:
        if all(j is not None and j in line for j, line in zip(joints, lines, strict=True)):
            for mark, joint, line in zip(marks, joints, lines, strict=True):
                mark.append(line.index(joint) if joint is not None else 0)
    return tuple(
        [line[a : b + 1] for a, b in zip(mark, [*mark[1:], mark[-1]], strict=True)]
        for line, mark in zip(lines, marks, strict=True)
    )


def _trunk(body: Body) -> list[int]:
    """Return the joints from the hips to the head, or as far up as there are any."""
    present = [j for part in _TRUNK if (j := body.part(part)) is not None]
    line = body.line(max(present, key=lambda joint: len(body.line(joint))))
    hips = body.part("hips")
    return line[line.index(hips) :] if hips in line else [j for j in (hips,) if j is not None]


def _top_of_spine(body: Body) -> int | None:
    there = [j for part in _TRUNK[1:4] if (j := body.part(part)) is not None]
    return there[-1] if there else None


def _follow(mine: Sequence[int], theirs: Sequence[int]) -> dict[int, tuple[int, int, float]]:
    """Return what the joints of a chain follow in a chain of another length, by their order."""
    links: dict[int, tuple[int, int, float]] = {}
    for number, joint in enumerate(mine):
        at = number / max(len(mine) - 1, 1) * (len(theirs) - 1)
        first = min(int(at), len(theirs) - 1)
        second = min(first + 1, len(theirs) - 1)
        links[joint] = (theirs[first], theirs[second], at - first)
    return links


def _corrections(source: Body, target: Body) -> dict[int, Array]:
    """Return by joint the rotation that brings the target's rest pose to the source's.

    A person's limbs are laid along each other, bone by bone, so that it does not matter whether a
    model rests with its arms out or down. Trunks stand upright in any rest pose and keep their
    own curves. A quadruped rests standing: it keeps its own stance.
    """
    found: dict[int, Array] = {}
    if target.anatomy.kind != "humanoid":
        return found
    for side in ("left", "right"):
        for bones in _LIMB:
            turn = rotations.IDENTITY
            for start, end in bones:
                mine = target.direction(side + start, side + end)
                other = source.direction(side + start, side + end)
                joint = target.part(side + start)
                if mine is None or other is None or joint is None:
                    break
                aligned = rotations.between(rotations.rotate(turn, mine), other)
                turn = rotations.multiply(aligned, turn)
                found[joint] = turn
            found |= _beyond(target, side, bones[-1][1], turn)
    feet = {leg.foot: leg for leg in target.legs}
    for ours in source.legs:
        part = source.anatomy.parts[ours.foot]
        leg = feet.get(target.anatomy.joints.get(part, -1))
        if leg is not None:
            flat = rotations.multiply(source.sole(ours), rotations.conjugate(target.sole(leg)))
            found |= {j: flat for j in (leg.foot, leg.toes) if j is not None}
    return found


def _beyond(body: Body, side: str, end: str, turn: Array) -> dict[int, Array]:
    """Return the correction of the hand and its fingers: that of the arm."""
    hand = body.part(side + end)
    if hand is None or end != "Hand":
        return {}
    return {j: turn for j in body.anatomy.joints.values() if hand in body.line(j)}
