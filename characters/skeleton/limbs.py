"""Limbs and trunk of a skeleton, found by joint names first, else by the shape of the skeleton.

The parts of a limb are assigned for the chain as a whole, so "Shoulder, Arm, ForeArm, Hand" and
"Collar, Shoulder, Elbow, Wrist" are both read correctly.
"""

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from characters.skeleton.joint_chains import (
    assign,
    chains_to_root,
    children_of,
    longest_chain_below,
    longest_chain_of,
)
from characters.skeleton.joint_names import ARM_ROLES, LEG_ROLES, JointName, read_name
from characters.skeleton.pose import Array, Skeleton

_MIN_SIDE_OFFSET = 0.02  # body sizes from the middle: beyond it, a joint has a side
_MAX_FOOT_HEIGHT = 0.2  # body heights: limbs that end below it are legs
_MAX_TRUNK_SLOPE = 1.0  # rise over run: below it, the trunk is horizontal
_FINGER_PARTS: tuple[str, ...] = ("Proximal", "Intermediate", "Distal")
_THUMB_PARTS = ("Metacarpal", "Proximal", "Distal")


def find_parts(skeleton: Skeleton, known: Mapping[str, int]) -> dict[str, int]:
    """Return joint numbers by part, including the `known` ones."""
    return _PartSearch(skeleton, known).run()


class _PartSearch:
    def __init__(self, skeleton: Skeleton, known: Mapping[str, int]) -> None:
        self.skeleton = skeleton
        self.known = dict(known)
        self.positions: Array = skeleton.rest.globals(skeleton)[:, :3, 3]
        self.names = [read_name(name) for name in skeleton.names]
        self.chains = chains_to_root(skeleton.parents)
        low, high = self.positions.min(0), self.positions.max(0)
        self.size = float(np.linalg.norm(high - low)) or 1.0
        self.ground, self.height = float(low[1]), float(high[1] - low[1]) or 1.0

    def run(self) -> dict[str, int]:
        """Return joint numbers by part."""
        found = dict(self.known)
        for side in ("left", "right"):
            _add_missing(found, self._limbs_by_name(side))
        if not {"leftUpperLeg", "rightUpperLeg"} <= set(found):
            _add_missing(found, self._limbs_by_shape())
        _add_missing(found, self._trunk(found))
        if self._on_all_fours(found):
            found = {_as_front(part): joint for part, joint in found.items()} | self.known
        for side in ("left", "right"):
            _add_missing(found, self._fingers(side))
        return found

    def _side(self, joint: int) -> str:
        """Return the side of a joint: by its name, its ancestors' names, or its position."""
        for above in reversed(self.chains[joint]):
            if self.names[above].side:
                return self.names[above].side
        offset = float(self.positions[joint, 0])
        if abs(offset) < _MIN_SIDE_OFFSET * self.size:
            return ""
        return "left" if offset > 0 else "right"

    def _limbs_by_name(self, side: str) -> dict[str, int]:
        """Return the limbs and the eye of one side that are recognised by name."""
        mine = [joint for joint in range(len(self.names)) if self._side(joint) == side]
        found: dict[str, int] = {}
        front = any(self.names[joint].front for joint in mine)
        legs = [j for j in mine if self.names[j].leg and not self.names[j].front]
        found |= self._limb(side, legs, LEG_ROLES, LEG_ROLES[:3], lambda name: name.leg)
        if front:
            fore = [j for j in mine if self.names[j].front or self.names[j].arm]
            roles = tuple(f"Front{role}" for role in ("Shoulder", *LEG_ROLES))
            found |= self._limb(side, fore, roles, roles[1:4], _front_fit)
        arms = [j for j in mine if self.names[j].arm and j not in found.values()]
        found |= self._limb(side, arms, ARM_ROLES, ARM_ROLES[1:], lambda name: name.arm)
        eyes = [j for j in mine if self.names[j].trunk == "Eye"]
        return found | ({side + "Eye": eyes[0]} if eyes else {})

    def _limb(
        self,
        side: str,
        joints: Sequence[int],
        roles: Sequence[str],
        essential: Sequence[str],
        fit: Callable[[JointName], Mapping[str, float]],
    ) -> dict[str, int]:
        """Return the best assignment of one chain of joints to the roles of a limb."""
        best: tuple[float, dict[str, int]] = (0.0, {})
        for end in joints:
            chain = [joint for joint in self.chains[end] if joint in joints]
            scored = assign(chain, roles, essential, [fit(self.names[j]) for j in chain])
            best = max(best, scored, key=lambda option: option[0])
        found = {side + role: joint for role, joint in best[1].items()}
        if found:  # in rigs with inverse kinematics the foot may have another parent
            for role in roles:
                for joint in joints:
                    exact = fit(self.names[joint]).get(role, 0.0) >= 1.0
                    if exact and side + role not in found and joint not in found.values():
                        found[side + role] = joint
        return found

    def _limbs_by_shape(self) -> dict[str, int]:
        """Return the limbs of a skeleton with uninformative names: mirrored chains of joints."""
        found: dict[str, int] = {}
        pairs = [pair for pair in self._mirrored_chains() if len(pair[0]) >= 3]
        low = self.ground + _MAX_FOOT_HEIGHT * self.height
        legs = [p for p in pairs if min(self.positions[j, 1] for j in p[0]) < low]
        legs.sort(key=lambda pair: float(self.positions[pair[0][0], 2]))
        arms = [pair for pair in pairs if pair not in legs]
        if len(legs) > 1:
            fore = tuple(f"Front{role}" for role in LEG_ROLES)
            found |= _as_limbs(legs[-1], fore)
        if legs:
            found |= _as_limbs(legs[0], LEG_ROLES)
        arms.sort(key=lambda pair: float(self.positions[pair[0][0], 1]))
        if arms:
            roles = ARM_ROLES if len(arms[-1][0]) > 3 else ARM_ROLES[1:]
            found |= _as_limbs(arms[-1], roles)
        return found

    def _mirrored_chains(self) -> list[tuple[list[int], list[int]]]:
        """Return pairs of chains, left and right, that have one parent and mirror each other."""
        children = children_of(self.skeleton.parents)
        near = 3 * _MIN_SIDE_OFFSET * self.size
        pairs: list[tuple[list[int], list[int]]] = []
        for siblings in children.values():
            for left in siblings:
                for right in siblings:
                    image = self.positions[right] * [-1.0, 1.0, 1.0]
                    apart = float(np.linalg.norm(self.positions[left] - image))
                    both = self.positions[left, 0] > near / 3 > 0 > self.positions[right, 0]
                    if both and apart < near:
                        pairs.append(
                            (
                                longest_chain_below(left, children)[:4],
                                longest_chain_below(right, children)[:4],
                            )
                        )
        return pairs

    def _trunk(self, found: Mapping[str, int]) -> dict[str, int]:
        """Return hips, spine, neck, head, jaw and tail."""
        named = {
            part: [j for j, name in enumerate(self.names) if name.trunk == part and not name.side]
            for part in ("hips", "head", "jaw", "tail", "neck", "chest", "upperChest")
        }
        head = next(iter(named["head"]), None) if "head" not in found else found["head"]
        hips = found.get("hips", self._hips(found, named["hips"], head))
        if hips is None:
            return {}
        trunk = {"hips": hips}
        junction = self._junction(hips, found)
        if head is None:
            head = self._unnamed_head(hips, junction, found)
        if head is not None and hips in self.chains[head] and head != hips:
            trunk["head"] = head
            trunk |= self._spine(hips, head, junction, named)
        jaws = [j for j in named["jaw"] if head is not None and head in self.chains[j]]
        trunk |= {"jaw": jaws[0]} if jaws else {}
        tail = longest_chain_of(named["tail"], self.chains)
        return trunk | {f"tail{number}": joint for number, joint in enumerate(tail[:32], 1)}

    def _hips(self, found: Mapping[str, int], named: Sequence[int], head: int | None) -> int | None:
        """Return the joint above both legs and the trunk."""
        legs = [found[p] for p in ("leftUpperLeg", "rightUpperLeg") if p in found]
        upper = [head] if head is not None else []
        upper = upper or [found[p] for p in ("leftUpperArm", "rightUpperArm") if p in found]
        carried = [self.chains[joint] for joint in legs + upper]
        for joint in named:
            if carried and all(joint in chain for chain in carried):
                return joint
        if len(legs) < 2:
            return named[0] if named else None
        common = [j for j in carried[0] if all(j in chain for chain in carried)]
        below = [j for j in common if j not in legs]
        return below[-1] if below else None

    def _junction(self, hips: int, found: Mapping[str, int]) -> int | None:
        """Return the joint from which both arms, or both front legs, branch off."""
        for part in ("Shoulder", "UpperArm", "FrontShoulder", "FrontUpperLeg"):
            both = [found[side + part] for side in ("left", "right") if side + part in found]
            if len(both) == 2:
                left, right = (self.chains[joint][:-1] for joint in both)
                common = [j for j in left if j in right and hips in self.chains[j]]
                return common[-1] if common else None
        return None

    def _unnamed_head(
        self, hips: int, junction: int | None, found: Mapping[str, int]
    ) -> int | None:
        """Return the end of the highest chain in the middle of the body: an unnamed head."""
        taken = set(found.values())
        middle = [
            joint
            for joint, chain in enumerate(self.chains)
            if (hips if junction is None else junction) in chain[:-1]
            and not taken.intersection(chain)
            and not self.names[joint].auxiliary
            and self.names[joint].trunk != "tail"
            and abs(self.positions[joint, 0]) < _MIN_SIDE_OFFSET * self.size
        ]
        return max(middle, key=lambda j: (len(self.chains[j]), self.positions[j, 1]), default=None)

    def _spine(
        self, hips: int, head: int, junction: int | None, named: Mapping[str, Sequence[int]]
    ) -> dict[str, int]:
        """Return the joints between hips and head."""
        chain = self.chains[head]
        between = chain[chain.index(hips) + 1 : -1]
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

    def _on_all_fours(self, found: Mapping[str, int]) -> bool:
        """Return whether the arms are front legs: the hands stand, and the trunk is horizontal."""
        hands = [found[p] for p in ("leftHand", "rightHand") if p in found]
        if not hands or "head" not in found or "hips" not in found:
            return False
        low = self.ground + _MAX_FOOT_HEIGHT * self.height
        arms = [found.get("leftUpperArm", hands[0]), found.get("leftUpperLeg", hands[0])]
        run = self.positions[arms[0]] - self.positions[arms[1]]
        level = abs(float(run[1])) < _MAX_TRUNK_SLOPE * float(np.hypot(run[0], run[2]))
        return level and all(self.positions[hand, 1] < low for hand in hands)

    def _fingers(self, side: str) -> dict[str, int]:
        found: dict[str, int] = {}
        joints = [j for j, name in enumerate(self.names) if name.finger and self._side(j) == side]
        for finger in ("Thumb", "Index", "Middle", "Ring", "Little"):
            chain = longest_chain_of(
                [j for j in joints if self.names[j].finger == finger], self.chains
            )
            parts = _FINGER_PARTS
            if finger == "Thumb":  # the metacarpal is seldom rigged
                parts = _THUMB_PARTS if len(chain) > 2 else _THUMB_PARTS[1:]
            found |= {side + finger + p: j for p, j in zip(parts, chain, strict=False)}
        return found


def _add_missing(found: dict[str, int], more: Mapping[str, int]) -> None:
    """Add parts that are not found yet, of joints that have no part yet."""
    for part, joint in more.items():
        if part not in found and joint not in found.values():
            found[part] = joint


def _front_fit(name: JointName) -> Mapping[str, float]:
    """Return how well a name fits each role of a front leg, 0…1."""
    arm = {f"Front{role}": fit for role, fit in name.arm.items() if role == "Shoulder"}
    fit = {"FrontShoulder": 0.2} | arm if name.leg or arm else {}
    return fit | {f"Front{role}": value for role, value in name.leg.items()}


def _as_limbs(pair: tuple[Sequence[int], Sequence[int]], roles: Sequence[str]) -> dict[str, int]:
    """Return a left and a right chain as limbs."""
    return {
        side + role: joint
        for side, chain in zip(("left", "right"), pair, strict=True)
        for role, joint in zip(roles, chain, strict=False)
    }


_FRONT_OF_ARM = {
    "Shoulder": "FrontShoulder",
    "UpperArm": "FrontUpperLeg",
    "LowerArm": "FrontLowerLeg",
    "Hand": "FrontFoot",
}


def _as_front(part: str) -> str:
    """Return the front-leg part for a part of an arm; other parts are unchanged."""
    for side in ("left", "right"):
        if part.removeprefix(side) in _FRONT_OF_ARM and part.startswith(side):
            return side + _FRONT_OF_ARM[part.removeprefix(side)]
    return part
