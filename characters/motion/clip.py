"""Recorded motion at a uniform rate."""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from characters.errors import CharacterError
from characters.motion.motion import RootDelta
from characters.skeleton import rotations
from characters.skeleton.pose import Array, Pose


@dataclass(frozen=True)
class Clip:
    """Poses at a uniform rate; a `Motion`."""

    name: str
    """Name in the file."""

    rate: float
    """Frames a second [Hz]."""

    poses: Pose
    """(frames, joints, …); of a loop, the last frame is the first one, a cycle later."""

    loop: bool = True
    """Whether it repeats."""

    root_motion: bool = False
    """Whether joint 0 is a root on the ground that carries the planar motion: see `travel`."""

    def __post_init__(self) -> None:
        """Refuse what cannot be played."""
        if self.poses.rotations.ndim != 3 or len(self) < 1 or not self.rate > 0:
            raise CharacterError(
                f"clip {self.name!r}: poses of shape {self.poses.rotations.shape} at {self.rate} "
                "Hz; give (frames, joints, 4) and a positive rate"
            )

    def __len__(self) -> int:
        """Return the number of frames."""
        return len(self.poses.rotations)

    @cached_property
    def duration(self) -> float:
        """Time from the first frame to the last [s]."""
        return (len(self) - 1) / self.rate

    def position(self, time: float) -> tuple[int, float]:
        """Return the frame at or before a time [s] and the part of the way to the next, 0…1.

        >>> clip = Clip("c", 10.0, Pose(np.zeros((5, 1, 3)), np.zeros((5, 1, 4))))
        >>> clip.position(0.65)[0], round(clip.position(0.65)[1], 6)
        (2, 0.5)
        """
        last = self._last
        if last == 0:
            return 0, 0.0
        at = time * self.rate
        at = at % last if self.loop else min(max(at, 0.0), float(last))
        frame = min(int(at), last - 1)
        return frame, at - frame

    def sample(self, time: float) -> Pose:
        """Return the pose at a time [s]; the root stands at the origin if it has root motion."""
        frame, u = self.position(time)
        after = min(frame + 1, self._last)
        before = self._table[frame]
        # The signs were made continuous, so a straight mix goes the shorter way.
        pose = self._parts(before + (self._table[after] - before) * u)
        return Pose(
            pose.translations, rotations.normalize(pose.rotations), pose.scales, pose.morphs
        )

    def travel(self, start: float, end: float) -> RootDelta:
        """Return how the root moves over the ground between two times [s], over any loops."""
        if not self.root_motion:
            return RootDelta()
        if self.loop and self._last > 0:
            # Whole rounds before both are left out.
            rounds = math.floor(start / self.duration)
            later = math.floor(end / self.duration) - rounds
            there = self._within(end)
            return self._within(start).to(
                self.cycle.repeated(later).then(there) if later else there
            )
        return self._within(start).to(self._within(end))

    @cached_property
    def in_place(self) -> Pose:
        """The poses with the root's planar motion taken out and continuous quaternion signs."""
        return self._parts(self._table)

    def _parts(self, rows: Array) -> Pose:
        """Return rows of the table, (…, columns), as poses that lie in the same memory."""
        joints = self.poses.rotations.shape[1]
        lead = rows.shape[:-1]
        turned, shifted = 4 * joints, 7 * joints
        sized = shifted if self.poses.scales is None else 10 * joints
        return Pose(
            rows[..., turned:shifted].reshape(*lead, joints, 3),
            rows[..., :turned].reshape(*lead, joints, 4),
            rows[..., shifted:sized].reshape(*lead, joints, 3) if sized > shifted else None,
            None if self.poses.morphs is None else rows[..., sized:],
        )

    @cached_property
    def _table(self) -> Array:
        """The numbers of each pose in one row, (frames, columns), so that all are mixed at once."""
        translations = self.poses.translations.copy()
        turns = rotations.continuous(self.poses.rotations)
        if self.root_motion:
            x, z, yaw = self.track[:, 0], self.track[:, 1], self.track[:, 2]
            ground = np.stack([x, np.zeros_like(x), z], axis=-1)
            back = rotations.about("y", -yaw)
            translations[:, 0] = rotations.rotate(back, translations[:, 0] - ground)
            turns[:, 0] = rotations.multiply(back, turns[:, 0])
            turns = rotations.continuous(turns)
        parts = [turns, translations]
        parts += [part for part in (self.poses.scales, self.poses.morphs) if part is not None]
        return np.concatenate([part.reshape(len(self), -1) for part in parts], axis=1)

    @cached_property
    def track(self) -> Array:
        """Where the root stands on the ground, (frames, 3): x, z [m] and unwrapped yaw [rad]."""
        root = self.poses.translations[:, 0]
        yaw = np.unwrap(rotations.heading(self.poses.rotations[:, 0]))
        return np.stack([root[:, 0], root[:, 2], yaw], axis=-1)

    @cached_property
    def cycle(self) -> RootDelta:
        """How the root moves over the ground from the first frame to the last."""
        return self._steps[-1]

    @cached_property
    def _steps(self) -> list[RootDelta]:
        """The track from where it starts, as plain numbers, which beat arrays of three."""
        first, *_ = steps = [RootDelta(*row) for row in self.track.tolist()]
        return [first.to(step) for step in steps]

    @cached_property
    def _last(self) -> int:
        """Number of the last frame."""
        return len(self) - 1

    def _within(self, time: float) -> RootDelta:
        """Return where the root is at a time, in the round that it is in."""
        frame, u = self.position(time)
        a, b = self._steps[frame], self._steps[min(frame + 1, self._last)]
        return RootDelta(a.x + (b.x - a.x) * u, a.z + (b.z - a.z) * u, a.yaw + (b.yaw - a.yaw) * u)
