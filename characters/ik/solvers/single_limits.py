"""Damped least squares of the Euler angles of one chain, within limits, in scalars.

The method of `jacobian`: see there.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

from cubeling.characters.ik.solvers.rules import damped_pull
from cubeling.characters.skeleton.joint_limits import EDGE_RAD, AngleLimits
from cubeling.characters.skeleton.scalar_quaternions import (
    IDENTITY,
    Quaternion,
    Vector,
    add,
    conjugate,
    cross,
    dot,
    multiply,
    rotate,
)

_MAX_TURN_RAD = 1.2  # of an angle in a step

Axis = tuple[Vector, Vector]
"""An axis of a joint and the place of the joint, in the frame of the base."""

Basis = tuple[Vector, Vector, Vector]
"""Three unit vectors at right angles: the axes x, y and z of a joint."""


@dataclass(frozen=True)
class LimitedJoints:
    """The joints of one chain, with their limits."""

    before: list[Quaternion]
    """`parent_from_axes` of each joint."""

    after: list[Quaternion]
    """`axes_from_joint` of each joint."""

    low: list[float]
    """Least angles: φ, θ, ψ of the first joint, then of the next [rad]."""

    high: list[float]
    """Greatest angles [rad]."""

    bones: list[Vector]
    """Each bone in the axes of its joint [m]."""

    links: list[Basis | None]
    """The axes of each joint at zero in those of the joint before; None where they are the same."""

    @staticmethod
    def of(limits: AngleLimits, offsets: Sequence[Vector]) -> "LimitedJoints":
        """Return the joints with limits and bones, in their own frames [m]."""
        before: list[Quaternion] = [(x, y, z, w) for x, y, z, w in limits.before.tolist()]
        after: list[Quaternion] = [(x, y, z, w) for x, y, z, w in limits.after.tolist()]
        above = [IDENTITY, *after[:-1]]
        links = [multiply(upper, own) for upper, own in zip(above, before, strict=True)]
        return LimitedJoints(
            before,
            after,
            limits.low.ravel().tolist(),
            limits.high.ravel().tolist(),
            [rotate(turn, offset) for turn, offset in zip(after, offsets, strict=True)],
            [None if abs(link[3]) > 1 - 1e-14 else _basis(link) for link in links],
        )

    @cached_property
    def _inverses(self) -> list[tuple[Quaternion, Quaternion]]:
        pairs = zip(self.before, self.after, strict=True)
        return [(conjugate(before), conjugate(after)) for before, after in pairs]

    def angles(self, turns: Sequence[Sequence[float]]) -> list[float]:
        """Return the angles of local rotations."""
        angles: list[float] = []
        for (before, after), turn in zip(self._inverses, turns, strict=True):
            x, y, z, w = multiply(multiply(before, turn), after)
            angles.append(math.atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y)))
            angles.append(math.asin(min(max(2 * (w * y - z * x), -1.0), 1.0)))
            angles.append(math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z)))
        return angles

    def turns(self, angles: list[float]) -> list[Quaternion]:
        """Return the local rotations of angles."""
        turns: list[Quaternion] = []
        for joint, (before, after) in enumerate(zip(self.before, self.after, strict=True)):
            f, t, p = (0.5 * angle for angle in angles[3 * joint : 3 * joint + 3])
            sf, st, sp, cf, ct, cp = (
                *(math.sin(f), math.sin(t), math.sin(p)),
                *(math.cos(f), math.cos(t), math.cos(p)),
            )
            x, y = sf * ct * cp - cf * st * sp, cf * st * cp + sf * ct * sp
            inner = x, y, cf * ct * sp - sf * st * cp, cf * ct * cp + sf * st * sp
            turns.append(multiply(multiply(before, inner), after))
        return turns

    def allow(self, angles: list[float]) -> bool:
        """Return whether all angles are within the limits."""
        return all(
            low - EDGE_RAD <= angle <= high + EDGE_RAD
            for low, angle, high in zip(self.low, angles, self.high, strict=True)
        )

    def cut(self, angles: list[float]) -> list[float]:
        """Return the angles cut off at the limits."""
        return [
            min(max(low, angle), high)
            for low, angle, high in zip(self.low, angles, self.high, strict=True)
        ]


def solve_angles(
    joints: LimitedJoints,
    angles: list[float],
    target: Vector,
    near: float,
    max_steps: int,
) -> tuple[list[float], float, int]:
    """Return the best angles within the limits, their error [m], and the number of steps."""
    angles = best = joints.cut(angles)
    least = math.inf
    for step in range(max_steps + 1):
        frames, end = _axes(joints, angles)
        error = target[0] - end[0], target[1] - end[1], target[2] - end[2]
        size = math.sqrt(dot(error, error))
        if size < least:
            best, least = angles, size
        if size <= near or step == max_steps:
            return best, least, step
        rows = [
            cross(axis, (end[0] - px, end[1] - py, end[2] - pz)) for axis, (px, py, pz) in frames
        ]
        angles = joints.cut(_step(joints, rows, angles, error))
    return best, least, max_steps


def _step(
    joints: LimitedJoints, rows: list[Vector], angles: list[float], error: Vector
) -> list[float]:
    """Return angles after one step, not yet cut off; those at a limit do not go beyond it."""
    change = _change(rows, error)
    held = [
        (turn < 0 and angle <= low) or (turn > 0 and angle >= high)
        for turn, angle, low, high in zip(change, angles, joints.low, joints.high, strict=True)
    ]
    if any(held):
        rows = [(0.0, 0.0, 0.0) if no else row for no, row in zip(held, rows, strict=True)]
        change = _change(rows, error)
    largest = max(max(change), -min(change))
    scale = min(1.0, _MAX_TURN_RAD / max(largest, 1e-12))
    return [angle + scale * turn for angle, turn in zip(angles, change, strict=True)]


def _change(rows: list[Vector], error: Vector) -> list[float]:
    xx = yy = zz = xy = xz = yz = 0.0
    for x, y, z in rows:
        xx += x * x
        yy += y * y
        zz += z * z
        xy += x * y
        xz += x * z
        yz += y * z
    a, b, c = damped_pull((xx, yy, zz, xy, xz, yz), error)
    return [x * a + y * b + z * c for x, y, z in rows]


def _axes(joints: LimitedJoints, angles: list[float]) -> tuple[list[Axis], Vector]:
    """Return the axes of the angles φ, θ, ψ of each joint, with their places, and the end."""
    found: list[Axis] = []
    (x, y, z), place = _basis(IDENTITY), (0.0, 0.0, 0.0)
    sines, cosines = list(map(math.sin, angles)), list(map(math.cos, angles))
    for joint, (link, bone) in enumerate(zip(joints.links, joints.bones, strict=True)):
        if link is not None:
            a, b, c = link
            x, y, z = _sum(x, y, z, a), _sum(x, y, z, b), _sum(x, y, z, c)
        last = z
        x, y = _turn(x, y, sines[3 * joint + 2], cosines[3 * joint + 2])
        middle = y
        z, x = _turn(z, x, sines[3 * joint + 1], cosines[3 * joint + 1])
        found += (x, place), (middle, place), (last, place)
        y, z = _turn(y, z, sines[3 * joint], cosines[3 * joint])
        place = add(place, _sum(x, y, z, bone))
    return found, place


def _basis(q: Quaternion) -> Basis:
    return rotate(q, (1.0, 0.0, 0.0)), rotate(q, (0.0, 1.0, 0.0)), rotate(q, (0.0, 0.0, 1.0))


def _sum(x: Vector, y: Vector, z: Vector, weights: Vector) -> Vector:
    """Return the weighted sum of three axes."""
    a, b, c = weights
    return (
        a * x[0] + b * y[0] + c * z[0],
        a * x[1] + b * y[1] + c * z[1],
        a * x[2] + b * y[2] + c * z[2],
    )


def _turn(x: Vector, y: Vector, sine: float, cosine: float) -> tuple[Vector, Vector]:
    """Return two axes turned about the third one."""
    return (
        (cosine * x[0] + sine * y[0], cosine * x[1] + sine * y[1], cosine * x[2] + sine * y[2]),
        (cosine * y[0] - sine * x[0], cosine * y[1] - sine * x[1], cosine * y[2] - sine * x[2]),
    )
