"""Legs of other proportions: feet stand on their soles, and knees bend as in the source."""

import functools
from dataclasses import replace

import numpy as np
import pytest

from cubeling.characters import Character, Mesh, Pose
from cubeling.characters.retargeting import retarget
from cubeling.characters.retargeting.feet.footskate import (
    FootContacts,
    ball_positions,
    find_foot_contacts,
    hold_feet_in_contact,
)
from cubeling.characters.retargeting.feet.ground_motion import GroundMotion
from cubeling.characters.retargeting.feet.heel_rise import Heels
from cubeling.characters.retargeting.feet.hips_shift import HeldLegs, with_listing_hips
from cubeling.characters.retargeting.measures import knee_quantiles, sole_dip
from cubeling.characters.retargeting.rig import Rig
from cubeling.characters.retargeting.transfer import turns_from_rest
from cubeling.characters.skeleton import rotations
from tests.bundled_characters import bundled_character
from tests.examples import some

MAX_KNEES_BEYOND = np.radians(8.0)
MAX_DIP_M = 0.005


@pytest.fixture(scope="module")
def human():
    return Character.load("human")


def with_feet(human, length, *, toes=True):
    """The human on shoes of boxes as long as its own times a factor, with or without toes."""
    skeleton, sides = human.skeleton, ("Left", "Right")
    translations = skeleton.rest.translations.copy()
    for side in sides:
        translations[skeleton.index(f"{side}Toe"), 2] *= length
    skeleton = replace(skeleton, rest=replace(skeleton.rest, translations=translations))
    placements = skeleton.rest.globals(skeleton)
    at = placements[:, :3, 3]
    points, joints = [], []
    for side in sides:
        foot, toe = (skeleton.index(side + part) for part in ("Foot", "Toe"))
        heel, ball = at[foot, 2] - 0.05 * length, at[toe, 2]
        tip = ball + 0.07 * length
        ends = [(foot, heel, ball), (toe if toes else foot, ball, tip)]
        for joint, back, front in ends:
            box = [
                (at[foot, 0] + x, y, z)
                for x in (-0.04, 0.04)
                for y in (0, 0.05)
                for z in (back, front)
            ]
            points += box
            joints += [joint] * len(box)
    weights = np.zeros((len(points), 4), np.float32)
    weights[:, 0] = 1.0
    bones = np.zeros((len(points), 4), np.uint16)
    bones[:, 0] = joints
    mesh = Mesh(
        "shoes",
        np.array(points, np.float32),
        np.tile(np.array([0, 1, 0], np.float32), (len(points), 1)),
        np.zeros((0, 3), np.uint32),
        bones,
        weights,
        np.linalg.inv(placements),
    )
    semantics = {} if toes else {f"{side.lower()}Toes": "" for side in sides}
    return replace(human, skeleton=skeleton, meshes=(mesh,), clips={}, semantics=semantics)


def on(body, human, clip):
    return retarget(
        clip, human.skeleton, human.anatomy, body.skeleton, body.anatomy, meshes=body.meshes
    )


def knees_beyond(made, body, human, clip):
    """By how much knees bend more than in the source at most, of the quantiles [rad]."""
    source, rig = Rig(human.skeleton, human.anatomy), Rig(body.skeleton, body.anatomy)
    return max(
        (knee_quantiles(made.poses, rig, own) - knee_quantiles(clip.poses, source, other)).max()
        for own, other in zip(rig.legs, source.legs, strict=True)
    )


def hips_height(clip, character):
    """Mean height of the hip joints above the lower ankle [leg lengths]."""
    rig = Rig(character.skeleton, character.anatomy)
    heights = clip.poses.globals(rig.skeleton)[..., 1, 3]
    hips, ankles = [leg.upper for leg in rig.legs], [leg.foot for leg in rig.legs]
    return (heights[:, hips].mean(1) - heights[:, ankles].min(1)).mean() / rig.leg_length


BODIES = [(0.7, True), (1.7, False), (1.0, True), (1.7, True), (0.7, False), (1.0, False)]


@functools.cache
def shod(length, toes, name):
    """The human on such shoes and a clip of it on them; several tests measure it."""
    human = bundled_character("human")
    body = with_feet(human, length, toes=toes)
    return body, on(body, human, human.clips[name])


@pytest.mark.parametrize(("length", "toes"), some(BODIES, 2))
def test_feet_of_any_length_stay_above_the_ground(length, toes):
    body, made = shod(length, toes, "Walk")
    assert sole_dip(made.poses, Rig(body.skeleton, body.anatomy), body.meshes) < MAX_DIP_M


@pytest.mark.parametrize(("length", "toes"), some(BODIES, 2))
def test_knees_bend_as_in_the_source_whatever_the_feet(human, length, toes):
    body, made = shod(length, toes, "Walk")
    clip = human.clips["Walk"]
    assert knees_beyond(made, body, human, clip) < MAX_KNEES_BEYOND
    assert hips_height(made, body) == pytest.approx(hips_height(clip, human), rel=0.03)


def tilt_jerk(poses, character):
    """How fast the speed changes at which a foot tilts, at the most [rad per frame²]."""
    rig = Rig(character.skeleton, character.anatomy)
    turns = turns_from_rest(poses, rig, [leg.foot for leg in rig.legs])
    tilts = np.arcsin(rotations.rotate(turns, np.array([0.0, 0.0, 1.0]))[..., 1])
    return np.abs(np.diff(tilts, 2, axis=0)).max()


@pytest.mark.parametrize("clip", ["Walk", "Run"])
@pytest.mark.parametrize(("length", "toes"), some(BODIES, 2))
def test_feet_of_any_length_roll_as_steadily_as_in_the_source(human, length, toes, clip):
    body, made = shod(length, toes, clip)
    assert tilt_jerk(made.poses, body) < 1.2 * tilt_jerk(human.clips[clip].poses, human)


@pytest.mark.parametrize(("length", "toes"), some(BODIES, 2))
def test_balls_of_feet_of_any_length_do_not_slide(human, length, toes):
    body, made = shod(length, toes, "Walk")
    clip = human.clips["Walk"]
    source, rig = Rig(human.skeleton, human.anatomy), Rig(body.skeleton, body.anatomy, body.meshes)
    down = find_foot_contacts(clip, source, source.legs).ball
    for number, leg in enumerate(rig.legs):
        at = ball_positions(made.poses, rig, leg)[:, [0, 2]]
        speeds = np.linalg.norm(np.diff(at, axis=0), axis=-1) * made.rate
        assert down[:, number].mean() > 0.3
        assert speeds[down[1:, number] & down[:-1, number]].max() < 0.01


def at_rest(human, frames):
    rest = human.skeleton.rest
    return Pose(np.tile(rest.translations, (frames, 1, 1)), np.tile(rest.rotations, (frames, 1, 1)))


def standing_on(human, places, standing):
    """The human's legs at rest, its ankles held away from there by (frames, legs, 3) [m]."""
    rig = Rig(human.skeleton, human.anatomy)
    at = rig.rest_positions[[leg.foot for leg in rig.legs]] + np.asarray(places)
    ground = GroundMotion(np.zeros((len(at), 3)), None, 30.0)
    return HeldLegs(rig, rig.legs, at, np.asarray(standing), ground)


@pytest.mark.parametrize("length", some([1.7, 1.0]))
def test_skin_that_a_foot_shares_with_its_shin_stays_above_the_ground(human, length):
    body, clip = with_feet(human, length, toes=False), human.clips["Walk"]
    (shoes,) = body.meshes
    weights, bones = shoes.weights.copy(), shoes.joints.copy()
    for side, half in (("Left", slice(0, 16)), ("Right", slice(16, 32))):
        weights[half, :2] = 0.75, 0.25
        bones[half, 1] = human.skeleton.index(f"{side}Leg")
    body = replace(body, meshes=(replace(shoes, weights=weights, joints=bones),))
    made = on(body, human, clip)
    assert sole_dip(made.poses, Rig(body.skeleton, body.anatomy), body.meshes) < MAX_DIP_M


def test_hips_rise_with_feet_that_stand_higher(human):
    pose, away = at_rest(human, 30), np.zeros((30, 2, 3))
    standing = np.ones((30, 2), bool)
    standing[:, 1] = False
    extensions = standing_on(human, away, standing).extensions(pose)
    away[:] = [[0.0, 0.03, 0.0], [0.0, 0.1, 0.0]]  # the second one swings
    rise = standing_on(human, away, standing).rise_to_extension(pose, extensions)
    assert rise == pytest.approx(0.03, abs=1e-6)


def test_hips_are_rather_too_high_than_too_low_for_standing_legs(human):
    """A heel rises from too high hips, but a knee that bends too much stays bent."""
    pose, away = at_rest(human, 60), np.zeros((60, 2, 3))
    extensions = standing_on(human, away, np.ones((60, 2), bool)).extensions(pose)
    away[::2, :, 1] = 0.03  # faster than hips follow
    rise = standing_on(human, away, np.ones((60, 2), bool)).rise_to_extension(pose, extensions)
    assert rise[10:50].min() > 0.02


def heels_of(human, held, on_ball):
    """The heels of the human at rest, and how far they turn about balls out of reach."""
    frames = len(held.ankles)
    pose, rig = at_rest(human, frames), held.rig
    to_balls = np.tile([rig.sole(leg).ball for leg in rig.legs], (frames, 1, 1))
    heels = Heels(rig, rig.legs, pose, to_balls, on_ball)
    return heels, heels.tilts(held, pose)


def test_a_heel_rises_where_the_foot_is_out_of_reach_of_its_leg(human):
    away, standing = np.zeros((30, 2, 3)), np.ones((30, 2), bool)
    away[:, 0, 1] = -0.02
    held = standing_on(human, away, standing)
    heels, tilts = heels_of(human, held, standing)
    raised, pose = heels.raise_legs(held, tilts), at_rest(human, 30)
    assert held.extensions(pose)[:, 0].min() > held.reach[0]
    assert raised.extensions(pose)[:, 0] == pytest.approx(held.reach[0], abs=1e-3)
    turned = heels.turn_by(pose, tilts)
    foot = turns_from_rest(turned, held.rig, [held.legs[0].foot])[:, 0]
    balls = raised.ankles[:, 0] + rotations.rotate(foot, held.rig.sole(held.legs[0]).ball)
    assert balls == pytest.approx(held.ankles[:, 0] + heels.to_balls[:, 0], abs=1e-9)
    toes = [turns_from_rest(each, held.rig, [held.legs[0].toes]) for each in (pose, turned)]
    assert toes[1] == pytest.approx(toes[0], abs=1e-9)


def test_a_foot_within_reach_keeps_its_heel_down(human):
    away, standing = np.full((30, 2, 3), [0.0, 0.02, 0.0]), np.ones((30, 2), bool)
    _, tilts = heels_of(human, standing_on(human, away, standing), standing)
    assert not tilts.any()


def test_a_risen_heel_settles_steadily_in_the_air(human):
    away, standing = np.zeros((60, 2, 3)), np.ones((60, 2), bool)
    away[20:40, :, 1], standing[:20], standing[40:] = -0.02, False, False
    _, tilts = heels_of(human, standing_on(human, away, standing), standing)
    assert tilts[20:40].min() > np.radians(5.0)
    assert not tilts[[16, 43]].any()
    assert np.abs(np.diff(tilts, axis=0)).max() < 0.8 * tilts.max()


def test_a_swinging_foot_out_of_reach_does_not_lower_the_hips(human):
    pose, away = at_rest(human, 30), np.zeros((30, 2, 3))
    away[..., 1] = 0.02  # bent a little, as legs are in motion
    away[10:20, 0, 2] = 0.35
    standing = np.ones((30, 2), bool)
    standing[10:20, 0] = False
    held = standing_on(human, away, standing)
    assert not held.drop_to_reach(pose, 0.1).any()
    standing[:] = True
    assert held.drop_to_reach(pose, 0.1).max() > 0.05


def test_hips_list_where_two_feet_stand_at_other_heights(human):
    pose, level = at_rest(human, 30), np.zeros((30, 2, 3))
    both = np.ones((30, 2), bool)
    extensions = standing_on(human, level, both).extensions(pose)
    level[:, 0, 1], level[:, 1, 1] = 0.008, -0.008
    held = standing_on(human, level, both)
    angles = held.list_to_extension(pose, extensions)
    listing = with_listing_hips(pose, held.rig, held.legs, angles)
    assert held.extensions(pose)[15] != pytest.approx(extensions[15], abs=0.005)
    assert held.extensions(listing)[15] == pytest.approx(extensions[15], abs=0.001)
    head = human.anatomy.joints["head"]
    turns = [each.globals(human.skeleton)[15, head, :3, :3] for each in (pose, listing)]
    assert turns[1] == pytest.approx(turns[0], abs=1e-9)
    one = replace(held, standing=both & [True, False])
    assert not one.list_to_extension(pose, extensions).any()


def test_a_leg_that_swings_is_as_long_as_in_the_source(human):
    pose, away = at_rest(human, 30), np.zeros((30, 2, 3))
    away[..., 1] = 0.05  # bent, as legs are in motion
    standing = np.ones((30, 2), bool)
    standing[8:22, 0] = False
    extensions = standing_on(human, away, standing).extensions(pose)
    nearer = away + [0.0, 0.03, 0.0]
    held = standing_on(human, nearer, standing)
    ground = np.full((30, 2), -np.inf)
    longer = held.with_swing_lengths(pose, extensions, ground)
    assert longer.extensions(pose)[15, 0] == pytest.approx(extensions[15, 0], abs=1e-6)
    assert longer.ankles[standing] == pytest.approx(held.ankles[standing])
    ground[:] = held.ankles[..., 1] - 0.01
    assert held.with_swing_lengths(pose, extensions, ground).ankles[..., 1].min() >= ground.min()


def test_hips_rise_over_a_step_that_came_nearer(human):
    """Legs stretched beyond their length step nearer, and are straight there as in the source."""
    rig, frames = Rig(human.skeleton, human.anatomy), 60
    pose, reach = at_rest(human, frames), sum(rig.bone_lengths(rig.legs[0]))
    hips = human.anatomy.joints["hips"]
    pose.translations[:, hips, 2] += np.linspace(-0.7, 0.7, frames) * reach
    ball = np.zeros((frames, 2), bool)
    ball[5:55, 0] = True
    ends = np.stack([ball_positions(pose, rig, leg) for leg in rig.legs], axis=1)
    ends[:, 0] = ends[frames // 2, 0]
    contacts = FootContacts(np.zeros_like(ball), ball)
    ground = GroundMotion(np.zeros((frames, 3)), None, 30.0)
    held = hold_feet_in_contact(pose, rig, rig.legs, contacts, ground, ends)
    bends = knee_quantiles(held[slice(8, 52)], rig, rig.legs[0])
    assert bends.max() < np.radians(12.0)


@pytest.mark.parametrize("clip", some(["Walk", "Run"]))
@pytest.mark.parametrize("change", [-0.05, 0.05])
def test_knees_bend_as_in_the_source_whatever_thighs_and_shins(human, change, clip):
    skeleton = human.skeleton
    translations = skeleton.rest.translations.copy()
    for joint, sign in (("Leg", 1), ("Foot", -1)):
        for side in ("Left", "Right"):
            bone = translations[skeleton.index(side + joint)]
            bone *= 1 + sign * change / np.linalg.norm(bone)
    body = replace(
        human, skeleton=replace(skeleton, rest=replace(skeleton.rest, translations=translations))
    )
    made = on(body, human, human.clips[clip])
    assert knees_beyond(made, body, human, human.clips[clip]) < np.radians(5.0)


def test_a_step_out_of_reach_is_nearer_and_does_not_slide(human):
    """In narrow curves, the footprints of a long body are beside its straight trunk."""
    rig, frames = Rig(human.skeleton, human.anatomy), 40
    pose = at_rest(human, frames)
    hips = human.anatomy.joints["hips"]
    pose.translations[:, hips, 2] += np.linspace(-0.15, 0.15, frames)
    ends = np.stack([ball_positions(pose, rig, leg) for leg in rig.legs], axis=1)
    ends[:, 0] = ends[frames // 2, 0] + [0.45, 0.0, 0.0]
    ball = np.zeros((frames, 2), bool)
    ball[8:32, 0] = True
    contacts = FootContacts(np.zeros_like(ball), ball)
    ground = GroundMotion(np.zeros((frames, 3)), None, 30.0)
    held = hold_feet_in_contact(pose, rig, rig.legs, contacts, ground, ends)
    at = ball_positions(held, rig, rig.legs[0])[8:32]
    assert np.ptp(at, axis=0).max() < 1e-3


def test_a_foot_that_hovers_at_rest_stands_on_the_ground():
    vleo = Character.load("vleo")
    skeleton = vleo.skeleton
    turns = skeleton.rest.rotations.copy()
    leg = Rig(skeleton, vleo.anatomy).legs[2]
    for joint, angle in ((leg.upper, 0.2), (leg.lower, -0.4), (leg.foot, 0.2)):
        turns[joint] = rotations.multiply(turns[joint], rotations.about("x", angle))
    bent = replace(skeleton, rest=replace(skeleton.rest, rotations=turns))
    rig = Rig(bent, vleo.anatomy, vleo.meshes)
    left, right = rig.legs[2:]
    assert rig.rest_positions[left.foot, 1] > rig.rest_positions[right.foot, 1] + 0.001
    assert rig.standing_ankle_height(left) == pytest.approx(
        rig.standing_ankle_height(right), abs=0.0005
    )
