"""Posture space: postures as vectors, and their principal components.

Source: Egges 2006, sections 2.1.2, 3.2 and 3.3.1 (S1, S4, S5).
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.anatomy import SIDES, Anatomy
from cubeling.characters.skeleton.masks import subtree
from cubeling.characters.skeleton.pose import Array, Pose, Skeleton

Region = Literal["whole", "upper", "lower"]
"""The part of the body that a posture vector describes."""

Weights = Literal["eigen", "eigen_norm", "one"]
"""How components count in a distance: by their variances, by these over the first one, alike."""

_UPPER = (
    *("spine", "chest", "upperChest", "neck", "head"),
    *(side + part for side in SIDES for part in ("Shoulder", "UpperArm", "LowerArm", "Hand")),
)
_LOWER = ("hips", *(s + part for s in SIDES for part in ("UpperLeg", "LowerLeg", "Foot", "Toes")))


@dataclass(frozen=True)
class PostureVectors:
    """What a posture vector of a skeleton holds.

    It is the rotation of each joint from its rest as an exponential map [rad], then, but for the
    upper body, how far the hips are from their rest [m]. Fingers, eyes and face are left out.
    """

    skeleton: Skeleton

    joints: tuple[int, ...]
    """Indices of the joints whose rotations are compared, (n,)."""

    hips: int | None
    """The joint whose translation counts, or None."""

    others: Pose | None = None
    """Holds the other joints, and all scales; None for the rest pose."""

    @staticmethod
    def of(skeleton: Skeleton, anatomy: Anatomy, region: Region = "whole") -> "PostureVectors":
        """Return the posture vectors of a region; on four legs, all regions are the whole body."""
        hips, head = anatomy.joint("hips"), anatomy.joint("head")
        if anatomy.kind == "quadruped" and hips is not None:
            face = set() if head is None else set(subtree(skeleton, head)) - {head}
            body = tuple(joint for joint in subtree(skeleton, hips) if joint not in face)
            return PostureVectors(skeleton, body, hips)
        parts = {"whole": _LOWER + _UPPER, "upper": _UPPER, "lower": _LOWER}[region]
        joints = tuple(joint for part in parts if (joint := anatomy.joint(part)) is not None)
        return PostureVectors(skeleton, joints, None if region == "upper" else hips)

    @cached_property
    def _joints(self) -> NDArray[np.intp]:
        return np.array(self.joints, np.intp)

    @cached_property
    def _resting(self) -> Array:
        """Rest rotations of the joints, (n, 4)."""
        return self.skeleton.rest.rotations[self._joints]

    @property
    def size(self) -> int:
        """Number of values in a vector."""
        return 3 * len(self.joints) + (0 if self.hips is None else 3)

    def vectors(self, poses: Pose) -> Array:
        """Return the vectors of a clip's poses, (frames, size), without jumps within the clip.

        That of a single pose is (size,).
        """
        if poses.rotations.ndim == 2:
            single: Array = self.vectors(poses[None])[0]
            return single
        rest = self.skeleton.rest
        turns = rotations.multiply(
            rotations.conjugate(self._resting), poses.rotations[:, self._joints]
        )
        vectors = continuous_rotation_vectors(turns).reshape(len(turns), -1)
        if self.hips is None:
            return vectors
        moved = poses.translations[:, self.hips] - rest.translations[self.hips]
        return np.concatenate([vectors, moved], axis=1)

    def poses(self, vectors: Array, others: Pose | None = None) -> Pose:
        """Return the poses of vectors (…, size); `others` hold all that they leave out."""
        rest, count = self.skeleton.rest, len(self.joints)
        base, shape = others or self.others or rest, vectors.shape[:-1]
        turns, moved = (
            np.broadcast_to(part, (*shape, *part.shape[-2:])).copy() if shape else part.copy()
            for part in (base.rotations, base.translations)
        )
        own = rotations.from_rotation_vector(vectors[..., : 3 * count].reshape(*shape, count, 3))
        turns[..., self._joints, :] = rotations.multiply(self._resting, own)
        if self.hips is not None:
            moved[..., self.hips, :] = rest.translations[self.hips] + vectors[..., -3:]
        scales = None if base.scales is None else np.broadcast_to(base.scales, moved.shape)
        face = None if others is None else others.morphs
        if face is not None:
            face = np.broadcast_to(face, (*shape, face.shape[-1]))
        return Pose(moved, turns, scales, face)


def continuous_rotation_vectors(turns: Array) -> Array:
    """Return rotations (frames, joints, 4) as rotation vectors (frames, joints, 3) without jumps.

    A logarithm has many branches: 2πn ± θ. Each frame takes the one nearest to the frame before;
    the clip as a whole stays near the origin.

    >>> sweep = rotations.about("y", np.linspace(3.0, 3.2, 3))[:, None]  # beyond half a turn
    >>> continuous_rotation_vectors(sweep)[:, 0, 1].round(6).tolist()
    [3.0, 3.1, 3.2]
    """
    turns = rotations.continuous(turns)
    turns = turns * np.where(turns[..., 3].mean(0) < 0, -1.0, 1.0)[:, None]
    vector, real = turns[..., :3], turns[..., 3:]
    length = np.linalg.norm(vector, axis=-1, keepdims=True)
    angle = 2.0 * np.arctan2(length, real)
    small = length < 1e-8
    scale = np.where(small, 2.0, angle / np.where(small, 1.0, length))
    found: Array = vector * scale
    return found


@dataclass(frozen=True)
class PostureSpace:
    """Principal components of posture vectors."""

    mean: Array
    """Subtracted before the projection, (size,); zeros if the space is not centred."""

    components: Array
    """One component a column, by falling variance, (size, size)."""

    variances: Array
    """Variance along each component, (size,)."""

    @staticmethod
    def of(vectors: Array, *, centred: bool = True) -> "PostureSpace":
        """Return the space of posture vectors (frames, size).

        The documents take the covariance about the mean, and do not say whether the projection
        subtracts it (erratum 15). Of each component, the largest entry is positive.
        """
        middle = vectors.mean(0)
        offsets = vectors - middle
        variances, components = np.linalg.eigh(offsets.T @ offsets / max(len(vectors) - 1, 1))
        variances, components = variances[::-1], components[:, ::-1]
        largest = np.abs(components).argmax(0)
        components = components * np.sign(components[largest, np.arange(len(largest))])
        mean = middle if centred else np.zeros_like(middle)
        return PostureSpace(mean, components, np.maximum(variances, 0.0))

    def project(self, vectors: Array, count: int | None = None) -> Array:
        """Return the first coordinates of vectors, (…, count)."""
        return (vectors - self.mean) @ self.components[:, :count]

    def restore(self, coordinates: Array) -> Array:
        """Return the vectors of coordinates (…, count); those left out are 0."""
        count = coordinates.shape[-1]
        return self.mean + coordinates @ self.components[:, :count].T

    def weights(self, mode: Weights) -> Array:
        """Return how much each component counts in a distance, (size,)."""
        if mode == "one":
            return np.ones_like(self.variances)
        return self.variances / (self.variances[0] if mode == "eigen_norm" else 1.0)

    def distances(self, one: Array, others: Array, mode: Weights = "one") -> Array:
        """Return the distances of coordinates (n, count) to others (m, count), (n, m) (eq. 3.7).

        How many components count is up to the coordinates: ten find the nearest of all in most
        cases (S5).
        """
        roots = np.sqrt(self.weights(mode)[: one.shape[-1]])
        a, b = one * roots, others * roots
        squares = (a**2).sum(1)[:, None] + (b**2).sum(1) - 2.0 * a @ b.T
        distances: Array = np.sqrt(np.maximum(squares, 0.0))
        return distances
