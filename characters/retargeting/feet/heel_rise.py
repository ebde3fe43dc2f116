"""Heels that rise where a leg would not reach a foot that stands on its ball.

The ball stays where it is and the ankle comes nearer to the hip, as at the end of a person's step.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.retargeting.feet.ground_motion import GroundMotion
from cubeling.characters.retargeting.feet.hips_shift import HeldLegs
from cubeling.characters.retargeting.rig import LegJoints, Rig
from cubeling.characters.retargeting.transfer import turns_from_rest, with_turns_from_rest
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.pose import Array, Pose
from cubeling.characters.smoothing import smoothstep

_MAX_TILT = 0.35  # of a foot beyond its motion's [rad]
_HALVINGS = 10  # of the range of tilts
_SETTLING_S = 0.1  # of a heel that rose, in the air


@dataclass(frozen=True)
class Heels:
    """Feet of a clip that may turn about their balls."""

    rig: Rig

    legs: Sequence[LegJoints]

    pose: Pose
    """The clip, its feet turned as in the motion."""

    to_balls: Array
    """From the ankles to the balls, (frames, legs, 3) [m] in the common axes."""

    on_ball: NDArray[np.bool_]
    """Whether a foot stands on its ball, (frames, legs)."""

    def tilts(self, held: HeldLegs, pose: Pose) -> Array:
        """Return how far feet turn so that legs reach them from the hips of a pose [rad].

        (frames, legs); fading in the air before and after a foot stands.
        """
        tilts = np.zeros(self.on_ball.shape)
        out = (held.extensions(pose) > held.reach) & self.on_ball
        frames = np.flatnonzero(out.any(1))
        if not len(frames):
            return tilts
        least = self._at(frames)._least(held.at(frames), pose[frames])
        tilts[frames] = np.where(out[frames], least, 0.0)
        return _fade_in_air(tilts, self.on_ball, held.ground)

    def _least(self, held: HeldLegs, pose: Pose) -> Array:
        """Return the least tilts by which legs reach their feet, (frames, legs) [rad]."""
        hips = held.hip_joints(pose)
        least, most = np.zeros(self.on_ball.shape), np.full(self.on_ball.shape, _MAX_TILT)
        for _ in range(_HALVINGS):
            middle = (least + most) / 2
            away = np.linalg.norm(hips - self.raise_legs(held, middle).ankles, axis=-1)
            least = np.where(away > held.reach, middle, least)
            most = np.where(away > held.reach, most, middle)
        return most

    def _at(self, frames: NDArray[np.intp]) -> "Heels":
        """Return the feet in some frames."""
        to_balls, on_ball = self.to_balls[frames], self.on_ball[frames]
        return replace(self, pose=self.pose[frames], to_balls=to_balls, on_ball=on_ball)

    def raise_legs(self, held: HeldLegs, tilts: Array) -> HeldLegs:
        """Return the legs with ankles over the balls of feet that turn by (frames, legs) [rad].

        In the air they are only as high as such feet need.
        """
        if not tilts.any():
            return held
        turns = self._turns(tilts)
        over_balls = held.ankles + self.to_balls - rotations.rotate(turns, self.to_balls)
        ankles = np.where(self.on_ball[..., None], over_balls, held.ankles)
        for number, leg in enumerate(self.legs):
            foot, toes = self._feet[number]
            clearance = self.rig.sole(leg).clearance
            turned = clearance(rotations.multiply(turns[:, number], foot), toes)
            lowest = held.ankles[:, number, 1] + turned - clearance(foot, toes)
            if self.rig.floor is not None:
                lowest = np.where(self.on_ball[:, number], lowest, self.rig.floor + turned)
            ankles[:, number, 1] = np.maximum(ankles[:, number, 1], lowest)
        return replace(held, ankles=ankles)

    def turn_by(self, pose: Pose, tilts: Array) -> Pose:
        """Return poses with feet that turn by (frames, legs) [rad]; toes keep their direction."""
        if not tilts.any():
            return pose
        turns = self._turns(tilts)
        for number, leg in enumerate(self.legs):
            joints = [leg.foot] if leg.toes is None else [leg.foot, leg.toes]
            own = turns_from_rest(pose, self.rig, joints)
            own[:, 0] = rotations.multiply(turns[:, number], own[:, 0])
            pose = with_turns_from_rest(pose, self.rig, joints, own)
        return pose

    @cached_property
    def _feet(self) -> list[tuple[Array, Array]]:
        """Turns of feet and toes from rest, (frames, 4) each, in the motion."""
        joints = [joint for leg in self.legs for joint in (leg.foot, leg.end)]
        turns = turns_from_rest(self.pose, self.rig, joints)
        return [(turns[:, k], turns[:, k + 1]) for k in range(0, len(joints), 2)]

    def _turns(self, tilts: Array) -> Array:
        """Return rotations (frames, legs, 4) of feet about their width that raise their heels."""
        across = np.cross([0.0, 1.0, 0.0], self.to_balls)
        across /= np.maximum(np.linalg.norm(across, axis=-1, keepdims=True), 1e-9)
        return rotations.from_rotation_vector(across * tilts[..., None])


def _fade_in_air(tilts: Array, on_ball: NDArray[np.bool_], ground: GroundMotion) -> Array:
    """Return tilts that fade in the air before and after feet stand, (frames, legs) [rad]."""
    over, standing = ground.repeat(tilts), ground.repeat(on_ball)
    frames = max(round(_SETTLING_S * ground.rate), 1)
    fading = over.copy()
    for away in range(1, min(frames, len(over))):
        share = smoothstep(1.0 - away / frames)
        fading[away:] = np.maximum(fading[away:], share * over[:-away])
        fading[:-away] = np.maximum(fading[:-away], share * over[away:])
    return ground.middle_cycle(np.where(standing, over, fading))
