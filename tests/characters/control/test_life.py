import math

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from cubeling.characters import Animator, Character, CharacterCommand, Pose, Skeleton
from cubeling.characters.body.eye_range import (
    MAX_EYE_PITCH_RAD,
    MAX_EYE_YAW_RAD,
    STRAINED_SHARE,
    within_range,
)
from cubeling.characters.body.gaze import MAX_HEAD_DOWN_RAD, MAX_HEAD_UP_RAD, MAX_HEAD_YAW_RAD, Gaze
from cubeling.characters.face.blink import BlinkTimer, lid_closure
from cubeling.characters.face.lids import Lids
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.anatomy import Anatomy
from tests.characters.layers import AppliedLayers
from tests.examples import examples, some

STEP_S = 1 / 60
NAMES = ("hips", "spine", "chest", "neck", "head", "LeftEye", "RightEye", "LeftFoot")
PARENTS = (-1, 0, 1, 2, 3, 4, 4, 0)
PLACES = np.array(
    [[0, 1, 0], [0, 0.1, 0], [0, 0.2, 0], [0, 0.2, 0], [0, 0.1, 0]]
    + [[0.03, 0.1, 0.08], [-0.03, 0.1, 0.08], [0.1, -0.9, 0]]
)


SEMANTICS = {name: name for name in ("hips", "spine", "chest", "neck", "head")}
SEMANTICS |= {"leftEye": "LeftEye", "rightEye": "RightEye"}


def bust(seed):
    """Return a body whose joints' own frames point anywhere; it faces +z all the same."""
    rng = np.random.default_rng(seed)
    world = rotations.normalize(rng.normal(size=(len(NAMES), 4)))
    if seed == 0:
        world = np.tile(rotations.IDENTITY, (len(NAMES), 1))
    parents = np.array([world[p] if p >= 0 else rotations.IDENTITY for p in PARENTS])
    back = rotations.conjugate(parents)
    rest = Pose(rotations.rotate(back, PLACES), rotations.multiply(back, world))
    skeleton = Skeleton(NAMES, PARENTS, rest)
    return skeleton, Anatomy.guess(skeleton, SEMANTICS)


def looking(skeleton, pose, joint):
    """Return which way a joint looks in a pose: what was +z at rest."""
    rest = skeleton.rest.globals(skeleton)[joint, :3, :3]
    return pose.globals(skeleton)[joint, :3, :3] @ rest.T @ [0.0, 0.0, 1.0]


def angle(a, b):
    cosine = np.dot(a, b) / np.linalg.norm(a) / np.linalg.norm(b)
    return math.acos(min(max(float(cosine), -1.0), 1.0))


@settings(max_examples=examples(30), deadline=None)
@given(st.integers(0, 9), st.floats(-1.3, 1.3), st.floats(-0.5, 0.5), st.floats(0.6, 5.0))
def test_eyes_end_on_what_they_look_at(seed, yaw, pitch, distance):
    skeleton, anatomy = bust(seed)
    gaze = Gaze(skeleton, anatomy)
    middle = np.array([0.0, 1.7, 0.08])
    way = np.array([math.sin(yaw) * math.cos(pitch), math.sin(pitch), math.cos(yaw)])
    target = middle + distance * way / np.linalg.norm(way)
    for _ in range(240):
        pose = gaze.update(skeleton.rest, target, STEP_S)
    world = pose.globals(skeleton)
    for joint in (5, 6):
        to = target - world[joint, :3, 3]
        assert angle(looking(skeleton, pose, joint), to) < math.radians(1.0)
    assert angle(looking(skeleton, pose, 4), target - middle) < math.radians(22)


@settings(max_examples=examples(20), deadline=None)
@given(st.integers(0, 9), st.lists(st.floats(-5, 5), min_size=3, max_size=3))
def test_nothing_turns_farther_than_a_body_can(seed, target):
    skeleton, anatomy = bust(seed)
    gaze = Gaze(skeleton, anatomy)
    for _ in range(90):
        pose = gaze.update(skeleton.rest, np.array(target), STEP_S)
        head = looking(skeleton, pose, 4)
        assert abs(math.atan2(head[0], head[2])) < MAX_HEAD_YAW_RAD + math.radians(1)
        assert -MAX_HEAD_DOWN_RAD - 0.02 < math.asin(head[1]) < MAX_HEAD_UP_RAD + 0.02
        for eye in (5, 6):
            assert angle(looking(skeleton, pose, eye), head) < MAX_EYE_YAW_RAD + 1e-6


def test_the_head_turns_without_a_jump_and_the_eyes_are_there_first():
    skeleton, anatomy = bust(0)
    gaze = Gaze(skeleton, anatomy)
    target = np.array([2.0, 1.7, 2.0])
    heads, eyes = [], []
    for _ in range(90):
        pose = gaze.update(skeleton.rest, target, STEP_S)
        heads.append(angle(looking(skeleton, pose, 4), [0, 0, 1]))
        eyes.append(angle(looking(skeleton, pose, 5), [0, 0, 1]))
    assert np.abs(np.diff(heads)).max() < math.radians(400) * STEP_S
    assert eyes[6] > math.radians(25) > 3 * heads[3]


@pytest.mark.parametrize(("yaw", "pitch"), [(30, 0), (60, 10), (-60, -30), (25, -45), (0, 25)])
def test_the_eyes_turn_back_to_their_middle_as_the_head_follows(yaw, pitch):
    skeleton, anatomy = bust(3)
    gaze = Gaze(skeleton, anatomy)
    yaw, pitch = math.radians(yaw), math.radians(pitch)
    way = [math.sin(yaw) * math.cos(pitch), math.sin(pitch), math.cos(yaw) * math.cos(pitch)]
    target = np.array([0.0, 1.7, 0.08]) + 1.5 * np.array(way)
    turns = []
    for _ in range(60):
        pose = gaze.update(skeleton.rest, target, STEP_S)
        turns.append(angle(looking(skeleton, pose, 5), looking(skeleton, pose, 4)))
    assert max(turns) > min(math.radians(12), 0.6 * math.hypot(yaw, pitch))
    assert turns[-1] < math.radians(11)


@pytest.mark.parametrize("head_share", [1.0, 0.2])
def test_the_eyes_do_not_stay_in_their_corners_for_a_point_out_of_reach(head_share):
    skeleton, anatomy = bust(1)
    gaze = Gaze(skeleton, anatomy)
    target = np.array([2.0, 1.2, -0.5])
    for _ in range(120):
        pose = gaze.update(skeleton.rest, target, STEP_S, head_share)
    eye = angle(looking(skeleton, pose, 5), looking(skeleton, pose, 4))
    assert math.radians(2) < eye < STRAINED_SHARE * MAX_EYE_YAW_RAD + 1e-6


def test_eyes_that_the_pose_has_turned_look_at_the_point_all_the_same():
    skeleton, anatomy = bust(2)
    target = np.array([0.3, 1.8, 1.0])
    turned = skeleton.rest.rotations.copy()
    turn = rotations.from_rotation_vector(np.array([0.1, 0.3, 0.0]))
    turned[5] = rotations.multiply(turned[5], turn)
    pose = Pose(skeleton.rest.translations, turned)
    gaze = Gaze(skeleton, anatomy)
    for _ in range(120):
        looked = gaze.update(pose, target, STEP_S)
    to = target - looked.globals(skeleton)[5, :3, 3]
    assert angle(looking(skeleton, looked, 5), to) < math.radians(2)


@given(st.floats(-3, 3), st.floats(-1.5, 1.5), st.floats(0.1, 1.0))
def test_eyes_approach_the_end_of_their_range_smoothly(yaw, pitch, share):
    def eccentricity(turn):
        return math.hypot(turn[0] / MAX_EYE_YAW_RAD, turn[1] / MAX_EYE_PITCH_RAD)

    turn = within_range(yaw, pitch, share)
    assert eccentricity(turn) <= min(share, eccentricity((yaw, pitch))) + 1e-12
    assert turn[0] * pitch == pytest.approx(turn[1] * yaw)
    further = within_range(1.001 * yaw, 1.001 * pitch, share)
    step = eccentricity(further) - eccentricity(turn)
    assert -1e-12 <= step <= 0.00101 * eccentricity((yaw, pitch))


def test_what_is_behind_is_not_looked_at_and_the_head_comes_back():
    skeleton, anatomy = bust(0)
    gaze = Gaze(skeleton, anatomy)
    for _ in range(60):
        gaze.update(skeleton.rest, np.array([1.0, 1.7, 1.0]), STEP_S)
    for _ in range(240):
        pose = gaze.update(skeleton.rest, np.array([0.1, 1.7, -2.0]), STEP_S)
    assert angle(looking(skeleton, pose, 4), [0, 0, 1]) < math.radians(1)


def test_a_body_without_a_head_is_left_alone():
    rest = Pose(np.zeros((1, 3)), np.array([[0.0, 0, 0, 1]]))
    skeleton = Skeleton(("box",), (-1,), rest)
    box = Character("box", skeleton, {}, ())
    pose = AppliedLayers(box).update(rest, STEP_S, target=np.ones(3))
    assert np.array_equal(pose.rotations, rest.rotations)


def test_blinks_come_as_often_as_peoples_and_never_in_step():
    blinking, other = BlinkTimer(1), BlinkTimer(2)
    lids = np.array([blinking.update(STEP_S) for _ in range(60 * 600)])
    others = np.array([other.update(STEP_S) for _ in range(60 * 600)])
    shut = (lids[1:] > 0.95) & (lids[:-1] <= 0.95)
    assert 12 <= shut.sum() / 10 <= 22
    starts = np.flatnonzero(shut)
    assert np.std(np.diff(starts)) > 0.3 * np.mean(np.diff(starts))
    assert ((lids > 0.5) & (others > 0.5)).mean() < 0.02
    assert lids.min() >= 0.0
    assert lids.max() <= 1.0


def test_a_great_turn_of_the_gaze_brings_a_blink():
    blinking = BlinkTimer(5)
    assert blinking.update(STEP_S) == 0.0
    blinking.update(STEP_S, gaze_shift=1.0)
    assert max(blinking.update(STEP_S) for _ in range(12)) == 1.0


@given(st.floats(-1, 1))
def test_lids_move_smoothly(time):
    assert abs(lid_closure(time + 1e-4) - lid_closure(time)) < 3e-3


@pytest.mark.parametrize(
    "names",
    some(
        [
            ["まばたき"],
            ["Fcl_EYE_Close_R", "Fcl_EYE_Close_L", "Fcl_EYE_Close"],
            ["eyeBlinkLeft", "eyeBlinkRight"],
            ["blink"],
            ["Blink"],
            ["eyesClosed", "eyeBlinkLeft", "eyeBlinkRight"],
            ["eyeBlink_R", "eyeBlink_L"],
            ["Facial_Blends.Blink_Left", "Facial_Blends.Blink_Right"],
            ["vrc.blink"],
            ["Eye Blink.L", "Eye Blink.R"],
        ],
        2,
    ),
)
def test_eyes_blink_whatever_their_morphs_are_called(names):
    morphs = ("jawOpen", *names, "eyeSquintLeft")
    skeleton, _ = bust(0)
    life = AppliedLayers(Character("bust", skeleton, {}, (), morphs, SEMANTICS))
    weights = np.array([life.update(skeleton.rest, STEP_S).morphs for _ in range(900)])
    shut = weights[:, 1:-1].max(axis=1) > 0.99
    assert shut.any()
    assert not weights[:, [0, -1]].any()
    assert weights[:, 1:-1].sum(axis=1).max() <= (2.0 if len(names) == 2 else 1.0)


def test_a_single_lid_of_a_pair_does_not_blink_alone():
    assert not Lids.of(["eyeBlinkLeft", "smile"])


def test_an_eye_that_winks_is_not_closed_twice():
    lids = Lids.of(["blink", "blinkLeft", "blinkRight"])
    weights = np.array([0.0, 0.7, 0.0])
    lids.close(weights, 1.0)
    assert weights == pytest.approx([0.3, 0.7, 0.0])


@pytest.fixture(scope="module", params=some(["human", "vleo"]))
def someone(request):
    return Character.load(request.param)


def test_standing_still_is_never_quite_still_and_the_feet_stay(someone):
    clip = someone.clips["idle"]
    anatomy = Anatomy.guess(someone.skeleton, someone.semantics)
    life = AppliedLayers(someone)
    still = clip.sample(0.0)
    feet = [anatomy.joints["leftFoot"], anatomy.joints["rightFoot"]]
    heads, soles = [], []
    for _ in range(240):
        world = life.update(still, STEP_S).globals(someone.skeleton)[:, :3, 3]
        heads.append(world[anatomy.joints["head"]])
        soles.append(world[feet])
    assert np.ptp(heads, axis=0).max() > 0.001 * someone.height
    assert np.ptp(heads, axis=0).max() < 0.05 * someone.height
    assert np.ptp(soles, axis=0).max() < 1e-9


def test_breath_quickens_with_effort_and_calms_down_later(someone):
    life = AppliedLayers(someone)
    pose = someone.clips["idle"].sample(0.0)

    def breaths(seconds, effort):
        full = []
        for _ in range(seconds * 20):  # breath is slow
            life.update(pose, 1 / 20, effort=effort)
            full.append(life.context.breath)
        crossed = np.diff((np.array(full) > 0.5).astype(int)) > 0
        return crossed.sum() / seconds

    calm, hard = breaths(20, 0.0), breaths(30, 1.0)
    assert calm == pytest.approx(0.25, abs=0.06)
    assert hard > 1.8 * calm
    breaths(20, 0.0)
    assert breaths(20, 0.0) < 1.4 * calm


def test_an_animator_looks_where_it_is_told(someone):
    animator = Animator(someone)
    head = Anatomy.guess(someone.skeleton, someone.semantics).joint("head")
    turned = []
    for side in (1.0, -1.0):
        for number in range(90):
            time = (number + (90 if side < 0 else 0)) / 30
            gaze = np.array([0.5 * side, 0.1, 0.5])
            posed = animator.update(CharacterCommand(time, gaze=gaze))
        way = looking(someone.skeleton, posed.pose, head)
        turned.append(math.atan2(way[0], way[2]))
    assert turned[0] > math.radians(20)
    assert turned[1] < -math.radians(20)


def test_the_same_life_twice(someone):
    def lived():
        animator = Animator(someone, seed=3)
        commands = (CharacterCommand(n / 30, gaze=np.array([0.1, 0.2, 0.3])) for n in range(60))
        return [animator.update(command).pose.rotations for command in commands]

    assert np.array_equal(lived(), lived())
