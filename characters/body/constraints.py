"""Joints that turn as others do.

Source: the specification VRMC_node_constraint 1.0. A roll takes the part of the source's turn that
is about an axis, an aim points an axis at the source, a rotation copies the source's turn.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.model.constraints import JointConstraint, constraint_levels
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.pose import Array, Pose, Skeleton


@dataclass(frozen=True)
class _Group:
    """Constraints of one kind that do not depend on each other."""

    kind: str

    joints: NDArray[np.intp]
    """The joints that turn, (n,)."""

    sources: NDArray[np.intp]
    """Those that they follow, (n,)."""

    axes: Array
    """Unit vectors in the joints' frames, (n, 3)."""

    weights: Array
    """Parts of the way from the rest pose, (n,)."""


class ConstrainedJoints:
    """The constraints of one skeleton.

    Raises
    ------
    CharacterError
        If joints follow each other in a circle.
    """

    def __init__(self, skeleton: Skeleton, constraints: Sequence[JointConstraint]) -> None:
        self._skeleton = skeleton
        self._groups = [
            _Group(
                kind,
                np.array([skeleton.index(each.joint) for each in same], np.intp),
                np.array([skeleton.index(each.source) for each in same], np.intp),
                np.array([each.axis for each in same]),
                np.array([each.weight for each in same]),
            )
            for level in constraint_levels(skeleton, constraints)
            for kind in ("roll", "aim", "rotation")
            if (same := [each for each in level if each.kind == kind])
        ]

    def apply(self, pose: Pose) -> Pose:
        """Return a pose, of one frame, with its constrained joints turned."""
        turned = pose.with_rotations(pose.rotations.copy())
        local, rest = turned.rotations, self._skeleton.rest.rotations
        for group in self._groups:
            own = rest[group.joints]
            if group.kind == "aim":
                aimed = self._aim_at(turned, group, own)
            else:
                before = rotations.conjugate(rest[group.sources])
                if group.kind == "roll":
                    aimed = _roll(rotations.multiply(local[group.sources], before), group, own)
                else:
                    delta = rotations.multiply(before, local[group.sources])
                    aimed = rotations.multiply(own, delta)
            local[group.joints] = rotations.slerp(own, aimed, group.weights)
        return turned

    def _aim_at(self, pose: Pose, group: _Group, own: Array) -> Array:
        """Return the local rotations (n, 4) that point the axes to the sources."""
        placed = pose.globals(self._skeleton)
        frames = np.concatenate([placed, np.eye(4)[None]])[self._parents(group.joints), :3, :3]
        lengths = np.linalg.norm(frames, axis=1, keepdims=True)
        parents = rotations.from_matrix(frames / np.maximum(lengths, 1e-9))
        at_rest = rotations.multiply(parents, own)
        way = placed[group.sources, :3, 3] - placed[group.joints, :3, 3]
        ahead = rotations.rotate(at_rest, group.axes)
        near = np.linalg.norm(way, axis=1, keepdims=True) < 1e-9  # it has no direction
        turn = rotations.between(ahead, np.where(near, ahead, way))
        return rotations.multiply(rotations.conjugate(parents), rotations.multiply(turn, at_rest))

    def _parents(self, joints: NDArray[np.intp]) -> NDArray[np.intp]:
        return np.array(self._skeleton.parents, np.intp)[joints]


def _roll(turns: Array, group: _Group, own: Array) -> Array:
    """Return the local rotations (n, 4) of joints that roll by turns of their sources (n, 4)."""
    inside = rotations.multiply(rotations.conjugate(own), rotations.multiply(turns, own))
    swing = rotations.between(group.axes, rotations.rotate(inside, group.axes))
    twist = rotations.multiply(rotations.conjugate(swing), inside)
    return rotations.multiply(own, twist)
