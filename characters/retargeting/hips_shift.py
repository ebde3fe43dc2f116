"""How the hips move so that standing legs reach their places about as bent as in the source.

A foot that is held in place is a little away from where the motion has it. The hips follow standing
feet smoothly, as the root does in Kovar, Schreiner and Gleicher, "Footskate cleanup for motion
capture editing", SCA 2002, section 4: level with the feet, and up or down so far that their legs
are as long as in the source. A little that is out of reach brings them down; what is farther away,
in a narrow curve or where a source's own feet leave its legs, steps nearer.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from characters.retargeting.foot_path import FootPath
from characters.retargeting.ground_motion import GroundMotion
from characters.retargeting.rig import LegJoints, Rig
from characters.retargeting.transfer import in_common_axes, set_joint_positions
from characters.skeleton import rotations
from characters.skeleton.pose import Array, Pose
from characters.smoothing import gaussian_smoothed

_SMOOTHING_S = 0.05  # standard deviation of the shift with the feet
_DROP_SMOOTHING_S = 0.04  # and of the drop
# In leg lengths.
_MAX_RISE = 0.06  # to bend legs as in the source, about the median of all frames
_MAX_REACH = 0.999


def following_feet(paths: Sequence[FootPath]) -> Array:
    """Return how the hips follow held feet, level and over the ground, (frames, 3) [m]."""
    standing = np.stack([path.standing for path in paths], axis=1)
    corrections = np.stack([path.corrections for path in paths], axis=1)
    return _smooth_mean(corrections * [1.0, 0.0, 1.0], standing, paths[0].rate)


@dataclass(frozen=True)
class HeldLegs:
    """Legs of a clip, and where their ankles are held."""

    rig: Rig
    """The skeleton."""

    legs: Sequence[LegJoints]
    """Its legs."""

    ankles: Array
    """Where the ankles are to be, (frames, legs, 3) [m] in the common axes."""

    standing: NDArray[np.bool_]
    """Whether a foot stands, (frames, legs)."""

    ground: GroundMotion
    """The ground under the clip."""

    def extensions(self, pose: Pose) -> Array:
        """Return the distances of the ankles from the hip joints of poses, (frames, legs) [m]."""
        return np.asarray(np.linalg.norm(self._away(pose), axis=-1), np.float64)

    def rise_to_extension(self, pose: Pose, extensions: Array) -> Array:
        """Return how far the hips rise so that standing legs have these extensions, (frames,) [m].

        Those are in the source, (frames, legs) [m].
        """
        away = self._away(pose)
        level = np.square(away[..., [0, 2]]).sum(-1)
        rise = np.sqrt(np.maximum(extensions**2 - level, 0.0)) - away[..., 1]
        if not self.standing.any():
            return np.zeros(len(rise))
        middle, most = np.median(rise[self.standing]), _MAX_RISE * self.rig.leg_length
        rise = np.clip(rise, middle - most, middle + most)
        ground = self.ground
        over_cycles = ground.repeat(rise[..., None]), ground.repeat(self.standing)
        return np.asarray(ground.middle_cycle(_smooth_mean(*over_cycles, ground.rate))[:, 0])

    def missing_reach(self, pose: Pose) -> Array:
        """Return the level ways from the ankles to where legs reach, (frames, legs, 3) [m]."""
        away = self._away(pose)
        level = away * [1.0, 0.0, 1.0]
        length = np.linalg.norm(level, axis=-1)
        possible = np.sqrt(np.maximum(self._reach**2 - away[..., 1] ** 2, 0.0))
        share = np.clip(1.0 - possible / np.maximum(length, 1e-9), 0.0, 1.0)
        return np.asarray(level * share[..., None])

    def drop_to_reach(self, pose: Pose, most: float) -> Array:
        """Return how far the hips come down so that standing legs reach, smoothed, (frames,) [m].

        Swinging feet need not reach. `most` is the farthest that they come down, in leg lengths.
        """
        away = self._away(pose)
        height = np.sqrt(np.maximum(self._reach**2 - np.square(away[..., [0, 2]]).sum(-1), 0.0))
        missing: Array = np.where(self.standing, away[..., 1] - height, 0.0).max(1)
        missing = np.clip(missing, 0.0, most * self.rig.leg_length)
        return smooth_bound(missing, self.ground)

    def _away(self, pose: Pose) -> Array:
        """Return the ways from the ankles to the hip joints of poses, (frames, legs, 3) [m]."""
        thighs = [leg.upper for leg in self.legs]
        hips = self.rig.placements(pose, thighs)[:, thighs][..., :3, 3]
        return in_common_axes(self.rig, hips) - self.ankles

    @property
    def _reach(self) -> Array:
        """How far legs reach, (legs,) [m]."""
        return _MAX_REACH * np.array([sum(self.rig.bone_lengths(leg)) for leg in self.legs])


def _smooth_mean(values: Array, standing: NDArray[np.bool_], rate: float) -> Array:
    """Return the mean of standing legs of values (frames, legs, n), smoothed, (frames, n)."""
    known = np.asarray(standing.any(1))
    if not known.any():
        return np.zeros((len(known), values.shape[-1]))
    total = np.where(standing[..., None], values, 0.0).sum(1)
    mean = total / np.maximum(standing.sum(1), 1)[:, None]
    frames = np.arange(len(known))
    mean = np.stack([np.interp(frames, frames[known], each[known]) for each in mean.T], axis=-1)
    return gaussian_smoothed(mean, _SMOOTHING_S * rate)


def smooth_bound(values: Array, ground: GroundMotion) -> Array:
    """Return a smooth curve that is hardly below the values of a clip, (frames,)."""
    if not values.any():
        return values
    deviation = _DROP_SMOOTHING_S * ground.rate
    margin = round(2 * deviation)
    padded = np.pad(ground.repeat(values), margin, mode="edge")
    greatest = np.lib.stride_tricks.sliding_window_view(padded, 2 * margin + 1).max(-1)
    return ground.middle_cycle(gaussian_smoothed(greatest, deviation))


def with_moved_hips(pose: Pose, rig: Rig, shift: Array) -> Pose:
    """Return poses with the hips moved by (frames, 3) [m] in the common axes."""
    hips = rig.anatomy.joints["hips"]
    at = rig.placements(pose, [hips])[:, hips, :3, 3]
    moved = replace(pose, translations=pose.translations.copy())
    own = rotations.rotate(rotations.conjugate(rig.common_from_skeleton), shift)
    set_joint_positions(moved, rig, hips, at + own)
    return moved
