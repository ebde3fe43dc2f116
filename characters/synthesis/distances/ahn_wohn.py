"""The distance of Ahn and Wohn: how far turned joints move what hangs on them."""

import numpy as np

from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.pose import Array, Skeleton
from cubeling.characters.synthesis.distances.distance import Block
from cubeling.characters.synthesis.library import Frames, MotionLibrary

_STRETCH = 1.0 + 4e-7  # as in `angles`


class AhnWohn:
    """Σ_j |r_j θ_j| + α · 2 |log(q_j⁻¹ q'_j)|; a `FrameDistance` (S26, T 2.15 to 2.20).

    Ahn and Wohn, "Motion level-of-detail", 2004. θ_j is the angle between the bone of joint j in
    both frames, r_j the length from the joint to its farthest leaf. A joint with several children
    has the bone towards that leaf.

    Parameters
    ----------
    library
        The frames.
    joints
        The joints that count; left out, all that have children.
    alpha
        Weight of the orientation [m/rad].
    """

    def __init__(
        self, library: MotionLibrary, joints: tuple[int, ...] | None = None, alpha: float = 0.1
    ) -> None:
        reaches, towards = farthest_leaves(library.skeleton)
        root = 1 if library.skeleton.has_root_motion else 0
        wanted = range(root, len(library.skeleton)) if joints is None else joints
        self._joints = [joint for joint in wanted if reaches[joint] > 1e-6]
        self._alpha = alpha
        rest = library.skeleton.rest.translations
        self._reaches = np.array([reaches[joint] for joint in self._joints])
        bones = np.array([rest[towards[joint]] for joint in self._joints])
        turns = library.poses.rotations[:, self._joints]
        directions = rotations.rotate(turns, bones / np.linalg.norm(bones, axis=-1, keepdims=True))
        self._turns = turns.swapaxes(0, 1)
        self._directions = directions.swapaxes(0, 1)
        self._turn_blocks = (self._turns * _STRETCH).astype(np.float32)
        self._direction_blocks = (self._directions * _STRETCH).astype(np.float32)

    def __len__(self) -> int:
        return len(self._turns[0])

    def block(self, rows: Frames, columns: Frames) -> Block:
        """Return the distances of frames to frames."""
        total: Block | None = None
        for turn, bone, reach in zip(
            self._turn_blocks, self._direction_blocks, self._reaches, strict=True
        ):
            angle = np.arccos(np.clip(bone[rows] @ bone[columns].T, -1.0, 1.0))
            angle *= np.float32(reach)
            turned = np.arccos(np.minimum(np.abs(turn[rows] @ turn[columns].T), 1.0))
            angle += turned * np.float32(2 * self._alpha)
            total = angle if total is None else np.add(total, angle, out=total)
        assert total is not None  # every skeleton has a bone
        return total

    def pairs(self, a: Frames, b: Frames) -> Array:
        """Return the distances of frames to frames, one to one."""
        total = np.zeros(len(a))
        for turn, bone, reach in zip(self._turns, self._directions, self._reaches, strict=True):
            total += reach * _angle(bone[a], bone[b])
            half = np.minimum(_angle(turn[a], turn[b]), _angle(turn[a], -turn[b]))
            total += 2 * self._alpha * half
        return total


def farthest_leaves(skeleton: Skeleton) -> tuple[Array, list[int]]:
    """Return the length from each joint to its farthest leaf [m], and its child on the way there.

    A leaf has length 0 and is its own child.
    """
    lengths = np.linalg.norm(skeleton.rest.translations, axis=-1)
    reaches, towards = np.zeros(len(skeleton)), list(range(len(skeleton)))
    for joint in reversed(range(len(skeleton))):
        parent = skeleton.parents[joint]
        if parent >= 0 and reaches[joint] + lengths[joint] > reaches[parent]:
            reaches[parent] = reaches[joint] + lengths[joint]
            towards[parent] = joint
    return reaches, towards


def _angle(a: Array, b: Array) -> Array:
    """Return the angles between unit vectors (n, k), exact where they are small [rad]."""
    chord = np.linalg.norm(a - b, axis=-1)
    angle: Array = 2 * np.arcsin(np.minimum(chord / 2, 1.0))
    return angle
