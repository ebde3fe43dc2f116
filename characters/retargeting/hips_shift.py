"""How the hips move so that standing legs reach their places about as bent as in the source.

A foot that is held in place is a little away from where the motion has it. The hips follow standing
feet smoothly, as the root does in Kovar, Schreiner and Gleicher, "Footskate cleanup for motion
capture editing", SCA 2002, section 4: level with the feet, and up or down so far that their legs
are as long as in the source. A little that is out of reach brings them down; what is farther away,
in a narrow curve or where a source's own feet leave its legs, steps nearer.
"""

from collections.abc import Sequence
from dataclasses import replace

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


def rise_to_extension(
    pose: Pose,
    rig: Rig,
    legs: Sequence[LegJoints],
    ankles: Array,
    extensions: Array,
    standing: NDArray[np.bool_],
    ground: GroundMotion,
) -> Array:
    """Return how far the hips rise so that standing legs are as long as in the source, (frames,).

    Parameters
    ----------
    pose
        The poses, (frames, joints, …).
    rig, legs
        The skeleton and its legs.
    ankles
        Where the ankles are to be, (frames, legs, 3) [m] in the common axes.
    extensions
        Distances of ankles from hip joints in the source, (frames, legs) [m].
    standing
        Whether a foot stands, (frames, legs).
    ground
        The ground under the clip.
    """
    away, _ = _from_hips(pose, rig, legs, ankles)
    level = np.square(away[..., [0, 2]]).sum(-1)
    rise = np.sqrt(np.maximum(extensions**2 - level, 0.0)) - away[..., 1]
    if not standing.any():
        return np.zeros(len(rise))
    middle, most = np.median(rise[standing]), _MAX_RISE * rig.leg_length
    rise = np.clip(rise, middle - most, middle + most)
    over_cycles = ground.repeat(rise[..., None]), ground.repeat(standing)
    return np.asarray(ground.middle_cycle(_smooth_mean(*over_cycles, ground.rate))[:, 0])


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


def missing_reach(pose: Pose, rig: Rig, legs: Sequence[LegJoints], ankles: Array) -> Array:
    """Return the level ways from ankles (frames, legs, 3) to where legs reach, the same shape."""
    away, reach = _from_hips(pose, rig, legs, ankles)
    level = away * [1.0, 0.0, 1.0]
    length = np.linalg.norm(level, axis=-1)
    possible = np.sqrt(np.maximum(reach**2 - away[..., 1] ** 2, 0.0))
    share = np.clip(1.0 - possible / np.maximum(length, 1e-9), 0.0, 1.0)
    return np.asarray(level * share[..., None])


def drop_to_reach(
    pose: Pose,
    rig: Rig,
    legs: Sequence[LegJoints],
    ankles: Array,
    standing: NDArray[np.bool_],
    ground: GroundMotion,
    most: float,
) -> Array:
    """Return how far the hips come down so that legs reach, smoothed, (frames,) [m].

    Parameters
    ----------
    pose
        The poses, (frames, joints, …).
    rig, legs
        The skeleton and its legs.
    ankles
        Where the ankles are to be, (frames, legs, 3) [m] in the common axes.
    standing
        Whether a foot stands, (frames, legs): swinging feet need not reach.
    ground
        The ground under the clip.
    most
        The farthest that they come down, in leg lengths.
    """
    away, reach = _from_hips(pose, rig, legs, ankles)
    height = np.sqrt(np.maximum(reach**2 - np.square(away[..., [0, 2]]).sum(-1), 0.0))
    missing: Array = np.where(standing, away[..., 1] - height, 0.0).max(1)
    missing = np.clip(missing, 0.0, most * rig.leg_length)
    return smooth_bound(missing, ground)


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


def leg_extensions(pose: Pose, rig: Rig, legs: Sequence[LegJoints], ankles: Array) -> Array:
    """Return the distances of ankles (frames, legs, 3) from the hip joints, (frames, legs) [m]."""
    away, _ = _from_hips(pose, rig, legs, ankles)
    return np.asarray(np.linalg.norm(away, axis=-1), np.float64)


def _from_hips(
    pose: Pose, rig: Rig, legs: Sequence[LegJoints], ankles: Array
) -> tuple[Array, Array]:
    """Return the ways from ankles to hip joints, (frames, legs, 3), and how far legs reach [m]."""
    thighs = [leg.upper for leg in legs]
    hips = rig.placements(pose, thighs)[:, thighs][..., :3, 3]
    reach = _MAX_REACH * np.array([sum(rig.bone_lengths(leg)) for leg in legs])
    return in_common_axes(rig, hips) - ankles, reach
