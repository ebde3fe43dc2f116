"""A few joints of a skeleton and what they depend on, which is quicker to place than all."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.skeleton.pose import Array, Pose, Skeleton


@dataclass(frozen=True)
class SkeletonPart:
    """The joints on which some joints depend, as a skeleton of their own."""

    skeleton: Skeleton
    """The joints of the part alone, numbered from 0."""

    joints: NDArray[np.intp]
    """Their numbers in the whole skeleton."""

    @staticmethod
    def of(skeleton: Skeleton, joints: Sequence[int]) -> "SkeletonPart":
        """Return the part with these joints and all above them; −1 is none."""
        kept = skeleton.with_ancestors(joint for joint in joints if joint >= 0)
        places = {joint: number for number, joint in enumerate(kept)}
        names = tuple(skeleton.names[joint] for joint in kept)
        parents = tuple(places.get(skeleton.parents[joint], -1) for joint in kept)
        rest = Pose(skeleton.rest.translations[kept], skeleton.rest.rotations[kept])
        return SkeletonPart(Skeleton(names, parents, rest), np.array(kept, np.intp))

    def places(self, joints: Sequence[int]) -> NDArray[np.intp]:
        """Return the numbers of joints in the part; any for −1."""
        return np.searchsorted(self.joints, np.maximum(np.array(joints, np.intp), 0))

    def globals(self, pose: Pose, world: Array | None = None) -> Array:
        """Return `character_from_joint` of its joints, (…, joints, 4, 4), in poses of all.

        With `world_from_character` (4, 4), they are `world_from_joint`.
        """
        scales = None if pose.scales is None else pose.scales.take(self.joints, -2)
        places, turns = pose.translations, pose.rotations
        own = Pose(places.take(self.joints, -2), turns.take(self.joints, -2), scales)
        return own.globals(self.skeleton, world)
