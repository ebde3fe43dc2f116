"""Footskate cleanup: the target's foot stays in place while that of the source stands.

Each contact gets one foot position. Between contacts the correction is interpolated smoothly.
Hips and knees bend so that the foot reaches its position; where a leg is too short, the hips come
down.

Source: Kovar, Schreiner and Gleicher, "Footskate cleanup for motion capture editing", SCA 2002.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from characters.motion.clip import Clip
from characters.motion.contacts import find_contacts, spans
from characters.retargeting.ground_motion import GroundMotion
from characters.retargeting.leg_ik import place_ankle
from characters.retargeting.rig import LegJoints, Rig, global_rotations
from characters.retargeting.transfer import (
    ankle_positions,
    clip_in_common_axes,
    set_joint_positions,
)
from characters.skeleton import rotations
from characters.skeleton.pose import Array, Pose
from characters.smoothing import gaussian_smoothed

# Lengths in leg lengths.
_MAX_BALL_RISE = 0.02  # of the ball of a standing foot above its lowest position
_MAX_CORRECTION = 0.3  # a contact that needs a larger one is dropped
_MAX_HIPS_DROP = 0.2
_MAX_REACH = 0.997
_MAX_ROLL_S = 0.25  # from the heel onto the ball
_SETTLING_S = 0.12  # to leave or reach the speed of the correction during a contact
_HIPS_SMOOTHING_S = 0.06  # standard deviation of the hips' drop
_HEEL_LENGTH = 0.35  # distance from the ankle back to the heel, per distance ahead to the ball


@dataclass(frozen=True)
class FootContacts:
    """When the feet of a clip stand on the ground."""

    heel: NDArray[np.bool_]
    """Whether the foot stands on its heel alone, (frames, legs)."""

    ball: NDArray[np.bool_]
    """Whether it stands on the ball, or on the ankle of a foot without toes, (frames, legs)."""

    @property
    def any(self) -> NDArray[np.bool_]:
        """Whether the foot stands, (frames, legs)."""
        return self.heel | self.ball

    def at(self, frames: NDArray[np.intp]) -> "FootContacts":
        """Return the contacts at these frames."""
        return FootContacts(self.heel[frames], self.ball[frames])


def find_foot_contacts(clip: Clip, rig: Rig, legs: Sequence[LegJoints]) -> FootContacts:
    """Return when the feet of a clip stand, on the heel or on the ball."""
    clip = clip_in_common_axes(clip, rig)
    feet = [[leg.foot] if leg.toes is None else [leg.foot, leg.toes] for leg in legs]
    contacts = find_contacts(clip, rig.skeleton, feet)
    heights = clip.poses.globals(rig.skeleton)[:, [leg.end for leg in legs], 1, 3]
    heel, ball = np.zeros_like(contacts), np.zeros_like(contacts)
    count = len(clip) - 1 if clip.loop else len(clip)
    for leg in range(len(legs)):
        for first, length in spans(contacts[:, leg], clip.loop):
            frames = np.arange(first, first + length) % max(count, 1)
            lowest = heights[frames, leg].min()
            low = heights[frames, leg] < lowest + _MAX_BALL_RISE * rig.leg_length
            down, up = int(low.argmax()), length - int(low[::-1].argmax())
            # The contact ends when the ball rises, even if it rises slowly.
            strike = max(down - round(_MAX_ROLL_S * clip.rate), 0)
            heel[frames[strike:down], leg], ball[frames[down:up], leg] = True, True
    if clip.loop:
        heel[-1], ball[-1] = heel[0], ball[0]
    return FootContacts(heel, ball)


def hold_feet_in_contact(
    pose: Pose,
    rig: Rig,
    legs: Sequence[LegJoints],
    contacts: FootContacts,
    ground: GroundMotion,
    ends: Array | None = None,
) -> Pose:
    """Return poses (frames, joints, …) whose standing feet do not move over the ground.

    `ends` are positions of the legs' ends without contact, (frames, legs, 3) [m] in the common
    axes; left out, those of the poses.
    """
    placements = pose.globals(rig.skeleton)
    turns = rotations.multiply(rig.common_from_skeleton, global_rotations(placements))
    targets: list[Array] = []
    for number, leg in enumerate(legs):
        to_end, to_heel = _foot_vectors(rig, leg, turns)
        ankles = rotations.rotate(rig.common_from_skeleton, ankle_positions(placements, rig, leg))
        goal = ankles + to_end if ends is None else ends[:, number]
        foot = _FootPath(
            ground.to_ground(goal),
            ground.directions_to_ground(to_end - to_heel),
            ground.repeat(contacts.heel[:, number]),
            ground.repeat(contacts.ball[:, number]),
            float(rig.rest_positions[leg.end, 1]) if rig.rests_on_feet else None,
            _MAX_CORRECTION * rig.leg_length,
            ground.rate,
        )
        targets.append(ground.from_ground(foot.held()) - to_end)
    pose = _with_lower_hips(pose, rig, _hips_drop(rig, legs, placements, targets, ground))
    skeleton_from_common = rotations.conjugate(rig.common_from_skeleton)
    for leg, target in zip(legs, targets, strict=True):
        pose = place_ankle(pose, rig, leg, rotations.rotate(skeleton_from_common, target))
    return pose


def _foot_vectors(rig: Rig, leg: LegJoints, turns: Array) -> tuple[Array, Array]:
    """Return the vectors from the ankle to the ball and to the heel, (frames, 3) [m] each.

    The heel has no joint: it is assumed on the ground behind the ankle.
    """
    if leg.toes is None:
        zero = np.zeros((len(turns), 3))
        return zero, zero
    ball = rig.rest_positions[leg.toes] - rig.rest_positions[leg.foot]
    up, ahead = rotations.rotate(rig.flat_foot(leg), np.eye(3)[1:])
    height = rig.rest_positions[leg.foot, 1] if rig.rests_on_feet else -1.5 * float(ball @ up)
    heel = -height * up - _HEEL_LENGTH * float(ball @ ahead) * ahead
    from_rest = rotations.multiply(
        turns[:, leg.foot], rotations.conjugate(rig.rest_rotations[leg.foot])
    )
    return rotations.rotate(from_rest, ball), rotations.rotate(from_rest, heel)


@dataclass(frozen=True)
class _FootPath:
    """The path of one foot over the ground."""

    goal: Array  # position of its end without corrections, (frames, 3) [m]
    heel_to_end: Array  # from the heel to the end, (frames, 3) [m]
    heel: NDArray[np.bool_]  # whether it stands on its heel alone, (frames,)
    ball: NDArray[np.bool_]  # whether it stands on its end, (frames,)
    floor: float | None  # height of the end while it stands [m]; None to keep that of the goal
    max_correction: float  # a contact that needs a larger correction is dropped [m]
    rate: float  # [Hz]

    def held(self) -> Array:
        """Return the positions of its end, (frames, 3) [m], constant during contacts."""
        correction = np.zeros_like(self.goal)
        contacts: list[tuple[int, int]] = []
        for first, length in spans(self.heel | self.ball, loop=False):
            span = np.arange(first, first + length)
            wanted = self._contact_positions(span) - self.goal[span]
            if np.abs(wanted).max() < self.max_correction:
                correction[span] = wanted
                contacts.append((first, length))
        self._interpolate(correction, contacts)
        held: Array = self.goal + correction
        held[:, 1] = np.maximum(held[:, 1], self._lowest())
        return held

    def _lowest(self) -> Array:
        """Return the height of the end with ball or heel on the ground, (frames,) [m]."""
        if self.floor is None:
            return np.full(len(self.goal), -np.inf)
        return np.maximum(self.floor, self.heel_to_end[:, 1])

    def _contact_positions(self, span: NDArray[np.intp]) -> Array:
        """Return the positions of the end during a contact: on the heel first, then on the ball."""
        goal, heel_to_end = self.goal[span], self.heel_to_end[span]
        ball = self.ball[span]
        if not ball.any():  # the contact is cut off, or too short to roll onto the ball
            return np.asarray((goal - heel_to_end).mean(0) + heel_to_end)
        spot = goal[ball].mean(0)
        first = int(ball.argmax())
        at = np.tile(spot, (len(span), 1))
        # The foot turns about its heel until the ball is down.
        at[:first] = spot - heel_to_end[first] + heel_to_end[:first]
        if self.floor is not None:
            at[:, 1] = self._lowest()[span]
        return at

    def _interpolate(self, correction: Array, contacts: Sequence[tuple[int, int]]) -> None:
        """Fill in the correction between contacts, smoothly."""
        if not contacts:
            return
        ends = [(0, 0), *contacts, (len(correction), 0)]
        for (first, length), (after, _) in pairwise(ends):
            start, gap = first + length, after - first - length
            if gap <= 0:
                continue
            here = correction[start - 1] if length else correction[after]
            there = correction[after] if after < len(correction) else here
            zero = np.zeros(3)
            leaving = _slope(correction, start - 1, -1) if length > 1 else zero
            arriving = _slope(correction, after, 1) if after + 1 < len(correction) else zero
            u: Array = np.arange(1.0, gap + 1)[:, None]
            part = u / (gap + 1)
            ease = part * part * (3 - 2 * part)
            width = min(_SETTLING_S * self.rate, (gap + 1) / 2)
            correction[start:after] = here + (there - here) * ease
            correction[start:after] += leaving * _decay(u, width)
            correction[start:after] -= arriving * _decay(gap + 1 - u, width)


def _slope(correction: Array, frame: int, inward: int) -> Array:
    """Return the change per frame at an end of a contact, forward in time."""
    change: Array = (correction[frame + inward] - correction[frame]) * inward
    return change


def _decay(frames: Array, width: float) -> Array:
    """Return a curve that starts from 0 with slope 1 and is 0 from `width` on."""
    return np.asarray(frames * np.clip(1 - frames / width, 0.0, 1.0) ** 2)


def _hips_drop(
    rig: Rig,
    legs: Sequence[LegJoints],
    placements: Array,
    ankles: Sequence[Array],
    ground: GroundMotion,
) -> Array:
    """Return how far the hips come down so that the legs reach, smoothed, (frames,) [m]."""
    needed = np.zeros(len(placements))
    for leg, target in zip(legs, ankles, strict=True):
        hip = rotations.rotate(rig.common_from_skeleton, placements[:, leg.upper, :3, 3])
        aside = np.linalg.norm((hip - target)[:, [0, 2]], axis=-1)
        reach = _MAX_REACH * sum(rig.bone_lengths(leg))
        height = np.sqrt(np.maximum(reach**2 - aside**2, 0.0))
        needed = np.maximum(needed, hip[:, 1] - target[:, 1] - height)
    needed = np.clip(needed, 0.0, _MAX_HIPS_DROP * rig.leg_length)
    if not needed.any():
        return needed
    deviation = _HIPS_SMOOTHING_S * ground.rate
    margin = round(2 * deviation)
    padded = np.pad(ground.repeat(needed), margin, mode="edge")
    greatest = np.lib.stride_tricks.sliding_window_view(padded, 2 * margin + 1).max(-1)
    return ground.middle_cycle(gaussian_smoothed(greatest, deviation))


def _with_lower_hips(pose: Pose, rig: Rig, drop: Array) -> Pose:
    """Return poses with the hips lowered by (frames,) [m]."""
    if not drop.any():
        return pose
    hips = rig.anatomy.joints["hips"]
    at = pose.globals(rig.skeleton)[:, hips, :3, 3]
    down = rotations.rotate(rotations.conjugate(rig.common_from_skeleton), [0.0, -1.0, 0.0])
    lowered = replace(pose, translations=pose.translations.copy())
    set_joint_positions(lowered, rig, hips, at + drop[:, None] * down)
    return lowered
