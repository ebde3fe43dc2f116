"""The motion of the ground under a clip, and the repetition of a loop over the ground.

A clip that walks in place stands on a treadmill. In the frame of the moving ground its standing
feet do not move; there they are held, and then transformed back.

A planar pose is (…, 3): x, z [m] and yaw [rad].
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.motion.clip import Clip
from cubeling.characters.motion.motion import RootDelta
from cubeling.characters.retargeting.rig import LegJoints, Rig
from cubeling.characters.retargeting.transfer import clip_in_common_axes
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.pose import Array

# A treadmill is assumed if standing feet are faster than this, and the body stays in place.
_MIN_TREADMILL_SPEED = 0.1  # leg lengths a second
_MAX_TREADMILL_TRAVEL = 1.0  # leg lengths

_T = TypeVar("_T", bound=np.generic)


@dataclass(frozen=True)
class GroundMotion:
    """How the frame of a clip moves over the ground, and where its next cycle begins."""

    frame_poses: Array
    """Planar pose of the clip's frame over the ground at each frame, (frames, 3)."""

    cycle: Array | None
    """Planar pose of the next cycle relative to this one, (3,); None if the clip is no loop."""

    rate: float
    """Frame rate [Hz]."""

    def to_ground(self, positions: Array) -> Array:
        """Return positions (frames, 3) over the ground, for three cycles of a loop."""
        over_ground = transform(self.frame_poses, positions)
        if self.cycle is None:
            return over_ground
        once = over_ground[:-1]
        before = transform(_inverse(self.cycle), once)
        return np.concatenate([before, once, transform(self.cycle, once)])

    def directions_to_ground(self, directions: Array) -> Array:
        """Return directions (frames, 3) over the ground, for three cycles of a loop."""
        return self._turning.to_ground(directions)

    def directions_from_ground(self, directions: Array) -> Array:
        """Return the clip's own directions (frames, 3) from those over the ground."""
        return self._turning.from_ground(directions)

    @property
    def _turning(self) -> "GroundMotion":
        """The same motion without its way."""
        yaw_only = np.array([0.0, 0.0, 1.0])
        cycle = None if self.cycle is None else self.cycle * yaw_only
        return GroundMotion(self.frame_poses * yaw_only, cycle, self.rate)

    def repeat(self, values: NDArray[_T]) -> NDArray[_T]:
        """Return values (frames, …) that do not depend on position for three cycles of a loop."""
        return values if self.cycle is None else np.concatenate([values[:-1]] * 3)

    def middle_cycle(self, values: NDArray[_T]) -> NDArray[_T]:
        """Return the clip's own part, (frames, …), of repeated values."""
        if self.cycle is None:
            return values
        count = len(self.frame_poses) - 1
        return values[count : 2 * count + 1]

    def from_ground(self, positions: Array) -> Array:
        """Return the clip's own positions (frames, 3) from those over the ground."""
        return transform(_inverse(self.frame_poses), self.middle_cycle(positions))


def find_ground_motion(
    clip: Clip, rig: Rig, legs: Sequence[LegJoints], contacts: NDArray[np.bool_], ratio: float
) -> GroundMotion:
    """Return the ground motion of a clip, its lengths multiplied by a ratio.

    `contacts` say when the end of each leg stands, (frames, legs): standing feet show the ground's
    motion.
    """
    clip = clip_in_common_axes(clip, rig)
    times = np.arange(len(clip)) / clip.rate
    velocity = -_treadmill_velocity(clip, rig, legs, contacts)
    frame_poses = arc(ratio * velocity, 0.0, times)
    if not clip.loop or len(clip) < 2:
        return GroundMotion(frame_poses, None, clip.rate)
    cycle = RootDelta(*frame_poses[-1])
    if clip.root_motion:
        first, last = (RootDelta(*clip.track[frame] * [ratio, ratio, 1.0]) for frame in (0, -1))
        # A treadmill moves under the position of the root.
        cycle = cycle.then(last.then(first.inverse()))
    return GroundMotion(frame_poses, np.array([cycle.x, cycle.z, cycle.yaw]), clip.rate)


def _treadmill_velocity(
    clip: Clip, rig: Rig, legs: Sequence[LegJoints], contacts: NDArray[np.bool_]
) -> Array:
    """Return the velocity (2,) [m/s] of ground that moves under a clip, or zero."""
    joints = [leg.end for leg in legs]
    ends = rig.placements(clip.poses, joints)[:, joints][..., [0, 2], 3]
    standing = contacts[1:] & contacts[:-1]
    if not standing.any():
        return np.zeros(2)
    joint = rig.anatomy.joints["hips"]
    hips = rig.placements(clip.poses, [joint])[:, joint, [0, 2], 3]
    if np.ptp(hips, axis=0).max() > _MAX_TREADMILL_TRAVEL * rig.leg_length:
        return np.zeros(2)
    velocity = np.median(np.diff(ends, axis=0)[standing] * clip.rate, axis=0)
    moves = np.hypot(*velocity) > _MIN_TREADMILL_SPEED * rig.leg_length
    return np.asarray(velocity if moves else np.zeros(2), float)


def arc(velocity: Array, yaw_rate: float, times: Array) -> Array:
    """Return planar poses (n, 3) at constant velocity (2,) [m/s] and yaw rate [rad/s].

    >>> arc(np.array([0.0, 1.0]), np.pi, np.array([1.0])).round(6).tolist()
    [[0.63662, 0.0, 3.141593]]
    """
    yaw = yaw_rate * times
    ahead = times * np.sinc(yaw / np.pi)
    aside = times * np.sinc(yaw / 2 / np.pi) * np.sin(yaw / 2)
    x, z = velocity
    return np.stack([ahead * x + aside * z, ahead * z - aside * x, yaw], axis=-1)


def transform(planar_poses: Array, points: Array) -> Array:
    """Return points (frames, 3) transformed by planar poses (frames, 3) or (3,)."""
    transformed = rotations.rotate(rotations.about("y", planar_poses[..., 2]), points)
    transformed[..., [0, 2]] += planar_poses[..., :2]
    return transformed


def _inverse(planar_poses: Array) -> Array:
    """Return the inverse transforms, (…, 3)."""
    sine, cosine = np.sin(planar_poses[..., 2]), np.cos(planar_poses[..., 2])
    x, z = planar_poses[..., 0], planar_poses[..., 1]
    back = [-cosine * x + sine * z, -sine * x - cosine * z, -planar_poses[..., 2]]
    return np.stack(back, axis=-1)
