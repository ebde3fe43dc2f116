"""Some joints of a skeleton with all that carries them."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from characters.pose import Array, Pose, Skeleton


@dataclass(frozen=True)
class Part:
    """Some joints and their ancestors, as a skeleton: where they are costs less than for all."""

    joints: NDArray[np.intp]
    """Numbers in the whole skeleton, ascending, (n,)."""

    skeleton: Skeleton
    """These joints alone."""

    @staticmethod
    def of(skeleton: Skeleton, joints: Iterable[int]) -> "Part":
        """Return some joints with their ancestors.

        >>> rest = Pose(np.zeros((3, 3)), np.tile([0.0, 0, 0, 1], (3, 1)))
        >>> Part.of(Skeleton(("root", "arm", "leg"), (-1, 0, 0), rest), [2]).skeleton.names
        ('root', 'leg')
        """
        wanted = set(joints)
        for joint in reversed(range(len(skeleton))):
            if joint in wanted and skeleton.parents[joint] >= 0:
                wanted.add(skeleton.parents[joint])
        order = sorted(wanted)
        number = {joint: place for place, joint in enumerate(order)} | {-1: -1}
        part = Skeleton(
            tuple(skeleton.names[joint] for joint in order),
            tuple(number[skeleton.parents[joint]] for joint in order),
            Pose(
                skeleton.rest.translations[order],
                skeleton.rest.rotations[order],
                None if skeleton.rest.scales is None else skeleton.rest.scales[order],
            ),
        )
        return Part(np.array(order, np.intp), part)

    def number(self, joint: int) -> int:
        """Return where a joint of the whole skeleton is in this part; −1 if it is not."""
        place = int(np.searchsorted(self.joints, joint))
        there = place < len(self.joints) and self.joints[place] == joint
        return place if there else -1

    def globals(self, pose: Pose) -> Array:
        """Return `character_from_joint` of these joints, (…, n, 4, 4), in a pose of the whole."""
        own = Pose(
            pose.translations[..., self.joints, :],
            pose.rotations[..., self.joints, :],
            None if pose.scales is None else pose.scales[..., self.joints, :],
        )
        return own.globals(self.skeleton)
