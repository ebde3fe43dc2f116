"""How the hips move so that standing legs reach their places about as bent as in the source.

A foot that is held in place is a little away from where the motion has it. The hips follow standing
feet smoothly, as the root does in Kovar, Schreiner and Gleicher, "Footskate cleanup for motion
capture editing", SCA 2002, section 4: level with the feet, and up or down so far that their legs
are as long as in the source. They list to the side where both feet stand. Where a foot on its ball
is out of reach, its heel rises (see `heel_rise`); more brings the hips down a little, and what is
farther away, as in a narrow curve, steps nearer. Legs that swing are as long as in the source
again.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.retargeting.feet.foot_path import FootPath
from cubeling.characters.retargeting.feet.ground_motion import GroundMotion
from cubeling.characters.retargeting.rig import LegJoints, Rig
from cubeling.characters.retargeting.transfer import (
    in_common_axes,
    set_joint_positions,
    turns_from_rest,
    with_turns_from_rest,
)
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.pose import Array, Pose
from cubeling.characters.smoothing import gaussian_smooth, smoothstep

_SMOOTHING_S = 0.05  # standard deviation of the shift with the feet
_DROP_SMOOTHING_S = 0.04  # and of the drop
_RISE_SMOOTHING_S = 0.06  # and of the rise, in rounds
_RISE_ROUNDS = 3
_STRAIGHT_KNEE = 0.1  # added to the squared sine of half a knee's bend, so that none counts alone
_TOO_LOW_WEIGHT = 20.0  # of legs that are bent too much, against those that are too straight
_KEPT_RISE_WEIGHT = 0.3  # of staying where no foot stands
_BOUND_ROUNDS = 20  # until a smooth curve is hardly below its values
_SWING_S = 0.06  # before and after standing, in which legs come to be as long as in the source
_MAX_LIST = 0.105  # of the hips, to either side [rad]
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

    legs: Sequence[LegJoints]

    ankles: Array
    """Where the ankles are to be, (frames, legs, 3) [m] in the common axes."""

    standing: NDArray[np.bool_]
    """Whether a foot stands, (frames, legs)."""

    ground: GroundMotion
    """The ground under the clip."""

    def at(self, frames: NDArray[np.intp]) -> "HeldLegs":
        """Return the legs in some frames, which need not follow each other."""
        return replace(self, ankles=self.ankles[frames], standing=self.standing[frames])

    def extensions(self, pose: Pose) -> Array:
        """Return the distances of the ankles from the hip joints of poses, (frames, legs) [m]."""
        return np.asarray(np.linalg.norm(self._away(pose), axis=-1), np.float64)

    def rise_to_extension(self, pose: Pose, extensions: Array) -> Array:
        """Return how far the hips rise so that standing legs have these extensions, (frames,) [m].

        Those are in the source, (frames, legs) [m]. Straighter legs count more, as their knees bend
        more for the same way; and too low hips more than too high ones, from which a heel rises.
        """
        if not self.standing.any():
            return np.zeros(len(self.standing))
        rises = self._rises(pose, extensions)
        middle, most = np.median(rises[self.standing]), _MAX_RISE * self.rig.leg_length
        rises = np.clip(rises, middle - most, middle + most)
        bent = 1.0 - np.square(np.minimum(extensions / self.reach, 1.0))
        weights = np.where(self.standing, 1.0 / (bent + _STRAIGHT_KNEE), 0.0)
        wanted, weights = self.ground.repeat(rises), self.ground.repeat(weights)
        deviation = _RISE_SMOOTHING_S * self.ground.rate
        rise = np.full(len(wanted), middle)
        for _ in range(_RISE_ROUNDS):
            missing = wanted - rise[:, None]
            pull = weights * np.where(missing > 0.0, _TOO_LOW_WEIGHT, 1.0)
            change = gaussian_smooth((pull * missing).sum(1), deviation)
            rise += change / gaussian_smooth(pull.sum(1) + _KEPT_RISE_WEIGHT, deviation)
        return self.ground.middle_cycle(rise)

    def list_to_extension(self, pose: Pose, extensions: Array) -> Array:
        """Return how far the hips list to the right so that two legs have these extensions.

        (frames,) [rad]; 0 where only one leg stands, and for animals.
        """
        if self.rig.anatomy.kind == "quadruped" or len(self.legs) != 2:
            return np.zeros(len(self.standing))
        rises = self._rises(pose, extensions)
        left, right = self.rig.rest_positions[[leg.upper for leg in self.legs]]
        angle = (rises[:, 0] - rises[:, 1]) / max(float(np.linalg.norm(left - right)), 1e-9)
        angle = np.where(self.standing.all(1), np.clip(angle, -_MAX_LIST, _MAX_LIST), 0.0)
        smooth = gaussian_smooth(self.ground.repeat(angle), _SMOOTHING_S * self.ground.rate)
        return self.ground.middle_cycle(smooth)

    def _rises(self, pose: Pose, extensions: Array) -> Array:
        """Return how far each hip joint would rise to these extensions, (frames, legs) [m]."""
        away = self._away(pose)
        level = np.square(away[..., [0, 2]]).sum(-1)
        return np.asarray(np.sqrt(np.maximum(extensions**2 - level, 0.0)) - away[..., 1])

    def missing_reach(self, pose: Pose) -> Array:
        """Return the level ways from the ankles to where legs reach, (frames, legs, 3) [m]."""
        away = self._away(pose)
        level = away * [1.0, 0.0, 1.0]
        length = np.linalg.norm(level, axis=-1)
        possible = np.sqrt(np.maximum(self.reach**2 - away[..., 1] ** 2, 0.0))
        share = np.clip(1.0 - possible / np.maximum(length, 1e-9), 0.0, 1.0)
        return np.asarray(level * share[..., None])

    def drop_to_reach(self, pose: Pose, most: float) -> Array:
        """Return how far the hips come down so that standing legs reach, smoothed, (frames,) [m].

        Swinging feet need not reach. `most` is the farthest that they come down, in leg lengths.
        """
        away = self._away(pose)
        height = np.sqrt(np.maximum(self.reach**2 - np.square(away[..., [0, 2]]).sum(-1), 0.0))
        missing: Array = np.where(self.standing, away[..., 1] - height, 0.0).max(1)
        missing = np.clip(missing, 0.0, most * self.rig.leg_length)
        return upper_envelope(missing, self.ground)

    def with_swing_lengths(self, pose: Pose, extensions: Array, lowest: Array) -> "HeldLegs":
        """Return the legs with their swinging ankles as far from the hip joints as in the source.

        Where they are `lowest`, (frames, legs) [m], their feet are on the ground.
        """
        away = self._away(pose)
        longer = extensions / np.maximum(np.linalg.norm(away, axis=-1), 1e-9) - 1.0
        standing, rate = self.ground.repeat(self.standing), self.ground.rate
        longer *= self.ground.middle_cycle(_swing_share(standing, rate))
        ankles = self.ankles - longer[..., None] * away
        ankles[..., 1] = np.maximum(ankles[..., 1], np.minimum(self.ankles[..., 1], lowest))
        return replace(self, ankles=ankles)

    def hip_joints(self, pose: Pose) -> Array:
        """Return where the hip joints of the legs are in poses, (frames, legs, 3) [m]."""
        return _positions(pose, self.rig, [leg.upper for leg in self.legs])

    def _away(self, pose: Pose) -> Array:
        """Return the ways from the ankles to the hip joints of poses, (frames, legs, 3) [m]."""
        return self.hip_joints(pose) - self.ankles

    @property
    def reach(self) -> Array:
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
    return gaussian_smooth(mean, _SMOOTHING_S * rate)


def _swing_share(standing: NDArray[np.bool_], rate: float) -> Array:
    """Return how far feet are from standing, (frames, legs): 0 there, 1 some time away."""
    frames = np.arange(len(standing))
    near = [
        np.abs(frames[:, None] - np.flatnonzero(feet)).min(1, initial=len(frames))
        for feet in standing.T
    ]
    part = np.clip(np.stack(near, axis=1) / (_SWING_S * rate), 0.0, 1.0)
    return smoothstep(part)


def upper_envelope(values: Array, ground: GroundMotion) -> Array:
    """Return a smooth curve that is hardly below the values of a clip, (frames,)."""
    if not values.any():
        return values
    deviation = _DROP_SMOOTHING_S * ground.rate
    values = ground.repeat(values)
    bound = np.zeros_like(values)
    for _ in range(_BOUND_ROUNDS):
        bound += gaussian_smooth(np.maximum(values - bound, 0.0), deviation)
    return ground.middle_cycle(bound)


def with_moved_hips(pose: Pose, rig: Rig, shift: Array) -> Pose:
    """Return poses with the hips moved by (frames, 3) [m] in the common axes."""
    hips = rig.anatomy.joints["hips"]
    at = rig.placements(pose, [hips])[:, hips, :3, 3]
    moved = replace(pose, translations=pose.translations.copy())
    own = rotations.rotate(rotations.conjugate(rig.common_from_skeleton), shift)
    set_joint_positions(moved, rig, hips, at + own)
    return moved


def with_listing_hips(pose: Pose, rig: Rig, legs: Sequence[LegJoints], angles: Array) -> Pose:
    """Return poses whose hips list to the right by (frames,) [rad], about their middle.

    What the hips carry keeps its direction: the trunk stays upright.
    """
    hips, thighs = rig.anatomy.joints["hips"], [leg.upper for leg in legs]
    carriers = {j for thigh in thighs for j in rig.chain_to(thigh)[:-1] if hips in rig.chain_to(j)}
    if not carriers or not angles.any():
        return pose
    at = _positions(pose, rig, thighs)
    ahead = np.cross(at[:, 0] - at[:, 1], [0.0, 1.0, 0.0])
    ahead /= np.maximum(np.linalg.norm(ahead, axis=-1, keepdims=True), 1e-9)
    carried = {j for j, parent in enumerate(rig.skeleton.parents) if parent in carriers}
    joints = sorted(carriers | carried)
    turns, own = turns_from_rest(pose, rig, joints), np.isin(joints, list(carriers))
    turn = rotations.from_rotation_vector(ahead * angles[:, None])
    turns[:, own] = rotations.multiply(turn[:, None], turns[:, own])
    listing = with_turns_from_rest(pose, rig, joints, turns)
    return with_moved_hips(listing, rig, (at - _positions(listing, rig, thighs)).mean(1))


def _positions(pose: Pose, rig: Rig, joints: Sequence[int]) -> Array:
    """Return where joints are in poses, (frames, joints, 3) [m] in the common axes."""
    return in_common_axes(rig, rig.placements(pose, joints)[:, joints][..., :3, 3])
