"""How far joints turn: intervals of Euler angles about axes of each joint (Huang, S16)."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from cubeling.characters.errors import CharacterError
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.pose import Array

EDGE_RAD = 1e-6
"""How far beyond a limit an angle still counts as within: rounding, and no more."""

MAX_MIDDLE_RAD = np.pi / 2
"""Largest middle angle θ that rotations have [rad]."""


@dataclass(frozen=True)
class AngleLimits:
    """The intervals of the angles of joints.

    A local rotation is `before · Rz(ψ) Ry(θ) Rx(φ) · after`, and each of (φ, θ, ψ) has an interval.
    That of the middle one, θ, is within ±90°: any rotation has such a θ, and beyond it the same
    rotation would have other angles, so that a limit there is never met.
    """

    low: Array
    """Least (φ, θ, ψ) of each joint, (joints, 3) [rad]."""

    high: Array
    """Greatest (φ, θ, ψ) of each joint, (joints, 3) [rad]."""

    before: Array
    """`parent_from_axes` rotation of the joint at zero angles, (joints, 4)."""

    after: Array
    """`axes_from_joint` rotation, (joints, 4)."""

    def __post_init__(self) -> None:
        count = len(self.low)
        shapes = [a.shape for a in (self.low, self.high, self.before, self.after)]
        if shapes != [(count, 3), (count, 3), (count, 4), (count, 4)]:
            raise CharacterError(f"joint limits: arrays of shapes {shapes} are not of one size")
        wrong = ~(self.low <= self.high).all(-1)
        if wrong.any():
            joint = int(wrong.argmax())
            raise CharacterError(
                f"joint limits: joint {joint} turns from {self.low[joint].round(3).tolist()} to "
                f"{self.high[joint].round(3).tolist()} rad; no lower limit may exceed its upper one"
            )

        steep = (np.abs([self.low[:, 1], self.high[:, 1]]) > MAX_MIDDLE_RAD + EDGE_RAD).any(0)
        if steep.any():
            joint = int(steep.argmax())
            interval = np.degrees([self.low[joint, 1], self.high[joint, 1]]).round(1).tolist()
            raise CharacterError(
                f"joint limits: joint {joint} turns from {interval[0]} to {interval[1]}° about its "
                "middle axis, y; keep that within ±90°, or choose axes whose first or last one is "
                "that of the wide turn"
            )

    @staticmethod
    def of_angles(low: Array, high: Array) -> "AngleLimits":
        """Return limits about the axes of the joints themselves, (joints, 3) [rad]."""
        same = np.tile(rotations.IDENTITY, (len(low), 1))
        return AngleLimits(np.asarray(low, float), np.asarray(high, float), same, same)

    @staticmethod
    def none(joints: int) -> "AngleLimits":
        """Return the limits of joints that turn freely."""
        wide = np.tile([np.pi, MAX_MIDDLE_RAD, np.pi], (joints, 1))
        return AngleLimits.of_angles(-wide, wide)

    @cached_property
    def turned(self) -> bool:
        """Whether the axes of any joint differ from those of the joint itself."""
        return bool((self.before[:, :3] != 0).any() or (self.after[:, :3] != 0).any())

    def __len__(self) -> int:
        return len(self.low)

    def __getitem__(self, joints: Sequence[int]) -> "AngleLimits":
        """Return the limits of some of the joints."""
        at = list(joints)
        return AngleLimits(self.low[at], self.high[at], self.before[at], self.after[at])

    def angles(self, local: Array) -> Array:
        """Return (φ, θ, ψ) of local rotations (…, joints, 4), (…, joints, 3) [rad]."""
        inner = rotations.multiply(rotations.conjugate(self.before), local)
        return to_euler(rotations.multiply(inner, rotations.conjugate(self.after)))

    def rotations(self, angles: Array) -> Array:
        """Return the local rotations of (φ, θ, ψ), (…, joints, 3) [rad]."""
        inner = rotations.from_euler("zyx", angles[..., ::-1])
        return rotations.multiply(rotations.multiply(self.before, inner), self.after)

    def excess(self, local: Array) -> Array:
        """Return by how much the worst angle of each joint leaves its interval, (…, joints) [rad].

        >>> limits = AngleLimits.of_angles(np.full((1, 3), -0.5), np.full((1, 3), 0.5))
        >>> limits.excess(rotations.about("y", [0.7])).round(6).tolist()
        [0.2]
        """
        angles = self.angles(local)
        beyond: Array = np.maximum(self.low - angles, angles - self.high).max(-1)
        return np.maximum(beyond, 0.0)

    def clamp(self, local: Array) -> Array:
        """Return local rotations (…, joints, 4) with their angles within the intervals.

        Rotations within the limits are returned unchanged, to the last bit.
        """
        angles = self.angles(local)
        clamped = np.clip(angles, self.low, self.high)
        inside = (clamped == angles).all(-1)
        return np.where(inside[..., None], local, self.rotations(clamped))

    def widen(self, angle: float) -> "AngleLimits":
        """Return limits that are wider by an angle [rad] on each side, the middle ones to ±90°."""
        low, high = self.low - angle, self.high + angle
        low[:, 1] = np.maximum(low[:, 1], -MAX_MIDDLE_RAD)
        high[:, 1] = np.minimum(high[:, 1], MAX_MIDDLE_RAD)
        return replace(self, low=low, high=high)


def to_euler(q: Array) -> Array:
    """Return (φ, θ, ψ) of rotations Rz(ψ) Ry(θ) Rx(φ), (…, 3) [rad] (Huang, 13.0.12).

    >>> to_euler(rotations.from_euler("zyx", [0.3, -0.2, 0.1])).round(6).tolist()
    [0.1, -0.2, 0.3]
    """
    x, y, z, w = np.moveaxis(np.asarray(q, float), -1, 0)
    middle = np.arcsin(np.clip(2 * (w * y - z * x), -1.0, 1.0))
    first = np.arctan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y))
    last = np.arctan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))
    return np.stack([first, middle, last], -1)
