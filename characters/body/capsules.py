"""A body as capsules, to tell whether it touches itself."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.model.mesh import Mesh
from cubeling.characters.skeleton.anatomy import SIDES, Anatomy
from cubeling.characters.skeleton.pose import Array, Pose, Skeleton

RADIUS_QUANTILE = 0.6
"""Share of the vertices of a body part that are inside its capsule: clothes may touch."""

_ARM_ENDS = ("LowerArm", "Hand")
CLEARANCE_M = 0.003
"""How much nearer than in clear poses two capsules may come [m]."""

_BONES = (
    *(("hips", "spine"), ("spine", "chest"), ("chest", "neck"), ("head", "")),
    *((s + a, s + b) for s in SIDES for a, b in (
        ("UpperArm", "LowerArm"), ("LowerArm", "Hand"), ("Hand", ""),
        ("UpperLeg", "LowerLeg"), ("LowerLeg", "Foot"))),
)  # fmt: skip


@dataclass(frozen=True)
class CapsuleBody:
    """Capsules along the bones of a body, and the pairs of them that must not meet."""

    joints: NDArray[np.intp]
    """The joint that carries each capsule, (capsules,)."""

    ends: Array
    """Both ends of the axis of each, in the frame of its joint, (capsules, 2, 3) [m]."""

    radii: Array
    """[m], (capsules,)."""

    pairs: NDArray[np.intp]
    """Numbers of two capsules each, (pairs, 2): a forearm or hand, and what it may reach."""

    reach: Array
    """How near the axes of each pair may come, (pairs,) [m]: at most the sum of the radii."""

    @staticmethod
    def of(
        skeleton: Skeleton, anatomy: Anatomy, meshes: Sequence[Mesh], clear: Pose
    ) -> "CapsuleBody":
        """Return the capsules of a character.

        Pairs that are nearer than their radii in the frames of `clear` may come as near: the body
        has that shape.
        """

        def met(one: int, other: int) -> bool:
            """Return whether one is a forearm or hand, and the other is not of the same arm."""
            names = anatomy.parts[joints[one]], anatomy.parts[joints[other]]
            arms = [name for name in names if name.endswith(_ARM_ENDS)]
            sides = [name[:4] for name in names if name.endswith((*_ARM_ENDS, "UpperArm"))]
            return bool(arms) and len(set(sides)) == len(sides)

        joints, ends, radii = fitted_capsules(skeleton, anatomy, meshes)
        pairs = np.array([pair for pair in combinations(range(len(joints)), 2) if met(*pair)])
        thick = np.array(radii)
        body = CapsuleBody(np.array(joints), np.array(ends), thick, pairs, np.zeros(len(pairs)))
        reach = np.minimum(thick[pairs].sum(1), body.gaps(clear, skeleton).min(0) - CLEARANCE_M)
        return replace(body, reach=reach)

    def gaps(self, poses: Pose, skeleton: Skeleton) -> Array:
        """Return how far the pairs are apart in poses (frames, …), (frames, pairs) [m]."""
        placed = poses.globals(skeleton)[:, self.joints]
        axes = np.einsum("fjab,jeb->fjea", placed[..., :3, :3], self.ends)
        axes = axes + placed[:, :, None, :3, 3]
        a, b = axes[:, self.pairs[:, 0]], axes[:, self.pairs[:, 1]]
        apart = segment_distances(a[..., 0, :], a[..., 1, :], b[..., 0, :], b[..., 1, :])
        return apart - self.reach

    def collides(self, poses: Pose, skeleton: Skeleton) -> NDArray[np.bool_]:
        """Return in which poses the body touches itself, (frames,)."""
        return np.asarray((self.gaps(poses, skeleton) < 0.0).any(1))


def fitted_capsules(
    skeleton: Skeleton, anatomy: Anatomy, meshes: Sequence[Mesh]
) -> tuple[list[int], list[Array], list[float]]:
    """Return joints, ends (2, 3) and radii of capsules along the bones that have a skin.

    Ends are in the frames of the joints; see `CapsuleBody`.
    """
    rest = skeleton.rest.globals(skeleton)
    vertices, weights = _skin(meshes, len(skeleton))
    joints: list[int] = []
    ends: list[Array] = []
    radii: list[float] = []
    for part, after in _BONES:
        joint, end = anatomy.joint(part), anatomy.joint(after)
        if joint is None:
            continue
        own = vertices[weights[:, joint] > 0.5]
        local = (np.linalg.inv(rest[joint]) @ np.c_[own, np.ones(len(own))].T)[:3].T
        if end is not None:
            tip = (np.linalg.inv(rest[joint]) @ rest[end])[:3, 3]
        elif len(local):
            tip = 2.0 * local.mean(0)  # to the far side: of a head, of a hand
        else:
            continue
        axis = np.stack([np.zeros(3), tip])
        if not after:
            axis = 0.5 * axis + 0.25 * tip  # the middle half, with a round end at either side
        if len(local) < 4:
            continue
        joints.append(joint)
        ends.append(axis)
        radii.append(float(np.quantile(_to_segment(local, *axis), RADIUS_QUANTILE)))
    return joints, ends, radii


def segment_distances(a: Array, b: Array, c: Array, d: Array) -> Array:
    """Return the distances of segments from a to b to segments from c to d, points (…, 3).

    Ericson, *Real-Time Collision Detection*, 2005, section 5.1.9.

    >>> ends = np.array([[0.0, 0, 0], [1, 0, 0], [0.5, 1, -1], [0.5, 1, 1]])
    >>> float(segment_distances(*ends))
    1.0
    """
    u, v, w = b - a, d - c, a - c
    uu, vv, uv = (u * u).sum(-1), (v * v).sum(-1), (u * v).sum(-1)
    uw, vw = (u * w).sum(-1), (v * w).sum(-1)
    across = uu * vv - uv * uv
    s = np.clip((uv * vw - uw * vv) / np.where(across > 1e-12, across, 1.0), 0.0, 1.0)
    s = np.where(across > 1e-12, s, 0.0)
    t = (uv * s + vw) / np.maximum(vv, 1e-12)
    held = np.clip(t, 0.0, 1.0)
    s = np.where(t == held, s, np.clip((uv * held - uw) / np.maximum(uu, 1e-12), 0.0, 1.0))
    apart = w + s[..., None] * u - held[..., None] * v
    distances: Array = np.linalg.norm(apart, axis=-1)
    return distances


def _skin(meshes: Sequence[Mesh], joints: int) -> tuple[Array, Array]:
    """Return the vertices of all meshes, (n, 3), and their weights, (n, joints)."""
    vertices = np.concatenate([mesh.positions for mesh in meshes]).astype(float)
    weights = np.zeros((len(vertices), joints))
    first = 0
    for mesh in meshes:
        rows = np.arange(first, first + len(mesh.positions))
        for influence in range(mesh.joints.shape[1]):
            np.add.at(weights, (rows, mesh.joints[:, influence]), mesh.weights[:, influence])
        first += len(mesh.positions)
    return vertices, weights


def _to_segment(points: Array, start: Array, end: Array) -> Array:
    """Return the distances of points (n, 3) to a segment."""
    along = (points - start) @ (end - start) / max(float((end - start) @ (end - start)), 1e-12)
    nearest = start + np.clip(along, 0.0, 1.0)[:, None] * (end - start)
    distances: Array = np.linalg.norm(points - nearest, axis=1)
    return distances
