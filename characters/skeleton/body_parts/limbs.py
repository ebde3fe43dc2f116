"""Arms, legs and eyes of a skeleton, by the names of joints and by its shape.

The parts of a limb are assigned for the chain as a whole, so "Shoulder, Arm, ForeArm, Hand" and
"Collar, Shoulder, Elbow, Wrist" are both read correctly. Where names say only a part of it, the
tree says the rest.
"""

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from cubeling.characters.skeleton.body_parts.joint_names import JointName
from cubeling.characters.skeleton.body_parts.joint_tree import JointTree
from cubeling.characters.skeleton.body_parts.joint_words import ARM_ROLES, LEG_ROLES
from cubeling.characters.skeleton.joint_chains import assign, longest_chain_below

FORELEG_ROLES = ("Shoulder", *LEG_ROLES)
"""Joints of a front leg from the shoulder blade down."""

_END_FIT = 0.05  # of the end of the last bone that has a name, to a foot or hand
_UNNAMED_FIT = 0.1  # of a joint whose name says nothing, to any part of a limb
_SURE_FIT = 0.9  # names that fit so well are of one part only
_SECOND_JOINT_FIT = 0.8  # how well the second joint of a bone fits, relative to its first
_MIN_FOREARM = 0.75  # of the upper arm: a wrist nearer to the elbow is half way to the hand
# Of the bone above: how far from the knee a foot may be that hangs elsewhere in the tree.
_SHIN_LENGTHS = (0.4, 1.8)
_MIN_APART = 0.5  # of a thigh's length: how far hind and front legs are apart at least
_HIP_LINK = 0.5  # of the bone below: shorter bones above a chain of five link it to the body

Fit = Callable[[JointName], Mapping[str, float]]
"""How well a name fits each role of a limb."""


def limbs_by_name(tree: JointTree) -> dict[str, int]:
    """Return the limbs and eyes that are recognised by name, of both sides."""
    found: dict[str, int] = {}
    legs: dict[str, list[dict[str, int]]] = {}
    for side in ("left", "right"):
        mine = [joint for joint in range(len(tree)) if tree.side(joint) == side]
        legs[side] = _legs(tree, mine)
        taken = {joint for leg in legs[side] for joint in leg.values()}
        arms = [j for j in mine if tree.names[j].arm and j not in taken]
        arm = _limb(tree, arms, ARM_ROLES, ARM_ROLES[1:], lambda name: name.arm)
        found |= {side + role: joint for role, joint in _with_wrist(tree, arm).items()}
        eyes = [j for j in mine if tree.names[j].trunk == "Eye"]
        found |= {side + "Eye": eyes[0]} if eyes else {}
    for side, rows in _hind_first(tree, legs).items():
        for row, leg in zip(("", "Front"), rows, strict=False):
            found |= {f"{side}{row}{role}": joint for role, joint in leg.items()}
    return found


def _legs(tree: JointTree, mine: Sequence[int]) -> list[dict[str, int]]:
    """Return the legs of one side: one, or the hind leg and the front leg as far as names tell."""
    legs = [joint for joint in mine if tree.names[joint].hindleg]
    rows = {joint: tree.row(joint) for joint in mine if tree.names[joint].foreleg}
    if not any(row and tree.names[joint].certainty == 1.0 for joint, row in rows.items()):
        leg = _limb(tree, legs, LEG_ROLES, LEG_ROLES[:3], lambda name: name.leg)
        if not {"UpperLeg", "LowerLeg"} <= leg.keys():
            return [leg]
        others = [j for j in legs if not set(leg.values()) & set(tree.chains[j])]
        second = _hindleg(tree, others)
        if not set(LEG_ROLES[:3]) <= second.keys() or not _are_apart(tree, leg, second):
            return [leg]
        return [_hindleg(tree, [joint for joint in legs if joint not in others]), second]
    front_named = "front" in rows.values()
    other_row = "hind" if front_named else "front"
    hind = [j for j in legs if (rows[j] or other_row) == "hind"]
    fore = [j for j in rows if (rows[j] or other_row) == "front" or tree.names[j].arm]
    roles = FORELEG_ROLES
    front = _limb(tree, fore, roles, roles[1:4], lambda name: name.foreleg)
    return [_hindleg(tree, hind), front]


def _are_apart(tree: JointTree, leg: Mapping[str, int], other: Mapping[str, int]) -> bool:
    """Return whether two legs begin at two places; a leg may have joints twice, for control."""
    thigh = tree.distance(leg["UpperLeg"], leg["LowerLeg"])
    return tree.distance(leg["UpperLeg"], other["UpperLeg"]) > _MIN_APART * thigh


def _hindleg(tree: JointTree, joints: Sequence[int]) -> dict[str, int]:
    return _limb(tree, joints, LEG_ROLES, LEG_ROLES[:3], lambda name: name.hindleg)


def _hind_first(
    tree: JointTree, legs: Mapping[str, list[dict[str, int]]]
) -> dict[str, list[dict[str, int]]]:
    """Return the legs of each side, hind legs first; names or the way to the head tell."""
    ordered: dict[str, list[dict[str, int]]] = {}
    heads = [j for j, name in enumerate(tree.names) if name.trunk == "head"]
    for side, rows in legs.items():
        tops = [next(iter(leg.values()), -1) for leg in rows]
        named = any(tree.row(joint) for leg in rows for joint in leg.values())
        if len(rows) == 2 and min(tops) >= 0 and not named:
            keys = [
                (
                    len(tree.shared_chain([top, heads[0]])) if heads else 0,
                    -tree.distance(top, heads[0]) if heads else float(tree.positions[top, 2]),
                )
                for top in tops
            ]
            rows = rows if keys[0] < keys[1] else rows[::-1]
        ordered[side] = rows
    return ordered


def _limb(
    tree: JointTree,
    joints: Sequence[int],
    roles: Sequence[str],
    essential: Sequence[str],
    fit: Fit,
) -> dict[str, int]:
    """Return the joints of one limb by role: of the chain of joints whose names fit best."""
    ends = [j for j in range(len(tree)) if tree.names[j].end and tree.parents[j] in joints]
    among = {*joints, *(j for j in ends if tree.distance(j, tree.parents[j]) > 0)}
    best: tuple[float, dict[str, int]] = (0.0, {})
    for end in sorted(among):
        chain = [joint for joint in tree.chains[end] if joint in among]
        fits = _fits(tree, chain, fit)
        if end in ends:
            fits[-1] = {essential[-1]: _END_FIT}
        best = max(best, assign(chain, roles, essential, fits), key=_score)
    found = best[1]
    top, middle, end_joint = (found.get(role) for role in essential)
    apart = end_joint is None or tree.names[end_joint].end
    if apart and top is not None and middle is not None:
        found |= _detached_end(tree, top, middle, essential[-1])
    if found and not set(essential) <= found.keys():
        found = max(best, _assign_unnamed(tree, found, roles, essential, fit), key=_score)[1]
    joints = list(found.values())
    if len(joints) == 1 and essential[0] in fit(tree.names[joints[0]]):  # one for the whole limb
        return {essential[0]: joints[0]}
    return found


def _score(option: tuple[float, dict[str, int]]) -> float:
    return option[0]


def _fits(tree: JointTree, chain: Sequence[int], fit: Fit) -> list[Mapping[str, float]]:
    """Return how well each joint of a chain fits each role; less for the second of one bone."""
    fits = [fit(tree.names[joint]) for joint in chain]
    sure = [{role for role, value in each.items() if value >= _SURE_FIT} for each in fits]
    return [
        {role: value * _SECOND_JOINT_FIT for role, value in each.items()}
        if number and sure[number] and sure[number] == sure[number - 1]
        else each
        for number, each in enumerate(fits)
    ]


def _assign_unnamed(
    tree: JointTree,
    found: Mapping[str, int],
    roles: Sequence[str],
    essential: Sequence[str],
    fit: Fit,
) -> tuple[float, dict[str, int]]:
    """Return an assignment of a chain in which only some joints are named, and its score."""
    top, bottom = min(found.values()), max(found.values())
    side = tree.side(top)
    above = [j for j in tree.chains[top][:-1] if tree.side(j) == side and tree.is_of_one_side(j)]
    between = [j for j in tree.chains[bottom] if tree.is_below(j, top)]
    chain = [*above, *between, *longest_chain_below(bottom, tree.children)[1:]]
    chain = [j for j in chain if not tree.names[j].auxiliary]
    fits = [
        fit(tree.names[j]) or ({} if tree.names[j].known else dict.fromkeys(roles, _UNNAMED_FIT))
        for j in chain
    ]
    return assign(chain, roles, essential, fits)


def _detached_end(tree: JointTree, hip: int, knee: int, role: str) -> dict[str, int]:
    """Return the foot and toes, or hand, that hang elsewhere in the tree, where a shin would end.

    So it is in rigs with inverse kinematics.
    """
    thigh = tree.positions[knee] - tree.positions[hip]
    low, high = np.array(_SHIN_LENGTHS) * float(np.linalg.norm(thigh))
    rows = {tree.row(knee), ""}
    ends = [
        joint
        for joint, name in enumerate(tree.names)
        if name.as_end_of_limb(role)
        and tree.side(joint) == tree.side(knee)
        and tree.row(joint) in rows
        and not tree.is_below(joint, hip)
        and joint not in tree.chains[hip]
        and low < tree.distance(joint, knee) < high
        and float((tree.positions[joint] - tree.positions[knee]) @ thigh) > 0
    ]
    if not ends:
        return {}
    end = max(ends, key=lambda joint: tree.names[joint].as_end_of_limb(role))
    toes = [j for j in tree.children.get(end, ()) if tree.names[j].leg.get("Toes", 0.0) > 0.5]
    return {role: end} | ({"Toes": toes[0]} if toes and role == "Foot" else {})


def _with_wrist(tree: JointTree, arm: Mapping[str, int]) -> dict[str, int]:
    """Return an arm whose hand turns at the wrist, if there is a joint for it above the hand."""
    if not {"UpperArm", "LowerArm", "Hand"} <= arm.keys():
        return dict(arm)
    elbow, wrist = arm["LowerArm"], tree.parents[arm["Hand"]]
    upper = tree.distance(arm["UpperArm"], elbow)
    named = wrist != elbow and "Hand" in tree.names[wrist].arm
    if named and tree.distance(elbow, wrist) > _MIN_FOREARM * upper:
        return {**arm, "Hand": wrist}
    return dict(arm)


def limbs_by_shape(tree: JointTree, found: Mapping[str, int]) -> dict[str, int]:
    """Return limbs that names do not tell, beyond the `found` ones: mirrored chains of joints."""
    named = set(found.values())
    every = [pair for pair in tree.mirrored_chains() if not named & {*pair[0], *pair[1]}]
    pairs = [pair for pair in every if len(pair[0]) >= 3]
    legs = [pair for pair in pairs if any(map(tree.near_ground, pair[0][:5]))]
    shapes: dict[str, int] = {}
    if not {"leftUpperLeg", "rightUpperLeg"} <= found.keys():
        standing = legs or [
            pair for pair in every if len(pair[0]) == 2 and tree.reaches_down(*pair[0])
        ]
        standing.sort(key=lambda pair: float(tree.positions[pair[0][0], 2]))
        if len(standing) > 1:
            shapes |= _as_limbs(tree, standing[-1], [f"Front{role}" for role in LEG_ROLES])
        if standing:
            shapes |= _as_limbs(tree, standing[0], LEG_ROLES)
    heads = {joint for joint, name in enumerate(tree.names) if name.trunk == "head"}
    arms = [pair for pair in pairs if pair not in legs and not heads & set(tree.chains[pair[0][0]])]
    if arms and not any(part.endswith(("UpperArm", "FrontUpperLeg")) for part in found):
        both = max(arms, key=lambda pair: tree.length(pair[0]))  # ears and hair are shorter
        roles = ARM_ROLES if len(both[0]) > 3 else ARM_ROLES[1:]
        shapes |= {
            side + role: joint
            for side, chain in zip(("left", "right"), both, strict=True)
            for role, joint in zip(roles, chain, strict=False)
        }
    return shapes


def _as_limbs(
    tree: JointTree, pair: tuple[Sequence[int], Sequence[int]], roles: Sequence[str]
) -> dict[str, int]:
    """Return a left and a right chain as legs."""
    found: dict[str, int] = {}
    for side, whole in zip(("left", "right"), pair, strict=True):
        chain = list(whole)
        if len(chain) > len(roles):
            link, thigh = tree.distance(*chain[:2]), tree.distance(*chain[1:3])
            chain = chain[1:] if link < _HIP_LINK * thigh else chain
        found |= {side + role: joint for role, joint in zip(roles, chain, strict=False)}
    return found
