"""From the numbers of a frame to joint poses: what BVH and Acclaim have in common.

In both, a joint rotates about a list of fixed axes, one number per axis. In BVH these are the
axes of the file. In Acclaim they are the axes of the bone's own frame C; since
C R(e, a) C⁻¹ = R(C e, a), they are fixed directions in the file's axes too. So every rest rotation
is the identity.
"""

from dataclasses import dataclass
from itertools import zip_longest

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.pose import Array, Pose

_BLOCK_FRAMES = 1024  # computed at once: a block fits in the processor's cache


@dataclass(frozen=True)
class AxisChannel:
    """One number of a frame that rotates or moves one joint."""

    joint: int
    """Index of the joint in the skeleton."""

    axis: Array
    """In the parent's frame, (3,): the unit axis of a rotation, or what a value of 1 adds to the
    joint's translation."""

    column: int
    """Which number of the frame is the angle or the distance."""


@dataclass(frozen=True)
class ChannelLayout:
    """How the numbers of a frame move joints."""

    offsets: Array
    """Joint translations when every number is zero, (joints, 3)."""

    rotations: tuple[AxisChannel, ...]
    """Of one joint's rotations, the first is applied last."""

    translations: tuple[AxisChannel, ...]
    """Of one joint's translations, the sum is applied."""

    angle_unit: float
    """Size of an angle of 1 [rad]."""

    def poses(self, values: Array) -> Pose:
        """Return the poses of frames of numbers, (frames, numbers)."""
        translations = np.tile(self.offsets, (len(values), 1, 1))
        for channel in self.translations:
            translations[:, channel.joint] += values[:, channel.column, None] * channel.axis
        quaternions = np.tile(rotations.IDENTITY, (*translations.shape[:2], 1))
        rounds = self._rounds()
        for start in range(0, len(values), _BLOCK_FRAMES):
            frames = slice(start, start + _BLOCK_FRAMES)
            block, angles = quaternions[frames], values[frames] * self.angle_unit
            for number, (joints, axes, columns) in enumerate(rounds):
                q = rotations.about(axes, angles[:, columns])
                block[:, joints] = rotations.multiply(block[:, joints], q) if number else q
        return Pose(translations, quaternions)

    def _rounds(self) -> list[tuple[NDArray[np.intp], Array, NDArray[np.intp]]]:
        """Return every joint's first rotation, then every joint's second one, and so on.

        Each round is the joints (n,), their axes (n, 3) and their columns (n,).
        """
        by_joint: dict[int, list[AxisChannel]] = {}
        for channel in self.rotations:
            by_joint.setdefault(channel.joint, []).append(channel)
        rounds = []
        for mixed in zip_longest(*by_joint.values()):
            channels = [channel for channel in mixed if channel is not None]
            joints, columns = ([c.joint for c in channels], [c.column for c in channels])
            rounds.append(
                (np.array(joints), np.array([c.axis for c in channels]), np.array(columns))
            )
        return rounds
