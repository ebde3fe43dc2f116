"""Inertialization: transitions between motions without a jump.

Source: Bollo, "Inertialization: high-performance animation transitions in Gears of War", GDC 2018.
At the switch the new motion takes over at once. The difference to the old motion, in position and
velocity, is added to it and decays along a quintic. Bollo decays the length of each offset along a
fixed axis; here the whole vector decays, so its velocity is continuous in every direction.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.pose import Array, Pose

_MAX_JOINT_SPEED = 30.0  # [rad/s]; a faster turn is a jump in the clip itself


@dataclass(frozen=True)
class OffsetDecay:
    """An offset of any shape that decays to zero, with a given initial velocity."""

    offset: Array
    """Difference at time 0, which decays to zero."""

    velocity: Array
    """Its initial rate of change [1/s]."""

    length: float
    """Time until it is zero [s]."""

    def at(self, time: float) -> Array:
        """Return the offset at a time [s]; linear before 0.

        Position, velocity and acceleration end at zero.

        >>> decay = OffsetDecay(np.array([2.0]), np.array([0.0]), 0.5)
        >>> decay.at(0.0).tolist(), decay.at(0.25).tolist(), decay.at(0.5).tolist()
        ([2.0], [1.0], [0.0])
        """
        if time < 0.0:
            return self.offset + self.velocity * time
        u = min(time / self.length, 1.0)
        position, velocity = quintic_decay(u)
        offset: Array = self.offset * position + self.velocity * (velocity * self.length)
        return offset

    def integral(self, start: float, end: float) -> Array:
        """Return the integral of the offset over time from `start` to `end` [s].

        >>> OffsetDecay(np.array([2.0]), np.array([0.0]), 0.5).integral(0.0, 9.0).tolist()
        [0.5]
        """
        return self._antiderivative(end) - self._antiderivative(start)

    def _antiderivative(self, time: float) -> Array:
        if time < 0.0:
            return (self.offset + self.velocity * (time / 2)) * time
        u = min(time / self.length, 1.0)
        position = u - u**4 * (2.5 - 3 * u + u * u)
        velocity = u * u / 2 - u**4 * (1.5 - 1.6 * u + 0.5 * u * u)
        total: Array = self.length * (
            self.offset * position + self.velocity * (velocity * self.length)
        )
        return total


@dataclass(frozen=True)
class Inertialization:
    """The decaying difference of an old motion's poses from a new motion's."""

    rotations: OffsetDecay
    """Rotation vectors in the parent's frame, (joints, 3) [rad]."""

    translations: OffsetDecay
    """(joints, 3) [m]."""

    scales: OffsetDecay | None
    """(joints, 3); None without scales."""

    morphs: OffsetDecay | None = None
    """(morphs,); None without morphs."""

    @staticmethod
    def begin(
        old: tuple[Pose, Pose],
        new: tuple[Pose, Pose],
        step: float,
        length: float,
        parents: Sequence[int] = (),
    ) -> "Inertialization":
        """Return the transition of a length [s] between two motions.

        Parameters
        ----------
        old, new
            Two poses of each: at the switch, and `step` [s] later without it.
        step, length
            [s].
        parents
            Of the joints, if rotations are in the character's frame: each joint then turns the same
            way round as its parent, for the other way an arm would swing about.
        """
        turns, later = (_rotation_offset(a, b) for a, b in zip(old, new, strict=True))
        for joint in np.flatnonzero(_norm(turns)[:, 0] > np.pi / 2).tolist() if parents else ():
            if parents[joint] >= 0:
                turns[joint] = _nearer(turns[joint], turns[parents[joint]])
        spin = (_nearer(later, turns) - turns) / step
        # A cut inside a clip would otherwise be played on as a velocity, and whirl the joint about.
        spin *= np.minimum(1.0, _MAX_JOINT_SPEED / np.maximum(_norm(spin), 1e-9))
        shifts, moved = (a.translations - b.translations for a, b in zip(old, new, strict=True))
        return Inertialization(
            OffsetDecay(turns, spin, length),
            OffsetDecay(shifts, (moved - shifts) / step, length),
            _without_velocity(old[0].scales, new[0].scales, 1.0, length),
            _without_velocity(old[0].morphs, new[0].morphs, 0.0, length),
        )

    def apply(self, pose: Pose, time: float) -> Pose:
        """Return the shown pose for a pose of the new motion, `time` seconds after the switch."""
        if time >= self.rotations.length:
            return pose
        turned = rotations.from_rotation_vector(self.rotations.at(time))
        scales = pose.scales
        if self.scales is not None:
            scales = pose.scales_or_ones + self.scales.at(time)
        morphs = pose.morphs
        if self.morphs is not None:
            offset = self.morphs.at(time)
            own = np.zeros_like(offset) if morphs is None else morphs
            morphs = np.maximum(own + offset, np.minimum(own, 0.0))  # as the new motion fades
        return Pose(
            pose.translations + self.translations.at(time),
            # From the left: offsets are in the parent's frame, so the new motion may turn below
            # them.
            rotations.multiply(turned, pose.rotations),
            scales,
            morphs,
        )


def quintic_decay(u: float) -> tuple[float, float]:
    """Return the quintics that decay an initial position and an initial velocity, for u in 0…1.

    Their value and slope at 0 are (1, 0) and (0, 1); at 1 value, slope and curvature are zero.
    """
    return 1 - u**3 * (10 - 15 * u + 6 * u * u), u - u**3 * (6 - 8 * u + 3 * u * u)


def _rotation_offset(old: Pose, new: Pose) -> Array:
    return rotations.to_rotation_vector(
        rotations.multiply(old.rotations, rotations.conjugate(new.rotations))
    )


def _without_velocity(
    old: Array | None, new: Array | None, default: float, length: float
) -> OffsetDecay | None:
    """Return the decay of scales or morphs; without velocity, so that none becomes negative."""
    if old is None and new is None:
        return None
    before = np.float64(default) if old is None else old
    offset = np.asarray(before - (default if new is None else new))
    return OffsetDecay(offset, np.zeros_like(offset), length)


def _nearer(vectors: Array, reference: Array) -> Array:
    """Return rotation vectors, replaced by the longer way where that is nearer to `reference`.

    Near half a turn the shorter way may change between two frames though the motion is continuous.
    """
    other = vectors * (1 - 2 * np.pi / np.maximum(_norm(vectors), 1e-9))
    return np.where(_norm(vectors - reference) <= _norm(other - reference), vectors, other)


def _norm(vectors: Array) -> Array:
    length: Array = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return length
