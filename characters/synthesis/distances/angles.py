"""The distance of the thesis, and that of Lee et al.: weighted joint angles and velocities."""

from collections.abc import Mapping

import numpy as np

from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.pose import Array
from cubeling.characters.synthesis.distances.distance import Block, squared_differences
from cubeling.characters.synthesis.library import Frames, MotionLibrary

_STRETCH = 1.0 + 4e-7
"""Factor of the quaternions of a block: rounding then cannot make equal poses unlike."""


class JointAngles:
    """Squared weighted joint angles plus a share of squared velocities; a `FrameDistance`.

    D(a, b) = d(a, b) + v d(ȧ, ḃ), with d(a, b) = (h_a − h_b)² + Σ w_k |log(q_b,k⁻¹ q_a,k)|²:
    M1 eq. 2.1 and 2.2 as corrected by erratum 1. h is the height of the hips; their orientation is
    taken without its yaw. |log q| is half of the angle. It depends on |q_a · q_b| only, so a sign
    does not matter, and for all frames it is one matrix product a joint. Place and yaw count as
    velocities of the root.

    Parameters
    ----------
    library
        The frames.
    weights
        Weight of each joint that counts, by its number.
    velocity
        The influence v of velocities; those of joints in rad/s, that of the root in m/s and rad/s.
    height
        The weight of the height of the hips.
    """

    def __init__(
        self,
        library: MotionLibrary,
        weights: Mapping[int, float],
        velocity: float = 0.0,
        height: float = 1.0,
    ) -> None:
        self._weights = np.array([*weights.values()])
        turns = _orient(library, [*weights])
        self._turns = np.ascontiguousarray(turns.swapaxes(0, 1))  # (joints, frames, 4)
        self._blocks = (self._turns * _STRETCH).astype(np.float32)
        rows = [_hips_height(library)[:, None] * np.sqrt(height)] if height else []
        if velocity:
            rows.append(_velocities(library, turns, self._weights) * np.sqrt(velocity))
        rows.append(np.zeros((len(library), 1)))
        self._rows = np.concatenate(rows, axis=1)
        self._row_blocks = (self._rows - self._rows.mean(0)).astype(np.float32)

    def __len__(self) -> int:
        return len(self._rows)

    def block(self, rows: Frames, columns: Frames) -> Block:
        """Return the distances of frames to frames."""
        total = squared_differences(self._row_blocks[rows], self._row_blocks[columns])
        for turns, weight in zip(self._blocks, self._weights.astype(np.float32), strict=True):
            angle = turns[rows] @ turns[columns].T
            np.abs(angle, out=angle)
            np.minimum(angle, 1.0, out=angle)
            np.arccos(angle, out=angle)
            angle *= angle
            angle *= weight
            total += angle
        return total

    def pairs(self, a: Frames, b: Frames) -> Array:
        """Return the distances of frames to frames, one to one."""
        difference = self._rows[a] - self._rows[b]
        total: Array = np.einsum("ij,ij->i", difference, difference)
        for turns, weight in zip(self._turns, self._weights, strict=True):
            # The chord between q_a and ±q_b, exact for small angles: |q_a − q_b| = 2 sin(half / 2).
            apart, opposite = (np.linalg.norm(turns[a] + s * turns[b], axis=-1) for s in (-1, 1))
            chord = np.minimum(apart, opposite)
            total += weight * np.square(2 * np.arcsin(np.minimum(chord / 2, 1.0)))
        return total


def _orient(library: MotionLibrary, joints: list[int]) -> Array:
    """Return the local rotations of joints, (frames, joints, 4), the hips' in the world's axes.

    Theirs has no yaw, so that frames are alike whichever way they face.
    """
    turns = library.poses.rotations[:, joints].copy()
    hips = library.anatomy.joint("hips")
    if hips in joints:
        turns[:, joints.index(hips)] = hips_tilt(library)
    return turns


def hips_tilt(library: MotionLibrary) -> Array:
    """Return the orientation of the hips without their yaw, (frames, 4)."""
    skeleton, hips = library.skeleton, library.anatomy.joint("hips") or 0
    turned = from_rest = rotations.IDENTITY
    for joint in skeleton.with_ancestors([hips]):
        turned = rotations.multiply(turned, library.poses.rotations[:, joint])
        from_rest = rotations.multiply(from_rest, skeleton.rest.rotations[joint])
    turned = rotations.multiply(turned, rotations.conjugate(from_rest))
    return rotations.multiply(rotations.about("y", -rotations.heading(turned)), turned)


def _hips_height(library: MotionLibrary) -> Array:
    height: Array = library.positions[:, library.anatomy.joint("hips") or 0, 1]
    return height


def _velocities(library: MotionLibrary, turns: Array, weights: Array) -> Array:
    """Return the velocities of joints and root, (frames, columns), times the roots of weights.

    They are those towards the next frame of the clip; a last frame has those before it.
    """
    starts = np.where(library.successors < 0, library.predecessors, np.arange(len(library)))
    ends = library.successors[starts]
    between = rotations.multiply(rotations.conjugate(turns[starts]), turns[ends])
    spins = rotations.to_rotation_vector(between) * (library.rate * np.sqrt(weights)[:, None])
    rises = _hips_height(library)[ends] - _hips_height(library)[starts]
    root = np.concatenate([library.steps, rises[:, None]], axis=1) * library.rate
    return np.concatenate([spins.reshape(len(library), -1), root], axis=1)
