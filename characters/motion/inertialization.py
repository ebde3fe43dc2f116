"""From one motion to another without a pop, by letting their difference die away.

Source: Bollo, "Inertialization: high-performance animation transitions in Gears of War", GDC 2018.
At the switch the new motion takes over at once; what it differs by from the old one, in position
and in velocity, is added to it and fades along a quintic. Bollo fades the length of each offset
along a fixed axis; here the whole vector fades, so its velocity is kept in every direction.
"""

from dataclasses import dataclass

import numpy as np

from characters.skeleton import rotations
from characters.skeleton.pose import Array, Pose

_FASTEST = 30.0  # [rad/s]: no joint turns faster; what seems to is a jump in the clip itself


@dataclass(frozen=True)
class OffsetDecay:
    """An offset that dies away: a vector of any shape with its first velocity."""

    offset: Array
    """At the start."""

    velocity: Array
    """Its change at the start [1/s]."""

    length: float
    """When it is gone [s]."""

    def at(self, time: float) -> Array:
        """Return the offset at a time [s], before 0 in a straight line.

        Position, velocity and acceleration end at zero.

        >>> fade = OffsetDecay(np.array([2.0]), np.array([0.0]), 0.5)
        >>> fade.at(0.0).tolist(), fade.at(0.25).tolist(), fade.at(0.5).tolist()
        ([2.0], [1.0], [0.0])
        """
        if time < 0.0:
            return self.offset + self.velocity * time
        u = min(time / self.length, 1.0)
        # The quintics with value and slope (1, 0) and (0, 1) at 0 and all else zero at both ends.
        position = 1 - u**3 * (10 - 15 * u + 6 * u * u)
        velocity = u - u**3 * (6 - 8 * u + 3 * u * u)
        faded: Array = self.offset * position + self.velocity * (velocity * self.length)
        return faded

    def integral(self, start: float, end: float) -> Array:
        """Return the offset summed over time from `start` to `end` [s].

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
    """What a new motion's poses differ by from the old one's, dying away."""

    turns: OffsetDecay
    """Rotation vectors in the parent's frame, (joints, 3) [rad]."""

    shifts: OffsetDecay
    """Translations, (joints, 3) [m]."""

    growth: OffsetDecay | None
    """Scales, (joints, 3); None where nothing is scaled."""

    looks: OffsetDecay | None = None
    """Morphs, (morphs,); None where there are none."""

    @staticmethod
    def begin(
        old: tuple[Pose, Pose], new: tuple[Pose, Pose], step: float, length: float
    ) -> "Inertialization":
        """Return the transition between two motions.

        Parameters
        ----------
        old, new
            Two poses of each: at the switch, and `step` seconds later as if it had not been.
        step
            Time between the two [s].
        length
            How long the transition takes [s].
        """
        turns, later = (_turns(a, b) for a, b in zip(old, new, strict=True))
        spin = (_nearer(later, turns) - turns) / step
        spin *= np.minimum(1.0, _FASTEST / np.maximum(_norm(spin), 1e-9))
        shifts, moved = (a.translations - b.translations for a, b in zip(old, new, strict=True))
        return Inertialization(
            OffsetDecay(turns, spin, length),
            OffsetDecay(shifts, (moved - shifts) / step, length),
            _growth(old[0], new[0], length),
            _looks(old[0], new[0], length),
        )

    def apply(self, pose: Pose, time: float) -> Pose:
        """Return a pose of the new motion, `time` seconds after the switch, as it is shown."""
        if time >= self.turns.length:
            return pose
        turned = rotations.from_rotation_vector(self.turns.at(time))
        scales = pose.scales
        if self.growth is not None:
            scales = _scales(pose) + self.growth.at(time)
        morphs = pose.morphs
        if self.looks is not None:
            faded = self.looks.at(time)
            morphs = faded if morphs is None else morphs + faded
        return Pose(
            pose.translations + self.shifts.at(time),
            rotations.multiply(turned, pose.rotations),
            scales,
            morphs,
        )


def _turns(old: Pose, new: Pose) -> Array:
    """Return what turns each joint from the new pose to the old one, as rotation vectors."""
    return rotations.to_rotation_vector(
        rotations.multiply(old.rotations, rotations.conjugate(new.rotations))
    )


def _growth(old: Pose, new: Pose, length: float) -> OffsetDecay | None:
    """Return the fade of the scales; without velocity, so that nothing shrinks below nought."""
    if old.scales is None and new.scales is None:
        return None
    offset = _scales(old) - _scales(new)
    return OffsetDecay(offset, np.zeros_like(offset), length)


def _looks(old: Pose, new: Pose, length: float) -> OffsetDecay | None:
    """Return the fade of the morphs; without velocity, so that none goes below nought."""
    if old.morphs is None and new.morphs is None:
        return None
    before = np.zeros(1) if old.morphs is None else old.morphs
    after = np.zeros(1) if new.morphs is None else new.morphs
    offset: Array = before - after
    return OffsetDecay(offset, np.zeros_like(offset), length)


def _scales(pose: Pose) -> Array:
    return np.ones_like(pose.translations) if pose.scales is None else pose.scales


def _nearer(vectors: Array, reference: Array) -> Array:
    """Return the rotation vectors taken the other way round where that is nearer to `reference`.

    Next to half a turn the shorter way may change from one frame to the next; the motion does not.
    """
    other = vectors * (1 - 2 * np.pi / np.maximum(_norm(vectors), 1e-9))
    return np.where(_norm(vectors - reference) <= _norm(other - reference), vectors, other)


def _norm(vectors: Array) -> Array:
    length: Array = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return length
