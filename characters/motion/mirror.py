"""Left and right exchanged: for poses, steps, clips and motions of any symmetric skeleton.

A symmetric pose, of rest or the one that the skin was bound in, says how the frame of a joint and
that of its partner belong together. With B(k) the transform of a joint k to the character in that
pose, p(k) its partner and M the reflection x → −x, F(k) = B⁻¹(p(k)) M B(k) takes coordinates in the
frame of k to those in its partner's. The transform L of a joint in its parent q then becomes
F(q) L F⁻¹(k), that of the partner: the skin is reflected exactly, whatever the joints' axes are.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from characters.motion.clip import Clip
from characters.motion.motion import Motion, RootDelta
from characters.motion.phase import as_cyclic, has_footfalls
from characters.skeleton import rotations
from characters.skeleton.pose import Array, Pose, Skeleton
from characters.skeleton.symmetry import check_symmetry, paired_joints, paired_names

_REFLECTION = np.array([-1.0, 1.0, 1.0])
_PSEUDO = np.array([1.0, -1.0, -1.0, 1.0])  # what the reflection does to a rotation
EXACT = 1e-5
"""Relative difference below which two lengths are meant to be the same."""

_NONE: Mapping[str, str] = MappingProxyType({})


@dataclass(frozen=True)
class _Frames:
    """Transforms M Q of joints' frames to their partners', with shifts and uniform scales."""

    turns: Array
    """Q, (joints, 4)."""

    shifts: Array
    """(joints, 3)."""

    sizes: Array
    """(joints, 1)."""

    def __getitem__(self, joints: NDArray[np.intp]) -> "_Frames":
        return _Frames(self.turns[joints], self.shifts[joints], self.sizes[joints])


@dataclass(frozen=True)
class Mirror:
    """Which joints and morphs of a skeleton change places, and how their frames do."""

    partners: NDArray[np.intp]
    """The joint on the other side, (joints,); of one in the middle, itself."""

    frames: "_Frames"
    """F of each joint: see above."""

    parents: "_Frames"
    """F of each joint's parent."""

    looks: NDArray[np.intp]
    """The morph of the other side, (morphs,); of one for both, itself."""

    @staticmethod
    def of(
        skeleton: Skeleton,
        morphs: tuple[str, ...] = (),
        pairs: Mapping[str, str] = _NONE,
    ) -> "Mirror":
        """Return the mirror of a skeleton, its pairs found by places and names.

        The places of all joints are reflected exactly. Where there is a skin,
        `characters.model.mirroring.mirror_of` is better: it reflects that, even if the skeleton
        is a little crooked.

        Parameters
        ----------
        skeleton
            Its rest pose is symmetric about the plane x = 0.
        morphs
            Names of the character's morphs; "blinkLeft" changes places with "blinkRight".
        pairs
            Joint to joint where they cannot be found; each counts both ways.

        Raises
        ------
        CharacterError
            If the rest pose is not symmetric, or a joint has no partner.
        """
        rest = skeleton.rest.globals(skeleton)
        return Mirror.about(skeleton, morphs, pairs, rest, np.zeros(len(skeleton), bool))

    @staticmethod
    def about(
        skeleton: Skeleton,
        morphs: tuple[str, ...],
        pairs: Mapping[str, str],
        symmetric: Array,
        exact: NDArray[np.bool_],
    ) -> "Mirror":
        """Return the mirror of a skeleton about a pose that need not be its rest pose.

        Parameters
        ----------
        skeleton, morphs, pairs
            As for `of`.
        symmetric
            `character_from_joint` in the symmetric pose, (joints, 4, 4).
        exact
            Joints with a skin, (joints,): what hangs on them is reflected; of the others only the
            places are.

        Raises
        ------
        CharacterError
            If that pose is not symmetric, or a joint has no partner.
        """
        places = symmetric[:, :3, 3]
        partners = paired_joints(skeleton, places, pairs)
        check_symmetry(skeleton, places, partners)
        sizes = np.cbrt(np.abs(np.linalg.det(symmetric[:, :3, :3])))
        turns = rotations.from_matrix(symmetric[:, :3, :3] / sizes[:, None, None])
        # F = M Q, and so Q = M G(p)ᵀ M G, with G the rotations alone.
        theirs = rotations.conjugate(turns[partners])
        between = rotations.multiply(theirs * _PSEUDO, turns)
        apart = places * _REFLECTION - places[partners]
        crooked = np.linalg.norm(apart, axis=-1) > EXACT * float(np.ptp(places, axis=0).max())
        shifts = rotations.rotate(theirs, apart) / sizes[partners, None]
        exact = exact & exact[partners]
        crooked |= crooked[partners]
        shifts = np.where((exact & crooked)[:, None], shifts, 0.0)
        ratios = (sizes / sizes[partners])[:, None]
        ratios = np.where(exact[:, None] & (np.abs(ratios - 1.0) > EXACT), ratios, 1.0)
        # One frame more, of the world, for parent −1.
        frames = _Frames(
            np.vstack([between, rotations.IDENTITY]),
            np.vstack([shifts, np.zeros(3)]),
            np.vstack([ratios, np.ones(1)]),
        )
        joints = np.arange(len(skeleton))
        return Mirror(
            partners, frames[joints], frames[np.array(skeleton.parents)], paired_names(morphs)
        )

    def pose(self, pose: Pose) -> Pose:
        """Return poses (…) mirrored."""
        frames, parents = self.frames, self.parents
        turns = rotations.multiply(parents.turns, pose.rotations)
        turns = rotations.multiply(turns, rotations.conjugate(frames.turns)) * _PSEUDO
        # Where the origin of the partner's frame is, as seen from the joint.
        origins = -rotations.rotate(
            rotations.conjugate(frames.turns), frames.shifts * _REFLECTION / frames.sizes
        )
        scales, shifts = pose.scales, pose.translations
        if frames.shifts.any():
            spread = origins if scales is None else origins * scales
            shifts = shifts + rotations.rotate(pose.rotations, spread)
        shifts = rotations.rotate(parents.turns, shifts) * _REFLECTION * parents.sizes
        sizes = parents.sizes / frames.sizes
        if scales is not None:
            # F S F⁻¹ along the partner's axes; frames of partners differ by quarter turns at most.
            scales = (rotations.to_matrix(frames.turns) ** 2 @ scales[..., None])[..., 0] * sizes
        elif (sizes != 1.0).any():
            scales = np.broadcast_to(sizes, shifts.shape)
        morphs = pose.morphs
        if morphs is not None and len(self.looks):
            morphs = morphs[..., self.looks]
        return Pose(
            (shifts + parents.shifts)[..., self.partners, :],
            turns[..., self.partners, :],
            None if scales is None else scales[..., self.partners, :],
            morphs,
        )

    @staticmethod
    def step(step: RootDelta) -> RootDelta:
        """Return a step mirrored."""
        return RootDelta(-step.x, step.z, -step.yaw)

    def clip(self, clip: Clip, name: str = "") -> Clip:
        """Return a clip mirrored; its footfalls are then found anew by `phased`."""
        return replace(clip, name=name or clip.name, poses=self.pose(clip.poses))


@dataclass(frozen=True)
class Mirrored:
    """A motion with left and right exchanged; `Cyclic`.

    Its left footfall is the right one of the motion: of a motion that takes steps, phases are half
    a cycle away. Times are the same.
    """

    motion: Motion
    """What is played."""

    mirror: Mirror
    """That of its skeleton."""

    @property
    def duration(self) -> float:
        """Time until it repeats or ends [s]."""
        return self.motion.duration

    def sample(self, time: float) -> Pose:
        """Return the pose at a time [s]."""
        return self.mirror.pose(self.motion.sample(time))

    def travel(self, start: float, end: float) -> RootDelta:
        """Return how the root moves over the ground between two times [s]."""
        return self.mirror.step(self.motion.travel(start, end))

    def at(self, phase: float) -> Pose:
        """Return the pose at a phase."""
        return self.mirror.pose(as_cyclic(self.motion).at(phase + self.lead))

    def between(self, start: float, end: float) -> RootDelta:
        """Return how the root moves over the ground between two phases."""
        lead = self.lead
        return self.mirror.step(as_cyclic(self.motion).between(start + lead, end + lead))

    @property
    def lead(self) -> float:
        """How far ahead of its own phase the motion is; back again where mirrored twice."""
        if isinstance(self.motion, Mirrored):
            return -self.motion.lead
        return 0.5 if has_footfalls(self.motion) else 0.0
