"""Mirroring of poses, root deltas, clips and motions of symmetric skeletons.

A symmetric pose (the rest or bind pose) defines how the frames of a joint and its partner
correspond. Let B(k) be the transform of joint k to the character in that pose, p(k) its partner
and M the reflection x → −x. Then F(k) = B⁻¹(p(k)) M B(k) maps coordinates in the frame of k to the
frame of its partner, and the transform L of k in its parent q becomes F(q) L F⁻¹(k), the transform
of the partner. The skin is mirrored exactly, whatever the axes of the joints.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.motion.clip import Clip
from cubeling.characters.motion.motion import RootDelta
from cubeling.characters.motion.phase import TransformedMotion, has_footfalls
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.pose import Array, Pose, Skeleton
from cubeling.characters.skeleton.symmetry import (
    REFLECTION,
    check_symmetry,
    paired_joints,
    paired_names,
)

_QUATERNION_REFLECTION = np.array([1.0, -1.0, -1.0, 1.0])
LENGTH_TOLERANCE = 1e-5
"""Relative difference below which two lengths count as equal."""

NO_PAIRS: Mapping[str, str] = MappingProxyType({})
"""No partners that are given by name."""


@dataclass(frozen=True)
class _Frames:
    """Transforms F from the frames of joints to those of their partners."""

    rotations: Array
    """Q, where F without scale and translation is M Q, (joints, 4)."""

    translations: Array
    """(joints, 3)."""

    scales: Array
    """Uniform scales, (joints, 1)."""

    def __getitem__(self, joints: NDArray[np.intp]) -> "_Frames":
        return _Frames(self.rotations[joints], self.translations[joints], self.scales[joints])


@dataclass(frozen=True)
class Mirror:
    """Partners of joints and morphs of a skeleton, and the transforms between their frames."""

    partners: NDArray[np.intp]
    """Joint on the other side, (joints,); a joint in the middle is its own partner."""

    frames: "_Frames"
    """F of each joint; see the module."""

    parents: "_Frames"
    """F of each joint's parent."""

    morphs: NDArray[np.intp]
    """Morph of the other side, (morphs,); a morph of both sides is its own partner."""

    @staticmethod
    def of(
        skeleton: Skeleton, morphs: tuple[str, ...] = (), pairs: Mapping[str, str] = NO_PAIRS
    ) -> "Mirror":
        """Return the mirror of a skeleton, with pairs found by positions and names.

        The positions of all joints are mirrored exactly. For skinned characters use
        `characters.model.mirroring.mirror_of`, which mirrors the skin exactly even if the skeleton
        is slightly asymmetric.

        Parameters
        ----------
        skeleton
            A skeleton whose rest pose is symmetric about the plane x = 0.
        morphs
            Names of the character's morphs; "blinkLeft" is exchanged with "blinkRight".
        pairs
            Partners that cannot be found, by joint names; each pair applies both ways.

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
        """Return the mirror of a skeleton for any symmetric pose; see `of`.

        Parameters
        ----------
        symmetric
            `character_from_joint` in the symmetric pose, (joints, 4, 4).
        exact
            Skinned joints, (joints,), whose skin is mirrored exactly; of other joints only the
            positions are.
        """
        positions = symmetric[:, :3, 3]
        partners = paired_joints(skeleton, positions, pairs)
        check_symmetry(skeleton, positions, partners)
        scales = np.cbrt(np.abs(np.linalg.det(symmetric[:, :3, :3])))
        turns = rotations.from_matrix(symmetric[:, :3, :3] / scales[:, None, None])
        # F = M Q, and so Q = M G(p)ᵀ M G, where G are the rotations only.
        theirs = rotations.conjugate(turns[partners])
        between = rotations.multiply(theirs * _QUATERNION_REFLECTION, turns)
        apart = positions * REFLECTION - positions[partners]
        tolerance = LENGTH_TOLERANCE * float(np.ptp(positions, axis=0).max())
        asymmetric = np.linalg.norm(apart, axis=-1) > tolerance
        translations = rotations.rotate(theirs, apart) / scales[partners, None]
        exact = exact & exact[partners]
        asymmetric |= asymmetric[partners]
        translations = np.where((exact & asymmetric)[:, None], translations, 0.0)
        ratios = (scales / scales[partners])[:, None]
        different = np.abs(ratios - 1.0) > LENGTH_TOLERANCE
        ratios = np.where(exact[:, None] & different, ratios, 1.0)
        # One more frame, the world's, for parent −1.
        frames = _Frames(
            np.vstack([between, rotations.IDENTITY]),
            np.vstack([translations, np.zeros(3)]),
            np.vstack([ratios, np.ones(1)]),
        )
        joints = np.arange(len(skeleton))
        return Mirror(
            partners, frames[joints], frames[np.array(skeleton.parents)], paired_names(morphs)
        )

    def pose(self, pose: Pose) -> Pose:
        """Return mirrored poses (…)."""
        frames, parents = self.frames, self.parents
        turns = rotations.multiply(parents.rotations, pose.rotations)
        turns = rotations.multiply(turns, rotations.conjugate(frames.rotations))
        turns = turns * _QUATERNION_REFLECTION
        # The origin of the partner's frame in the frame of the joint.
        origins = -rotations.rotate(
            rotations.conjugate(frames.rotations), frames.translations * REFLECTION / frames.scales
        )
        scales, translations = pose.scales, pose.translations
        if frames.translations.any():
            scaled = origins if scales is None else origins * scales
            translations = translations + rotations.rotate(pose.rotations, scaled)
        translations = rotations.rotate(parents.rotations, translations)
        translations = translations * REFLECTION * parents.scales
        ratios = parents.scales / frames.scales
        if scales is not None:
            # F S F⁻¹ along the partner's axes, which differ by quarter turns at most.
            squares = rotations.to_matrix(frames.rotations) ** 2
            scales = (squares @ scales[..., None])[..., 0] * ratios
        elif (ratios != 1.0).any():
            scales = np.broadcast_to(ratios, translations.shape)
        morphs = pose.morphs
        if morphs is not None and len(self.morphs):
            morphs = morphs[..., self.morphs]
        return Pose(
            (translations + parents.translations)[..., self.partners, :],
            turns[..., self.partners, :],
            None if scales is None else scales[..., self.partners, :],
            morphs,
        )

    @staticmethod
    def delta(delta: RootDelta) -> RootDelta:
        """Return a mirrored root delta."""
        return RootDelta(-delta.x, delta.z, -delta.yaw)

    def clip(self, clip: Clip, name: str = "") -> Clip:
        """Return a mirrored clip; `with_phase` then finds its footfalls."""
        return replace(clip, name=name or clip.name, poses=self.pose(clip.poses))


@dataclass(frozen=True)
class Mirrored(TransformedMotion):
    """A motion with left and right exchanged; `Cyclic`.

    Its left footfall is the right footfall of the motion, so the phases of a motion with footfalls
    differ by half a cycle. Times are equal.
    """

    mirror: Mirror
    """The mirror of its skeleton."""

    def pose(self, pose: Pose) -> Pose:
        """Return a mirrored pose."""
        return self.mirror.pose(pose)

    def delta(self, delta: RootDelta) -> RootDelta:
        """Return a mirrored root delta."""
        return self.mirror.delta(delta)

    @property
    def lead(self) -> float:
        """Phase of the motion ahead of the mirrored one; negative if mirrored twice."""
        if isinstance(self.motion, Mirrored):
            return -self.motion.lead
        return 0.5 if has_footfalls(self.motion) else 0.0
