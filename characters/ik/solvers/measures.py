"""What is measured of solvers: problems with a known solution, and qualities of what they find."""

from dataclasses import dataclass

import numpy as np

from cubeling.characters.ik.solvers.chains import Chains, Solution
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.joint_limits import EDGE_RAD, AngleLimits
from cubeling.characters.skeleton.pose import Array

REACH_M = 0.6
"""Length of the chains: about that of an arm."""

_START_BEND_RAD = 0.15  # of each joint at the start, all in one sense
_MIN_BEND_DEG = 2.0  # a smaller bend has no sense that a person sees
_MAX_WAY_DEG = 120.0  # of a bone from the start: farther, the shortest way is nearly undefined


@dataclass(frozen=True)
class ReachingProblem:
    """Chains, where they start, and targets that they reach within their limits."""

    chains: Chains
    """Equal chains with limits."""

    start: Array
    """Local rotations, (count, joints, 4): an arc in one plane."""

    targets: Array
    """Ends of random postures within the limits, (count, 3) [m]."""

    @property
    def free(self) -> Chains:
        """The chains without limits."""
        return Chains(self.chains.offsets)

    @staticmethod
    def random(joints: int, count: int, random: np.random.Generator) -> "ReachingProblem":
        """Return a problem with uniformly random angles as its solutions."""
        chains = Chains.straight(np.full(joints, REACH_M / joints), ball_limits(joints))
        _, points = chains.frames(chains.random(count, random))
        return ReachingProblem(chains, arc_targets(joints, count), points[:, -1])


def ball_limits(joints: int) -> AngleLimits:
    """Return limits that suit no limb in particular: a shoulder, then joints of a spine.

    The bend is that of the experiment in S16 (±120° at the base, else ±50°).
    """
    high = np.tile(np.radians([30.0, 50.0, 50.0]), (joints, 1))
    high[0] = np.radians([60.0, 80.0, 120.0])
    return AngleLimits.of_angles(-high, high)


def arc_targets(joints: int, count: int) -> Array:
    """Return local rotations that bend all joints by the same small angle, (count, joints, 4)."""
    bend = rotations.about("z", np.full(joints, _START_BEND_RAD))
    return np.tile(bend, (count, 1, 1))


def violations(chains: Chains, solution: Solution) -> int:
    """Return how many joints are beyond their limits."""
    if chains.limits is None:
        return 0
    return int(np.count_nonzero(chains.limits.excess(solution.rotations) > EDGE_RAD))


def joint_change(start: Array, local: Array) -> Array:
    """Return the summed angle between two postures of each chain, (…) [deg]."""
    between = rotations.multiply(local, rotations.conjugate(start))
    angles = np.linalg.norm(rotations.to_rotation_vector(between), axis=-1)
    total: Array = np.degrees(angles).sum(-1)
    return total


def zig_zag(points: Array) -> Array:
    """Return how often the sense of the bend changes along each chain, (…).

    Points are (…, joints + 1, 3). Bends below 2° count as straight.
    """
    bones = np.diff(points, axis=-2)
    bones = bones / np.maximum(np.linalg.norm(bones, axis=-1, keepdims=True), 1e-12)
    bends = rotations.cross(bones[..., :-1, :], bones[..., 1:, :])
    seen = np.linalg.norm(bends, axis=-1) > np.sin(np.radians(_MIN_BEND_DEG))
    opposite = (bends[..., :-1, :] * bends[..., 1:, :]).sum(-1) < 0
    changes: Array = (opposite & seen[..., :-1] & seen[..., 1:]).sum(-1).astype(float)
    return changes


def twist(chains: Chains, start: Array, local: Array) -> Array:
    """Return by how much bones twist from each posture to the next, (frames − 1, joints) [deg].

    A twist is the part of the turn that is about the bone. It is not a number where a bone points
    almost opposite to how it starts, (joints, 4): there the shortest way is undefined (S15).
    """
    frames, _ = chains.frames(local)
    bones = rotations.rotate(frames, chains.offsets)
    bones = bones / np.linalg.norm(bones, axis=-1, keepdims=True)
    turn = rotations.multiply(frames[1:], rotations.conjugate(frames[:-1]))
    about = (turn[..., :3] * bones[:-1]).sum(-1)
    angles = np.degrees(np.abs(2 * np.arctan2(about, np.abs(turn[..., 3]))))
    begun = rotations.rotate(chains.frames(start)[0], chains.offsets)
    begun = begun / np.linalg.norm(begun, axis=-1, keepdims=True)
    defined = (bones * begun).sum(-1) > np.cos(np.radians(_MAX_WAY_DEG))
    return np.where(defined[1:] & defined[:-1], angles, np.nan)


def target_path(frames: int, step_m: float, random: np.random.Generator) -> Array:
    """Return a circle about a place in reach, with steps of a length [m], (frames, 3) [m]."""
    phase = random.uniform(0, 2 * np.pi, 3)
    normal, across = np.linalg.qr(random.normal(size=(3, 2)))[0].T
    radius = frames * step_m / (2 * np.pi)
    angle = np.linspace(0, 2 * np.pi, frames, endpoint=False) + phase[0]
    centre = rotations.rotate(rotations.about("y", phase[1]), [0.35, 0.0, 0.0])
    path: Array = centre + radius * (
        np.cos(angle)[:, None] * normal + np.sin(angle)[:, None] * across
    )
    return path
