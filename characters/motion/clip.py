"""Recorded motion at a uniform rate."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from cubeling.characters.errors import CharacterError
from cubeling.characters.motion.motion import RootDelta
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.pose import Array, Pose


@dataclass(frozen=True)
class Clip:
    """Poses at a uniform rate; a `Motion`."""

    name: str
    """Its name in the file."""

    rate: float
    """Frame rate [Hz]."""

    poses: Pose
    """(frames, joints, …); in a loop, the last frame equals the first, one cycle later."""

    loop: bool = True
    """Whether the frame after the last is the first."""

    root_motion: bool = False
    """Whether joint 0 is on the ground and carries the planar root motion; see `travel`."""

    def __post_init__(self) -> None:
        if self.poses.rotations.ndim != 3 or len(self) < 1 or not self.rate > 0:
            raise CharacterError(
                f"clip {self.name!r}: poses of shape {self.poses.rotations.shape} at {self.rate} "
                "Hz; give (frames, joints, 4) and a positive rate"
            )

    def __len__(self) -> int:
        return len(self.poses.rotations)

    @cached_property
    def duration(self) -> float:
        """Time from the first frame to the last [s]."""
        return (len(self) - 1) / self.rate

    def position(self, time: float) -> tuple[int, float]:
        """Return the frame at or before a time [s] and the fraction towards the next frame, 0…1.

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
        """Return the pose at a time [s]; with root motion, the root is at the origin."""
        frame, u = self.position(time)
        before, after = self._table[frame], self._table[min(frame + 1, self._last)]
        # The signs are continuous, so linear interpolation goes the shorter way.
        row = before + (after - before) * u
        turns = row[: 4 * self.poses.rotations.shape[1]].reshape(-1, 4)
        turns[:] = rotations.normalize(turns)
        return self._parts(row)

    def travel(self, start: float, end: float) -> RootDelta:
        """Return how the root moves over the ground between two times [s], across loops."""
        if not self.root_motion:
            return RootDelta()
        if self.loop and self._last > 0:
            # By the division that `position` has the rest of, or a whole cycle is lost at its end.
            loops = round(end * self.rate // self._last - start * self.rate // self._last)
            there = self._place(end)
            return self._place(start).to(self.cycle.repeat(loops).then(there) if loops else there)
        return self._place(start).to(self._place(end))

    @cached_property
    def in_place(self) -> Pose:
        """The poses without the planar root motion, with continuous quaternion signs."""
        return self._parts(self._table)

    def _parts(self, rows: Array) -> Pose:
        """Return rows of the table, (…, columns), as poses that share its memory."""
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
        """All values of each pose in one row, (frames, columns), for fast interpolation."""
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
        """Place of the root on the ground, (frames, 3): x, z [m] and unwrapped yaw [rad]."""
        root = self.poses.translations[:, 0]
        yaw = np.unwrap(rotations.heading(self.poses.rotations[:, 0]))
        return np.stack([root[:, 0], root[:, 2], yaw], axis=-1)

    @cached_property
    def cycle(self) -> RootDelta:
        """How the root moves over the ground from the first frame to the last."""
        return self._places[-1]

    @cached_property
    def _places(self) -> list[RootDelta]:
        """The track relative to its start."""
        first, *_ = places = [RootDelta(*row) for row in self.track.tolist()]
        return [first.to(place) for place in places]

    @cached_property
    def _last(self) -> int:
        return len(self) - 1

    def _place(self, time: float) -> RootDelta:
        """Return where the root is at a time [s], relative to the start of the current loop."""
        frame, u = self.position(time)
        return self._places[frame].interpolate(self._places[min(frame + 1, self._last)], u)
