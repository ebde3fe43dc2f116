"""Chains of joints to be solved, and what a solver returns."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.errors import CharacterError
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.joint_limits import AngleLimits
from cubeling.characters.skeleton.pose import Array


@dataclass(frozen=True)
class Chains:
    """Chains of equally many joints, each with its base at the origin.

    Joint j turns bone j, as in glTF: with `G[j] = G[j − 1] q[j]` and `p[0] = 0`,
    `p[j + 1] = p[j] + G[j] offset[j]`. The thesis turns the bone before the joint (13.0.2).
    """

    offsets: Array
    """Each bone in the frame of its joint, (joints, 3), or (batch, joints, 3) [m]."""

    limits: AngleLimits | None = None
    """How far the joints turn, the same in all chains; None for freely."""

    def __post_init__(self) -> None:
        shape = self.offsets.shape
        if len(shape) not in (2, 3) or shape[-1] != 3 or 0 in shape:
            raise CharacterError(
                f"chains: offsets of shape {shape}; give (joints, 3) or (batch, joints, 3)"
            )
        if not np.isfinite(self.offsets).all():
            raise CharacterError("chains: an offset is not finite; leave that chain out")
        if self.limits is not None and len(self.limits) != self.joints:
            raise CharacterError(
                f"chains: limits of {len(self.limits)} joints for chains of {self.joints}"
            )

    @staticmethod
    def straight(lengths: Array, limits: AngleLimits | None = None) -> "Chains":
        """Return chains of bones (…, joints) [m] that lie along x where no joint is turned."""
        lengths = np.asarray(lengths, float)
        return Chains(lengths[..., None] * np.array([1.0, 0.0, 0.0]), limits)

    @property
    def joints(self) -> int:
        """Number of joints, and of bones, of each chain."""
        return len(self.offsets[0]) if self.offsets.ndim == 3 else len(self.offsets)

    @cached_property
    def lengths(self) -> Array:
        """Length of each bone, (…, joints) [m]."""
        lengths: Array = np.linalg.norm(self.offsets, axis=-1)
        return lengths

    @cached_property
    def reach(self) -> Array:
        """Length of each whole chain, (…) [m]."""
        total: Array = self.lengths.sum(-1)
        return total

    def rest(self, count: int) -> Array:
        """Return the local rotations of chains at rest, within their limits, (count, joints, 4)."""
        same = np.broadcast_to(rotations.IDENTITY, (count, self.joints, 4))
        return same.copy() if self.limits is None else self.limits.clamp(same)

    def random(self, count: int, random: np.random.Generator) -> Array:
        """Return random local rotations within the limits, (count, joints, 4)."""
        limits = AngleLimits.none(self.joints) if self.limits is None else self.limits
        shape = (count, self.joints, 3)
        return limits.rotations(random.uniform(limits.low, limits.high, shape))

    def frames(self, local: Array) -> tuple[Array, Array]:
        """Return `base_from_joint` rotations (batch, joints, 4) and points (batch, joints + 1, 3).

        The points [m] are those of the joints, and the end of the last bone.
        """
        turns = np.empty_like(local)
        points = np.zeros((*local.shape[:-2], self.joints + 1, 3))
        above: Array = rotations.IDENTITY
        for joint in range(self.joints):
            turns[..., joint, :] = above = rotations.multiply(above, local[..., joint, :])
            bone = rotations.rotate(above, self.offsets[..., joint, :])
            points[..., joint + 1, :] = points[..., joint, :] + bone
        return turns, points


@dataclass(frozen=True)
class Solution:
    """What a solver found for a batch of chains."""

    rotations: Array
    """Local rotations, (batch, joints, 4)."""

    positions: Array
    """Points of the joints, and the end of the last bone, (batch, joints + 1, 3) [m]."""

    iterations: NDArray[np.intp]
    """Iterations of the solver, (batch,): steps of springs or angles, or sweeps over the joints."""

    errors: Array
    """From the end of the chain to its target, (batch,) [m]; infinite for a target that is none."""

    solved: NDArray[np.bool_]
    """Whether the end is within the tolerance of its target, (batch,)."""
