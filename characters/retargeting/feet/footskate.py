"""Footskate cleanup: the target's foot stays in place while that of the source stands.

The foot turns onto its sole, and each contact gets one foot position; see `soles` and `foot_path`.
The hips follow the feet, and heels rise from the ground; see `hips_shift` and `heel_rise`. Hips and
knees bend for what is left.

Source: Kovar, Schreiner and Gleicher, "Footskate cleanup for motion capture editing", SCA 2002.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.motion.clip import Clip
from cubeling.characters.motion.contacts import find_contacts, spans
from cubeling.characters.retargeting.feet.foot_path import FootPath
from cubeling.characters.retargeting.feet.ground_motion import GroundMotion
from cubeling.characters.retargeting.feet.heel_rise import Heels
from cubeling.characters.retargeting.feet.hips_shift import (
    HeldLegs,
    following_feet,
    upper_envelope,
    with_listing_hips,
    with_moved_hips,
)
from cubeling.characters.retargeting.feet.leg_ik import place_ankle
from cubeling.characters.retargeting.rig import LegJoints, Rig
from cubeling.characters.retargeting.soles import stretch_to_fit, tilt_to_fit, tilts
from cubeling.characters.retargeting.transfer import (
    ankle_positions,
    clip_in_common_axes,
    in_common_axes,
    turns_from_rest,
    with_turns_from_rest,
)
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.pose import Array, Pose
from cubeling.characters.smoothing import gaussian_smooth

# Lengths in leg lengths.
_MAX_BALL_RISE = 0.02  # of the ball of a standing foot above its lowest position
_MAX_CORRECTION = 0.5  # a contact that needs a larger one is dropped
_MAX_DROPS = (0.01, 0.25)  # of the hips, before steps fall nearer and after
_STEPPING_ROUNDS = 2  # a step nearer may be out of reach at its other end
_MAX_TILT = 1.5  # of a foot on its ball, as a share, if it is short for its ankle's height
_TILT_SMOOTHING_S = 0.03  # standard deviation
_MAX_DEPTH = 0.005  # of soft skin of a foot below the ground
_RAISING_ROUNDS = 2  # of feet with such skin; a shin that they raise turns and moves it
_MAX_ROLL_S = 0.25  # from the heel onto the ball


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

    @property
    def mirrored(self) -> "FootContacts":
        """The contacts of the mirror image, whose left and right legs are exchanged."""
        sides = [leg + 1 - 2 * (leg % 2) for leg in range(self.ball.shape[1])]
        return FootContacts(self.heel[:, sides], self.ball[:, sides])

    def then_mirrored(self) -> "FootContacts":
        """Return the contacts of a loop of one step, followed by those of its mirror image."""
        frames = np.arange(len(self.ball) - 1)
        once, image = self.at(frames), self.mirrored.at(frames)
        both = zip((once.heel, once.ball), (image.heel, image.ball), strict=True)
        heel, ball = (np.concatenate([one, other, one[:1]]) for one, other in both)
        return FootContacts(heel, ball)


def find_foot_contacts(clip: Clip, rig: Rig, legs: Sequence[LegJoints]) -> FootContacts:
    """Return when the feet of a clip stand, on the heel or on the ball."""
    clip = clip_in_common_axes(clip, rig)
    feet = [[leg.foot] if leg.toes is None else [leg.foot, leg.toes] for leg in legs]
    contacts = find_contacts(clip, rig.skeleton, feet)
    ends = [leg.end for leg in legs]
    heights = rig.placements(clip.poses, ends)[:, ends, 1, 3]
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

    `ends` are positions of the balls of the feet without contact, (frames, legs, 3) [m] in the
    common axes; left out, those of the poses.
    """
    ankles = _ankle_goals(pose, rig, legs, ends)
    if rig.floor is not None:
        heights = ankles[..., 1] - rig.floor
        pose = _on_soles(pose, rig, legs, heights, contacts, ground)
    clearances = np.zeros(ankles.shape[:2])
    held = _hold(pose, rig, legs, ankles, contacts, ground, clearances)
    for _ in range(_RAISING_ROUNDS):
        depths = rig.sole_depths(held, legs)
        if (depths <= _MAX_DEPTH * rig.leg_length).all():
            break
        clearances += np.stack([upper_envelope(each, ground) for each in depths.T], axis=1)
        held = _hold(pose, rig, legs, ankles, contacts, ground, clearances)
    return held if rig.floor is None else _with_toes_above(held, rig, legs, rig.floor)


def _hold(
    pose: Pose,
    rig: Rig,
    legs: Sequence[LegJoints],
    ankles: Array,
    contacts: FootContacts,
    ground: GroundMotion,
    clearances: Array,
) -> Pose:
    """Return poses whose feet are held, their soles above the ground by (frames, legs) [m]."""
    to_balls, paths = _foot_paths(pose, rig, legs, ankles, contacts, ground, clearances)
    standing = np.stack([ground.middle_cycle(path.standing) for path in paths], axis=1)
    own = _ankle_goals(pose, rig, legs, None) if rig.anatomy.kind == "humanoid" else ankles
    held = HeldLegs(rig, legs, own, standing, ground)
    heels = Heels(rig, legs, pose, to_balls, contacts.ball & standing)
    extensions = held.extensions(pose)
    shift = following_feet(paths)
    level = with_moved_hips(pose, rig, ground.middle_cycle(shift))
    held = replace(held, ankles=_held_places(paths, shift, ground) - to_balls)
    for most in _MAX_DROPS:
        rise = held.rise_to_extension(level, extensions)
        shift[:, 1] = ground.repeat(rise)
        pose = with_moved_hips(level, rig, rise[:, None] * [0.0, 1.0, 0.0])
        pose = with_listing_hips(pose, rig, legs, held.list_to_extension(pose, extensions))
        held = replace(held, ankles=_held_places(paths, shift, ground) - to_balls)
        drop = heels.raise_legs(held, heels.tilts(held, pose)).drop_to_reach(pose, most)
        pose = with_moved_hips(pose, rig, drop[:, None] * [0.0, -1.0, 0.0])
        for _ in range(_STEPPING_ROUNDS):
            raised = heels.raise_legs(held, heels.tilts(held, pose))
            missing = np.moveaxis(raised.missing_reach(pose), 1, 0)
            paths = [
                path.with_steps_moved(ground.directions_to_ground(way))
                for path, way in zip(paths, missing, strict=True)
            ]
            held = replace(held, ankles=_held_places(paths, shift, ground) - to_balls)
    if rig.anatomy.kind == "humanoid":
        lowest = np.stack([ground.middle_cycle(path.lowest) for path in paths], axis=1)
        held = held.with_swing_lengths(pose, extensions, lowest - to_balls[..., 1])
    heel_tilts = heels.tilts(held, pose)
    pose, held = heels.turn_by(pose, heel_tilts), heels.raise_legs(held, heel_tilts)
    ankles = rotations.rotate(rotations.conjugate(rig.common_from_skeleton), held.ankles)
    for number, leg in enumerate(legs):
        pose = place_ankle(pose, rig, leg, ankles[:, number])
    return pose


def _ankle_goals(pose: Pose, rig: Rig, legs: Sequence[LegJoints], ends: Array | None) -> Array:
    """Return the positions of the ankles without contact, (frames, legs, 3) [m]."""
    placements = rig.placements(pose, [leg.lower for leg in legs])
    ankles = np.stack([ankle_positions(placements, rig, leg) for leg in legs], axis=1)
    ankles = in_common_axes(rig, ankles)
    if ends is None:
        return ankles
    balls = np.stack([ball_positions(pose, rig, leg) for leg in legs], axis=1)
    return np.asarray(ankles + ends - balls)


def _foot_paths(
    pose: Pose,
    rig: Rig,
    legs: Sequence[LegJoints],
    ankles: Array,
    contacts: FootContacts,
    ground: GroundMotion,
    clearances: Array,
) -> tuple[Array, list[FootPath]]:
    """Return the vectors from the ankles to the balls, (frames, legs, 3) [m], and the paths."""
    feet = turns_from_rest(pose, rig, [leg.foot for leg in legs])
    toes = turns_from_rest(pose, rig, [leg.end for leg in legs])
    to_balls = np.empty_like(ankles)
    paths: list[FootPath] = []
    for number, leg in enumerate(legs):
        sole, turn = rig.sole(leg), feet[:, number]
        to_ball, to_heel = (rotations.rotate(turn, each) for each in (sole.ball, sole.heel))
        lowest = np.full(len(turn), -np.inf)
        if rig.floor is not None:
            lowest = rig.floor + sole.clearance(turn, toes[:, number]) + to_ball[:, 1]
            lowest += clearances[:, number]
        path = FootPath(
            ground.to_ground(ankles[:, number] + to_ball),
            ground.directions_to_ground(to_ball - to_heel),
            ground.repeat(contacts.heel[:, number]),
            ground.repeat(contacts.ball[:, number]),
            ground.repeat(lowest),
            _MAX_CORRECTION * rig.leg_length,
            ground.rate,
        )
        paths.append(path)
        to_balls[:, number] = to_ball
    return to_balls, paths


def _held_places(paths: Sequence[FootPath], shift: Array, ground: GroundMotion) -> Array:
    """Return where the balls are held, (frames, legs, 3) [m]; the hips are shifted by (frames, 3).

    The shift is over the ground.
    """
    return np.stack([ground.from_ground(path.hold(shift)) for path in paths], axis=1)


def ball_positions(pose: Pose, rig: Rig, leg: LegJoints) -> Array:
    """Return where the ball of a foot is in poses, (frames, 3) [m] in the common axes."""
    placements = rig.placements(pose, [leg.lower])
    ankles = in_common_axes(rig, ankle_positions(placements, rig, leg))
    turns = turns_from_rest(pose, rig, [leg.foot])[:, 0]
    return ankles + rotations.rotate(turns, rig.sole(leg).ball)


def _on_soles(
    pose: Pose,
    rig: Rig,
    legs: Sequence[LegJoints],
    heights: Array,
    contacts: FootContacts,
    ground: GroundMotion,
) -> Pose:
    """Return poses with feet and toes turned so that they reach the ground, but not below it.

    `heights` are those of the ankles above the ground, (frames, legs) [m].
    """
    smoothing = _TILT_SMOOTHING_S * ground.rate
    on_ball = gaussian_smooth(ground.repeat(contacts.ball.astype(float)), smoothing)
    on_ball = ground.middle_cycle(on_ball)
    for number, leg in enumerate(legs):
        sole = rig.sole(leg)
        joints = [leg.foot] if leg.toes is None else [leg.foot, leg.toes]
        turns = turns_from_rest(pose, rig, joints)
        useful = np.clip(sole.highest_tilt / np.maximum(tilts(turns[:, 0]), 1e-3), 1.0, _MAX_TILT)
        greatest = 1.0 + (useful - 1.0) * on_ball[:, number]
        fitting = tilt_to_fit(turns[:, 0], heights[:, number], sole.clearance, greatest)
        turns[:, 0] = _turn_smoothly(turns[:, 0], fitting, ground)
        if leg.toes is not None:
            balls = heights[:, number] + rotations.rotate(turns[:, 0], sole.ball)[:, 1]
            turns[:, 1] = stretch_to_fit(
                turns[:, 1], turns[:, 0], balls, sole.toes_clearance, on_ball[:, number]
            )
        pose = with_turns_from_rest(pose, rig, joints, turns)
    return pose


def _turn_smoothly(turns: Array, wanted: Array, ground: GroundMotion) -> Array:
    """Return turns (frames, 4) that go to the wanted ones by a change that is smooth in time."""
    change = rotations.multiply(wanted, rotations.conjugate(turns))
    # The next cycle of a curve looks another way: its axes of rotation do too.
    vectors = ground.directions_to_ground(rotations.to_rotation_vector(change))
    vectors = gaussian_smooth(vectors, _TILT_SMOOTHING_S * ground.rate)
    smooth = rotations.from_rotation_vector(ground.directions_from_ground(vectors))
    return rotations.multiply(smooth, turns)


def _with_toes_above(pose: Pose, rig: Rig, legs: Sequence[LegJoints], floor: float) -> Pose:
    """Return poses with toes tilted no more than there is room for."""
    for leg in legs:
        if leg.toes is None:
            continue
        toes = rig.placements(pose, [leg.toes])[:, leg.toes, :3, 3]
        heights = in_common_axes(rig, toes)[:, 1] - floor
        turns = turns_from_rest(pose, rig, [leg.toes])
        turns[:, 0] = tilt_to_fit(turns[:, 0], heights, rig.sole(leg).toes_clearance)
        pose = with_turns_from_rest(pose, rig, [leg.toes], turns)
    return pose
