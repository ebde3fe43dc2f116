"""Finding the limbs and the trunk in a tree of joints, by names first and by shape where they fail.

A limb is a line of joints, each below the one before; which of them is the knee is decided for the
line as a whole: the assignment of joints to roles, in order, that fits their names best. So
"Shoulder, Arm, ForeArm, Hand" and "Collar, Shoulder, Elbow, Wrist" both come out right.
"""

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from characters.skeleton.joint_names import ARM_ROLES, LEG_ROLES, JointName, read_name
from characters.skeleton.limb_lines import assign, children_of, line_of, lines_of, longest
from characters.skeleton.pose import Array, Skeleton

_OFF_CENTRE = 0.02  # of the body's size: what is farther from the middle has a side
_NEAR_GROUND = 0.2  # of the body's height: limbs that end below are legs
_LEVEL = 1.0  # a trunk that rises less than this for each unit it runs forward lies level
_FINGER_PARTS: tuple[str, ...] = ("Proximal", "Intermediate", "Distal")
_THUMB_PARTS = ("Metacarpal", "Proximal", "Distal")


def find_parts(skeleton: Skeleton, known: Mapping[str, int]) -> dict[str, int]:
    """Return joint numbers by part, the `known` ones among them."""
    return _Search(skeleton, known).run()


class _Search:
    """One skeleton, looked at from all sides."""

    def __init__(self, skeleton: Skeleton, known: Mapping[str, int]) -> None:
        self.skeleton = skeleton
        self.known = dict(known)
        self.places: Array = skeleton.rest.globals(skeleton)[:, :3, 3]
        self.names = [read_name(name) for name in skeleton.names]
        self.lines = lines_of(skeleton.parents)
        low, high = self.places.min(0), self.places.max(0)
        self.size = float(np.linalg.norm(high - low)) or 1.0
        self.ground, self.height = float(low[1]), float(high[1] - low[1]) or 1.0

    def run(self) -> dict[str, int]:
        """Return joint numbers by part."""
        found = dict(self.known)
        for side in ("left", "right"):
            _add(found, self._sided(side))
        if not {"leftUpperLeg", "rightUpperLeg"} <= set(found):
            _add(found, self._by_shape())
        _add(found, self._trunk(found))
        if self._on_all_fours(found):
            found = {_as_front(part): joint for part, joint in found.items()} | self.known
        for side in ("left", "right"):
            _add(found, self._fingers(side))
        return found

    def _side(self, joint: int) -> str:
        """Return on which side a joint is: by its name, its ancestors' names, or its place."""
        for above in reversed(self.lines[joint]):
            if self.names[above].side:
                return self.names[above].side
        offset = float(self.places[joint, 0])
        if abs(offset) < _OFF_CENTRE * self.size:
            return ""
        return "left" if offset > 0 else "right"

    def _sided(self, side: str) -> dict[str, int]:
        """Return the limbs and the eye of one side, as far as names tell."""
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
        """Return the best assignment of one line of joints to the roles of a limb."""
        best: tuple[float, dict[str, int]] = (0.0, {})
        for end in joints:
            line = [joint for joint in self.lines[end] if joint in joints]
            scored = assign(line, roles, essential, [fit(self.names[j]) for j in line])
            best = max(best, scored, key=lambda option: option[0])
        found = {side + role: joint for role, joint in best[1].items()}
        if found:  # the foot of a rig with inverse kinematics may hang elsewhere
            for role in roles:
                for joint in joints:
                    exact = fit(self.names[joint]).get(role, 0.0) >= 1.0
                    if exact and side + role not in found and joint not in found.values():
                        found[side + role] = joint
        return found

    def _by_shape(self) -> dict[str, int]:
        """Return the limbs of a body whose names are silent: mirrored lines of joints."""
        found: dict[str, int] = {}
        pairs = [pair for pair in self._mirroredlines() if len(pair[0]) >= 3]
        low = self.ground + _NEAR_GROUND * self.height
        legs = [p for p in pairs if min(self.places[j, 1] for j in p[0]) < low]
        legs.sort(key=lambda pair: float(self.places[pair[0][0], 2]))
        arms = [pair for pair in pairs if pair not in legs]
        if len(legs) > 1:
            fore = tuple(f"Front{role}" for role in LEG_ROLES)
            found |= _named(legs[-1], fore)
        if legs:
            found |= _named(legs[0], LEG_ROLES)
        arms.sort(key=lambda pair: float(self.places[pair[0][0], 1]))
        if arms:
            roles = ARM_ROLES if len(arms[-1][0]) > 3 else ARM_ROLES[1:]
            found |= _named(arms[-1], roles)
        return found

    def _mirroredlines(self) -> list[tuple[list[int], list[int]]]:
        """Return pairs of lines, left and right, that start at one joint and mirror each other."""
        children = children_of(self.skeleton.parents)
        near = 3 * _OFF_CENTRE * self.size
        pairs: list[tuple[list[int], list[int]]] = []
        for siblings in children.values():
            for left in siblings:
                for right in siblings:
                    image = self.places[right] * [-1.0, 1.0, 1.0]
                    apart = float(np.linalg.norm(self.places[left] - image))
                    both = self.places[left, 0] > near / 3 > 0 > self.places[right, 0]
                    if both and apart < near:
                        pairs.append((longest(left, children)[:4], longest(right, children)[:4]))
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
            head = self._top(hips, junction, found)
        if head is not None and hips in self.lines[head] and head != hips:
            trunk["head"] = head
            trunk |= self._spine(hips, head, junction, named)
        jaws = [j for j in named["jaw"] if head is not None and head in self.lines[j]]
        trunk |= {"jaw": jaws[0]} if jaws else {}
        tail = line_of(named["tail"], self.lines)
        return trunk | {f"tail{number}": joint for number, joint in enumerate(tail[:32], 1)}

    def _hips(self, found: Mapping[str, int], named: Sequence[int], head: int | None) -> int | None:
        """Return the joint that carries legs and trunk."""
        legs = [found[p] for p in ("leftUpperLeg", "rightUpperLeg") if p in found]
        upper = [head] if head is not None else []
        upper = upper or [found[p] for p in ("leftUpperArm", "rightUpperArm") if p in found]
        carried = [self.lines[joint] for joint in legs + upper]
        for joint in named:
            if carried and all(joint in line for line in carried):
                return joint
        if len(legs) < 2:
            return named[0] if named else None
        common = [j for j in carried[0] if all(j in line for line in carried)]
        below = [j for j in common if j not in legs]
        return below[-1] if below else None

    def _junction(self, hips: int, found: Mapping[str, int]) -> int | None:
        """Return the joint where both arms, or front legs, leave the trunk."""
        for part in ("Shoulder", "UpperArm", "FrontShoulder", "FrontUpperLeg"):
            both = [found[side + part] for side in ("left", "right") if side + part in found]
            if len(both) == 2:
                left, right = (self.lines[joint][:-1] for joint in both)
                common = [j for j in left if j in right and hips in self.lines[j]]
                return common[-1] if common else None
        return None

    def _top(self, hips: int, junction: int | None, found: Mapping[str, int]) -> int | None:
        """Return the end of the highest line in the middle of the body: a head without a name."""
        taken = set(found.values())
        middle = [
            joint
            for joint, line in enumerate(self.lines)
            if (hips if junction is None else junction) in line[:-1]
            and not taken.intersection(line)
            and not self.names[joint].auxiliary
            and self.names[joint].trunk != "tail"
            and abs(self.places[joint, 0]) < _OFF_CENTRE * self.size
        ]
        return max(middle, key=lambda j: (len(self.lines[j]), self.places[j, 1]), default=None)

    def _spine(
        self, hips: int, head: int, junction: int | None, named: Mapping[str, Sequence[int]]
    ) -> dict[str, int]:
        """Return the joints between hips and head."""
        line = self.lines[head]
        between = line[line.index(hips) + 1 : -1]
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
        """Return whether what was found as arms are front legs: they stand, and the trunk lies."""
        hands = [found[p] for p in ("leftHand", "rightHand") if p in found]
        if not hands or "head" not in found or "hips" not in found:
            return False
        low = self.ground + _NEAR_GROUND * self.height
        arms = [found.get("leftUpperArm", hands[0]), found.get("leftUpperLeg", hands[0])]
        run = self.places[arms[0]] - self.places[arms[1]]
        level = abs(float(run[1])) < _LEVEL * float(np.hypot(run[0], run[2]))
        return level and all(self.places[hand, 1] < low for hand in hands)

    def _fingers(self, side: str) -> dict[str, int]:
        """Return the fingers of one side, as far as names tell."""
        found: dict[str, int] = {}
        joints = [j for j, name in enumerate(self.names) if name.finger and self._side(j) == side]
        for finger in ("Thumb", "Index", "Middle", "Ring", "Little"):
            line = line_of([j for j in joints if self.names[j].finger == finger], self.lines)
            parts = _FINGER_PARTS
            if finger == "Thumb":  # the bone in the palm is seldom rigged
                parts = _THUMB_PARTS if len(line) > 2 else _THUMB_PARTS[1:]
            found |= {side + finger + p: j for p, j in zip(parts, line, strict=False)}
        return found


def _add(found: dict[str, int], more: Mapping[str, int]) -> None:
    """Add parts that are not found yet, of joints that are nothing yet."""
    for part, joint in more.items():
        if part not in found and joint not in found.values():
            found[part] = joint


def _front_fit(name: JointName) -> Mapping[str, float]:
    """Return how well a name fits each role of a front leg."""
    arm = {f"Front{role}": fit for role, fit in name.arm.items() if role == "Shoulder"}
    fit = {"FrontShoulder": 0.2} | arm if name.leg or arm else {}
    return fit | {f"Front{role}": value for role, value in name.leg.items()}


def _named(pair: tuple[Sequence[int], Sequence[int]], roles: Sequence[str]) -> dict[str, int]:
    """Return a pair of lines as limbs."""
    return {
        side + role: joint
        for side, line in zip(("left", "right"), pair, strict=True)
        for role, joint in zip(roles, line, strict=False)
    }


_FRONT_OF_ARM = {
    "Shoulder": "FrontShoulder",
    "UpperArm": "FrontUpperLeg",
    "LowerArm": "FrontLowerLeg",
    "Hand": "FrontFoot",
}


def _as_front(part: str) -> str:
    """Return what a part of an arm is in a front leg; other parts stay."""
    for side in ("left", "right"):
        if part.removeprefix(side) in _FRONT_OF_ARM and part.startswith(side):
            return side + _FRONT_OF_ARM[part.removeprefix(side)]
    return part
