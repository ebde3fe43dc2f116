"""Damped least squares for one chain, in scalars: a tenth of the time of a batch of one.

The same method as "damped" in `SOLVERS`: points without limits first, then, if a limit is left, the
Euler angles from there (see `jacobian`).
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import accumulate

import numpy as np

from cubeling.characters.ik.solvers.chains import Chains
from cubeling.characters.ik.solvers.rules import damped_pull
from cubeling.characters.ik.solvers.single_limits import LimitedJoints, solve_angles
from cubeling.characters.ik.solvers.solving import TOLERANCE, solve
from cubeling.characters.skeleton.scalar_quaternions import (
    IDENTITY,
    Quaternion,
    Vector,
    between,
    conjugate,
    multiply,
    normalize,
    rotate,
)

MAX_STEPS = 20
"""Most steps, without limits and again with them."""

Points = list[Vector]


@dataclass(frozen=True)
class SingleSolution:
    """What was found for one chain."""

    rotations: list[Quaternion]
    """Local rotation of each joint."""

    positions: Points
    """Points of the joints, and the end of the last bone [m]."""

    error: float
    """From the end to the target [m]."""

    iterations: int
    """Number of steps that it took."""


class SingleChain:
    """One chain, ready to be solved many times."""

    def __init__(self, chains: Chains) -> None:
        offsets = chains.offsets if chains.offsets.ndim == 2 else chains.offsets[0]
        self.offsets: Points = [(float(x), float(y), float(z)) for x, y, z in offsets]
        self.chains = Chains(np.asarray(offsets), chains.limits)
        self.lengths = [math.hypot(*offset) for offset in self.offsets]
        self.reach = math.fsum(self.lengths)
        self._nearest = max(2 * max(self.lengths) - self.reach, 0.0)
        limits = chains.limits
        self._limited = None if limits is None else LimitedJoints.of(limits, self.offsets)

    def solve(
        self,
        target: Vector,
        start: Sequence[Sequence[float]],
        tolerance: float = TOLERANCE,
        *,
        alone: bool = False,
    ) -> SingleSolution:
        """Return local rotations that bring the end to a target, or as near as it comes.

        Parameters
        ----------
        target
            [m] from the base.
        start
            Local rotations xyzw to start from.
        tolerance
            How near is near enough, in lengths of the chain.
        alone
            Whether to leave a target that is not reached at once; otherwise `solve` starts again,
            which takes milliseconds.
        """
        frames, points = self.frames(start)
        goal = self._within_reach(target, points[-1])
        near = tolerance * self.reach
        moved, steps = _move(points, goal, near)
        if goal is not target and math.dist(target, points[0]) > self.reach:
            moved = self._straight(goal)
        turns = _orient(frames, points, moved)
        limited = self._limited
        if limited is not None and not limited.allow(angles := limited.angles(turns)):
            angles, _, more = solve_angles(limited, angles, goal, near, MAX_STEPS)
            turns, steps = limited.turns(angles), steps + more
        _, moved = self.frames(turns)
        if not alone and math.dist(moved[-1], goal) > near:
            found = solve(self.chains, np.array([target]), np.array([start]), tolerance=tolerance)
            turns = [(x, y, z, w) for x, y, z, w in found.rotations[0].tolist()]
            _, moved = self.frames(turns)
        return SingleSolution(turns, moved, math.dist(moved[-1], target), steps)

    def frames(self, turns: Sequence[Sequence[float]]) -> tuple[list[Quaternion], Points]:
        """Return base-frame rotations and points of local rotations."""
        above: Quaternion = IDENTITY
        x = y = z = 0.0
        frames: list[Quaternion] = []
        points: Points = [(0.0, 0.0, 0.0)]
        for turn, offset in zip(turns, self.offsets, strict=True):
            above = multiply(above, turn)
            dx, dy, dz = rotate(above, offset)
            x, y, z = x + dx, y + dy, z + dz
            frames.append(above)
            points.append((x, y, z))
        return frames, points

    def _straight(self, target: Vector) -> Points:
        """Return the points of the chain pointing straight to a target."""
        x, y, z = (each / self.reach for each in target)
        along = accumulate(self.lengths, initial=0.0)
        return [(x * far, y * far, z * far) for far in along]

    def _within_reach(self, target: Vector, end: Vector) -> Vector:
        far = math.dist(target, (0.0, 0.0, 0.0))
        wanted = min(max(far, self._nearest), self.reach * (1 - 1e-9))
        if wanted == far:
            return target
        x, y, z = target if far > 1e-12 else end
        scale = wanted / max(math.sqrt(x * x + y * y + z * z), 1e-12)
        return x * scale, y * scale, z * scale


def _move(points: Points, target: Vector, near: float) -> tuple[Points, int]:
    """Return points whose last one is at the target, and the number of steps."""
    for step in range(MAX_STEPS):
        if math.dist(points[-1], target) <= near:
            return points, step
        points = _step(points, target)
    return points, MAX_STEPS


def _step(points: Points, target: Vector) -> Points:
    """Turn all bones of a chain at once (see `jacobian.JacobianMover`)."""
    ex, ey, ez = points[-1]
    xx = yy = zz = xy = xz = yz = 0.0
    arms: Points = []
    for px, py, pz in points[:-1]:
        x, y, z = ex - px, ey - py, ez - pz
        arms.append((x, y, z))
        xx += y * y + z * z
        yy += x * x + z * z
        zz += x * x + y * y
        xy -= x * y
        xz -= x * z
        yz -= y * z
    error = target[0] - ex, target[1] - ey, target[2] - ez
    # Half of the pull: the Cayley map wants half of each turn.
    kx, ky, kz = (0.5 * each for each in damped_pull((xx, yy, zz, xy, xz, yz), error))
    wx = wy = wz = qx = qy = qz = 0.0
    px, py, pz = points[0]
    moved = [points[0]]
    for (x, y, z), (nx, ny, nz) in zip(arms, points[1:], strict=True):
        wx, wy, wz = wx + y * kz - z * ky, wy + z * kx - x * kz, wz + x * ky - y * kx
        bx, by, bz = nx - px, ny - py, nz - pz
        cx, cy, cz = wy * bz - wz * by, wz * bx - wx * bz, wx * by - wy * bx
        scale = 2.0 / (1.0 + wx * wx + wy * wy + wz * wz)
        qx += bx + scale * (cx + wy * cz - wz * cy)
        qy += by + scale * (cy + wz * cx - wx * cz)
        qz += bz + scale * (cz + wx * cy - wy * cx)
        moved.append((qx, qy, qz))
        px, py, pz = nx, ny, nz
    return moved


def _orient(frames: list[Quaternion], before: Points, after: Points) -> list[Quaternion]:
    """Return local rotations that put the joints at new points; each bone the shortest way."""
    turns: list[Quaternion] = []
    above: Quaternion = IDENTITY
    way: Quaternion = IDENTITY
    for joint, frame in enumerate(frames):
        old, new = _bone(before, joint), _bone(after, joint)
        if old != (0.0, 0.0, 0.0):  # a bone without a direction follows the one before it
            way = between(old, new)
        now = normalize(multiply(way, frame))
        turns.append(multiply(conjugate(above), now))
        above = now
    return turns


def _bone(points: Points, joint: int) -> Vector:
    (ax, ay, az), (bx, by, bz) = points[joint], points[joint + 1]
    return bx - ax, by - ay, bz - az
