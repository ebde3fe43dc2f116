"""How the hips move so that standing legs reach their places about as bent as in the source.

A foot that is held in place is a little away from where the motion has it. The hips follow standing
feet smoothly, as the root does in Kovar, Schreiner and Gleicher, "Footskate cleanup for motion
capture editing", SCA 2002, section 4. What is still out of reach brings them down.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from characters.retargeting.ground_motion import GroundMotion
from characters.retargeting.rig import LegJoints, Rig
from characters.retargeting.transfer import in_common_axes, set_joint_positions
from characters.skeleton import rotations
from characters.skeleton.pose import Array, Pose
from characters.smoothing import gaussian_smoothed

_SMOOTHING_S = 0.08  # standard deviation of the shift with the feet
_DROP_SMOOTHING_S = 0.04  # and of the drop
# In leg lengths.
_MAX_DROP = 0.2
_MAX_REACH = 0.998


def hips_shift(
    pose: Pose,
    rig: Rig,
    legs: Sequence[LegJoints],
    corrections: Array,
    ankles: Array,
    standing: NDArray[np.bool_],
    ground: GroundMotion,
) -> Array:
    """Return how the hips move, (frames, 3) [m] in the common axes.

    Parameters
    ----------
    pose
        The poses, (frames, joints, …).
    rig, legs
        The skeleton and its legs.
    corrections, ankles
        How the ankles are moved to their places, and these places, (frames, legs, 3) [m].
    standing
        Whether a foot stands, (frames, legs).
    ground
        The ground under the clip.
    """
    shift = _following(corrections, standing, ground)
    hips = pose.globals(rig.skeleton)[:, [leg.upper for leg in legs]][..., :3, 3]
    hips = in_common_axes(rig, hips) + shift[:, None]
    shift[:, 1] -= _drop(rig, legs, hips, ankles, standing, ground)
    return shift


def with_moved_hips(pose: Pose, rig: Rig, shift: Array) -> Pose:
    """Return poses with the hips moved by (frames, 3) [m] in the common axes."""
    hips = rig.anatomy.joints["hips"]
    at = pose.globals(rig.skeleton)[:, hips, :3, 3]
    moved = replace(pose, translations=pose.translations.copy())
    own = rotations.rotate(rotations.conjugate(rig.common_from_skeleton), shift)
    set_joint_positions(moved, rig, hips, at + own)
    return moved


def _following(corrections: Array, standing: NDArray[np.bool_], ground: GroundMotion) -> Array:
    """Return the smoothed mean correction of standing feet, (frames, 3) [m]."""
    weights = standing.astype(float)
    total = np.maximum(weights.sum(1, keepdims=True), 1.0)
    mean = np.einsum("fl,fli->fi", weights, corrections) / total
    known = ground.repeat(np.asarray(standing.any(1)))
    mean = ground.directions_to_ground(mean)
    if not known.any():
        return np.zeros((len(corrections), 3))
    frames = np.arange(len(mean))
    mean = np.stack([np.interp(frames, frames[known], each[known]) for each in mean.T], axis=-1)
    return ground.middle_cycle(gaussian_smoothed(mean, _SMOOTHING_S * ground.rate))


def _drop(
    rig: Rig,
    legs: Sequence[LegJoints],
    hips: Array,
    ankles: Array,
    standing: NDArray[np.bool_],
    ground: GroundMotion,
) -> Array:
    """Return how far hip joints (frames, legs, 3) come down so that legs reach, (frames,) [m]."""
    reach = _MAX_REACH * np.array([sum(rig.bone_lengths(leg)) for leg in legs])
    away = hips - ankles
    height = np.sqrt(np.maximum(reach**2 - np.square(away[..., [0, 2]]).sum(-1), 0.0))
    missing: Array = np.where(standing, away[..., 1] - height, 0.0).max(1)
    missing = np.clip(missing, 0.0, _MAX_DROP * rig.leg_length)
    if not missing.any():
        return missing
    deviation = _DROP_SMOOTHING_S * ground.rate
    margin = round(2 * deviation)
    padded = np.pad(ground.repeat(missing), margin, mode="edge")
    greatest = np.lib.stride_tricks.sliding_window_view(padded, 2 * margin + 1).max(-1)
    return ground.middle_cycle(gaussian_smoothed(greatest, deviation))
