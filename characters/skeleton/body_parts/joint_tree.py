"""What names, places and the tree say about the joints of a skeleton."""

from collections.abc import Mapping, Sequence
from functools import cached_property
from itertools import pairwise

import numpy as np

from cubeling.characters.skeleton.body_parts.joint_names import JointName, read_names
from cubeling.characters.skeleton.joint_chains import (
    chains_to_root,
    children_of,
    longest_chain_below,
)
from cubeling.characters.skeleton.pose import Array, Skeleton

_MIN_SIDE_OFFSET = 0.02  # body sizes from the middle: beyond it, a joint has a side
_MAX_FOOT_HEIGHT = 0.2  # body heights: limbs that end below it are legs

_MIN_HEIGHT = 0.1  # body sizes: what is lower lies
_MAX_KNEE_HEIGHT = 0.65  # of the hip's height
_MAX_HIP_HEIGHT = 0.75  # body heights


class JointTree:
    """The joints of a skeleton at rest, with what their names say."""

    def __init__(self, skeleton: Skeleton) -> None:
        self.positions: Array = skeleton.rest.globals(skeleton)[:, :3, 3].copy()
        self.names: Sequence[JointName] = read_names(skeleton.names)
        self.chains: Sequence[Sequence[int]] = chains_to_root(skeleton.parents)
        self.parents: Sequence[int] = skeleton.parents
        self.positions[:, 0] -= self._middle()
        low, high = self.positions.min(0), self.positions.max(0)
        self.size = float(np.linalg.norm(high - low)) or 1.0
        self._ground, self._height = float(low[1]), float(high[1] - low[1])

    def _middle(self) -> float:
        """Return x of the trunk as far as names tell it, else 0 [m]."""
        trunk = [
            x
            for x, name in zip(self.positions[:, 0], self.names, strict=True)
            if name.trunk in ("hips", "spine", "chest", "neck", "head") and not name.side
        ]
        return float(np.median(trunk)) if trunk else 0.0

    def __len__(self) -> int:
        return len(self.names)

    @cached_property
    def children(self) -> Mapping[int, Sequence[int]]:
        """The children of each joint; those of −1 are the roots."""
        return children_of(self.parents)

    def side(self, joint: int) -> str:
        """Return the side of a joint: by its name, its ancestors' names, or its position."""
        for above in reversed(self.chains[joint]):
            if self.names[above].side:
                return self.names[above].side
        if self.in_middle(joint) or not self.is_of_one_side(joint):
            return ""
        return "left" if self.positions[joint, 0] > 0 else "right"

    def row(self, joint: int) -> str:
        """Return "front", "hind" or "": the legs to which a joint belongs by name."""
        for above in reversed(self.chains[joint]):
            if self.names[above].front:
                return "front"
            if self.names[above].hind:
                return "hind"
        return ""

    def is_of_one_side(self, joint: int) -> bool:
        """Return whether all joints below a joint are of one side as far as names tell."""
        return len(self._sides_below[joint]) < 2

    @cached_property
    def _sides_below(self) -> Sequence[set[str]]:
        """The sides that names tell of each joint and those below it."""
        sides = [{name.side} - {""} for name in self.names]
        for joint in reversed(range(len(self))):
            if self.parents[joint] >= 0:
                sides[self.parents[joint]] |= sides[joint]
        return sides

    def in_middle(self, joint: int) -> bool:
        """Return whether a joint is between the sides of the body, or no name says it is not.

        Places say nothing in the zero pose of a recording that lies.
        """
        if self._height < _MIN_HEIGHT * self.size:
            return not any(self.names[above].side for above in self.chains[joint])
        return abs(float(self.positions[joint, 0])) < _MIN_SIDE_OFFSET * self.size

    def near_ground(self, joint: int) -> bool:
        """Return whether a joint is as low as feet are."""
        return float(self.positions[joint, 1]) < self._ground + _MAX_FOOT_HEIGHT * self._height

    def reaches_down(self, hip: int, knee: int) -> bool:
        """Return whether a bone leads down as far as the thigh of a leg without joints below."""
        high, low = self.positions[[hip, knee], 1] - self._ground
        return bool(low < _MAX_KNEE_HEIGHT * high and high < _MAX_HIP_HEIGHT * self._height)

    def length(self, chain: Sequence[int]) -> float:
        """Return the length of a chain of joints [m]."""
        return float(sum(self.distance(a, b) for a, b in pairwise(chain)))

    def distance(self, joint: int, other: int) -> float:
        """Return how far two joints are apart [m]."""
        return float(np.linalg.norm(self.positions[joint] - self.positions[other]))

    def is_below(self, joint: int, above: int) -> bool:
        """Return whether a joint is a descendant of another, or that joint itself."""
        return above in self.chains[joint]

    def shared_chain(self, joints: Sequence[int]) -> list[int]:
        """Return the ancestors that joints share, from the root down, the joints included."""
        first = self.chains[joints[0]]
        return [above for above in first if all(above in self.chains[j] for j in joints[1:])]

    def mirrored_chains(self) -> list[tuple[list[int], list[int]]]:
        """Return pairs of chains, left and right, that have one parent and mirror each other.

        What is no limb by name is left out.
        """
        pairs: list[tuple[list[int], list[int]]] = []
        for siblings in self.children.values():
            for left in siblings:
                for right in siblings:
                    if self._are_mirrored(left, right):
                        chains = [longest_chain_below(j, self.children) for j in (left, right)]
                        pairs.append((chains[0], chains[1]))
        return pairs

    def _are_mirrored(self, left: int, right: int) -> bool:
        """Return whether two joints are left and right, by name or place, and mirror each other."""
        if self.names[left].auxiliary or self.names[right].auxiliary:
            return False
        sides = (self.names[left].side, self.names[right].side)
        if sides != ("left", "right"):
            offsets = (self.positions[left, 0], -self.positions[right, 0])
            if any(sides) or min(offsets) < _MIN_SIDE_OFFSET * self.size:
                return False
        image = self.positions[right] * [-1.0, 1.0, 1.0]
        apart = float(np.linalg.norm(self.positions[left] - image))
        return apart < 3 * _MIN_SIDE_OFFSET * self.size
