"""A user's recordings become a locomotion space."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from cubeling.characters import (
    Animator,
    Character,
    CharacterCommand,
    CharacterError,
    LocomotionIntent,
    Pose,
)
from cubeling.characters.locomotion.gaits import RUN_CLIPS, WALK_CLIPS
from cubeling.characters.retargeting import Recording, load_recording, make_locomotion
from cubeling.characters.retargeting.locomotion.cycle import close_loop
from cubeling.characters.retargeting.locomotion.gait_cycle import ArcPath
from cubeling.characters.retargeting.measures import facing_error
from cubeling.characters.retargeting.rig import Rig
from cubeling.characters.retargeting.root import clip_with_root, with_root_joint
from cubeling.characters.retargeting.transfer import turns_from_rest
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.anatomy import Anatomy
from tests.examples import examples, some

SHARED = Path(__file__).parents[4] / "shared" / "data"


@pytest.fixture(scope="module")
def human():
    return Character.load("human")


def exported(human, name, cycles=2.5, clip=None):
    """A clip of the human as motion capture gives it: no loop, no root, the hips go where they go.

    It starts somewhere in the stride.
    """
    clip = clip or human.clips[name]
    skeleton = human.skeleton
    times = np.arange(int(cycles * clip.duration * 60)) / 60 + 0.23
    poses = [clip.sample(float(time)) for time in times]
    steps = [clip.travel(0.0, float(time)) for time in times]
    turns = np.stack([pose.rotations for pose in poses])
    translations = np.stack([pose.translations for pose in poses])
    yaw = rotations.about("y", np.array([step.yaw for step in steps]))
    at = np.array([[step.x, 0.0, step.z] for step in steps])
    below = [j for j, parent in enumerate(skeleton.parents) if parent == 0]
    translations[:, below] = rotations.rotate(yaw[:, None], translations[:, below]) + at[:, None]
    turns[:, below] = rotations.multiply(yaw[:, None], turns[:, below])
    turns[:, 0] = rotations.IDENTITY
    # The rig of the recording has another name for its origin, so it has no root.
    there = replace(skeleton, names=("world", *skeleton.names[1:]))
    recorded = replace(
        clip, name=name, poses=Pose(translations, turns), rate=60.0, loop=False, root_motion=False
    )
    return Recording(name, recorded, there, Anatomy.guess(there))


@pytest.fixture(scope="module")
def taught(human):
    """A human that knows nothing but one recorded walk and one recorded run."""
    bare = replace(human, clips={})
    return make_locomotion(bare, [exported(human, "Walk")], [exported(human, "Run", 3.2)])


@pytest.mark.full
def test_the_cycle_of_a_recording_is_found(human, taught):
    for found, name in zip(taught.recordings, ("Walk", "Run"), strict=True):
        clip = human.clips[name]
        assert found.duration == pytest.approx(clip.duration, rel=0.03)
        assert found.speed == pytest.approx(clip.cycle.length / clip.duration, rel=0.03)
        assert abs(found.angular) < 2
        assert found.seam < 0.01


def test_one_walk_and_one_run_fill_the_whole_tree(taught):
    names = {*WALK_CLIPS.values(), *RUN_CLIPS.values()}
    assert {found.name for found in taught.clips} == names
    assert names | {"idle"} <= set(taught.character.clips)


@pytest.mark.parametrize("tree", [WALK_CLIPS, RUN_CLIPS])
def test_every_clip_has_the_turn_of_its_knot(taught, tree):
    for knot, name in tree.items():
        clip = taught.character.clips[name]
        turned = -math.degrees(clip.cycle.yaw) / clip.duration
        assert turned == pytest.approx(1.5 * knot, abs=0.5)
        assert clip.loop
        assert clip.root_motion


def test_made_clips_loop_without_a_jump(taught):
    for found in taught.clips:
        clip = taught.character.clips[found.name]
        pose = clip.in_place
        ends = np.abs(pose.translations[0] - pose.translations[-1]).max()
        dots = np.abs((pose.rotations[0] * pose.rotations[-1]).sum(-1))
        assert ends < 1e-6
        assert dots.min() > 1 - 1e-9
        steps = 1 - np.abs((pose.rotations[1:] * pose.rotations[:-1]).sum(-1))
        assert steps.max() < 0.03


def test_standing_feet_do_not_slide_in_any_curve(taught):
    assert max(found.slide for found in taught.clips) < 0.01


def test_feet_do_not_sink_into_the_ground(human, taught):
    skeleton = taught.character.skeleton
    toes = [human.anatomy.joints[side + "Toes"] for side in ("left", "right")]
    rest = skeleton.rest.globals(skeleton)[toes, 1, 3]
    for found in taught.clips:
        clip = taught.character.clips[found.name]
        heights = clip.poses.globals(skeleton)[:, toes, 1, 3]
        assert (heights > rest - 2e-3).all()


def test_left_and_right_are_mirror_images(taught):
    clips = taught.character.clips
    for left, right in (("WalkLeftShort", "WalkRightShort"), ("RunLeftWide", "RunRightWide")):
        ours, theirs = clips[left].cycle, clips[right].cycle
        assert (ours.x, ours.z, ours.yaw) == pytest.approx((-theirs.x, theirs.z, -theirs.yaw))


@pytest.mark.slow(reason="a recording is retargeted to a walk and its curves")
@pytest.mark.parametrize("curves", some(["one_curve", "human"]))  # the latter makes all
def test_mirrored_bones_keep_their_lengths_on_an_uneven_body_in_a_file_that_rounds(
    human, curves, request
):
    request.getfixturevalue(curves)
    skeleton, walk = human.skeleton, human.clips["Walk"]
    longer = np.zeros((len(skeleton), 3))
    longer[skeleton.index("LeftLeg"), 1] = -0.01
    longer[skeleton.index("RightForeArm"), 0] = -0.01
    rest = replace(skeleton.rest, translations=skeleton.rest.translations + longer)
    noise = 1e-6 * np.random.default_rng(2).standard_normal(walk.poses.translations.shape)
    noise[:, :2] = 0.0
    poses = replace(walk.poses, translations=walk.poses.translations + longer + noise)
    uneven = replace(human, skeleton=replace(skeleton, rest=rest), clips={})
    own = Recording("own", replace(walk, poses=poses), uneven.skeleton, uneven.anatomy)
    made = make_locomotion(uneven, [own])
    assert any("mirrored" in found.origin for found in made.clips)
    assert max(found.bone_change for found in made.clips) < 1e-4


def test_it_goes_where_it_is_sent(taught):
    animator = Animator(taught.character)
    for frame in range(100):
        command = CharacterCommand(frame / 12, LocomotionIntent(2.0, np.array([0.25, -0.2])))
        posed = animator.update(command)
    x, _, z = posed.table_from_character[:3, 3]
    assert math.hypot(x - 0.25, z + 0.2) < 0.07


@pytest.mark.full
@pytest.mark.slow(reason="two recordings are retargeted to a walk and its curves")
@pytest.mark.usefixtures("one_curve")
def test_a_recorded_curve_is_used_for_its_side_and_mirrored_for_the_other(human):
    made = make_locomotion(
        replace(human, clips={}),
        [exported(human, "Walk"), exported(human, "WalkLeftMedium", 2.5)],
    )
    origins = {found.name: found.origin for found in made.clips}
    assert made.recordings[1].angular == pytest.approx(-60, abs=3)
    assert origins["WalkLeftMedium"] == "WalkLeftMedium"
    assert origins["WalkRightMedium"] == "WalkLeftMedium, mirrored"
    assert origins["Walk"] == "Walk"
    assert "Run" not in origins


@pytest.mark.usefixtures("straight_only")
def test_a_walk_in_place_moves_over_the_ground(human):
    walk = human.clips["Walk"]
    treadmill = replace(walk, poses=walk.in_place)
    own = Recording("treadmill", treadmill, human.skeleton, human.anatomy)
    made = make_locomotion(replace(human, clips={}), [own])
    assert made.recordings[0].speed == pytest.approx(walk.cycle.length / walk.duration, rel=0.03)


def test_a_recording_of_standing_is_refused_as_a_walk(human):
    own = Recording("idle", human.clips["idle"], human.skeleton, human.anatomy)
    with pytest.raises(CharacterError, match="idle: goes nowhere"):
        make_locomotion(human, [own])


def test_a_recording_without_a_cycle_is_refused(human):
    with pytest.raises(CharacterError, match="no whole cycle found"):
        make_locomotion(human, [exported(human, "Walk", 0.6)])


def test_a_clip_must_be_named_where_there_are_many():
    with pytest.raises(CharacterError, match=r"which clip\? write human#CLIP.*Walk"):
        load_recording("human")
    assert load_recording("human#Walk").clip.name == "Walk"


def test_adding_a_root_joint_does_not_move_the_character(human):
    names = ("pelvis_parent", *human.skeleton.names[1:])
    bare = replace(human, skeleton=replace(human.skeleton, names=names), semantics={})
    rooted = with_root_joint(bare)
    assert rooted.skeleton.has_root_motion
    assert with_root_joint(rooted) is rooted
    recording = exported(human, "WalkLeftMedium")
    clip = clip_with_root(recording.clip, recording.skeleton, recording.anatomy)
    there = clip.poses.globals(rooted.skeleton)[:, 1:, :3, 3]
    assert np.allclose(there, recording.clip.poses.globals(recording.skeleton)[..., :3, 3])
    assert np.ptp(clip.track[:, 2]) > 1.0
    for mesh, old in zip(rooted.meshes, bare.meshes, strict=True):
        assert (mesh.joints == old.joints + 1).all()


@settings(max_examples=examples(30))
@given(
    st.floats(0.3, 4), st.floats(-2.5, 2.5), st.floats(-0.5, 0.5), st.floats(0, 2), st.floats(0, 1)
)
def test_arc_coordinates_round_trip(speed, yaw_rate, left, time, height):
    path = ArcPath(speed, yaw_rate)
    if abs(left * path.curvature) > 0.9:
        return
    times = np.array([time])
    point = path.from_arc(np.array([[speed * time + 0.2, height, left]]))
    coordinates = path.to_arc(point, times)
    assert np.allclose(coordinates, [[speed * time + 0.2, height, left]], atol=1e-6)


def captured(name):
    return load(SHARED / "cmu-mocap" / f"{name}.amc")


def load(path):
    if not path.exists():
        pytest.skip("no shared data")
    return load_recording(str(path))


@pytest.mark.slow(reason="recordings are retargeted to a walk, a run, and their curves")
@pytest.mark.parametrize("curves", some(["one_curve", "human"]))  # the latter makes all
def test_motion_capture_makes_locomotion_clips_without_sliding(tmp_path, curves, request):
    request.getfixturevalue(curves)
    walk, run = captured("16/16_15"), captured("16/16_35")
    made = make_locomotion(Character.load(SHARED / "gltf" / "CesiumMan.glb"), [walk], [run])
    assert max(found.slide for found in made.clips) < 0.01
    assert all(found.seam < 0.02 for found in made.recordings)
    made.character.save(tmp_path / "walks.glb")
    walker = Animator(Character.load(tmp_path / "walks.glb"))
    for frame in range(20):
        command = CharacterCommand(frame / 10, LocomotionIntent(2.0, np.array([0.0, 2.0])))
        posed = walker.update(command)
    assert posed.state == "walk"
    assert posed.table_from_character[2, 3] > 0.1


@pytest.mark.full
@pytest.mark.slow(reason="the walk is looked for in a recording of many seconds")
@pytest.mark.usefixtures("straight_only")
def test_a_walk_with_standing_and_turning_around_it_is_found():
    recording = load(SHARED / "bvh" / "131_01.bvh")
    (found,) = make_locomotion(Character.load("human"), [recording]).recordings
    assert 0.9 < found.speed < 1.1, "the shuffling before the walk closes better"
    assert 1.0 < found.duration < 1.4


@pytest.mark.usefixtures("straight_only")
@pytest.mark.parametrize("size", some([1.3, 1.0]))
def test_a_made_idle_faces_ahead_and_stands_over_its_root(human, taught, size):
    """Whatever the person faced and wherever she stood in the recording."""
    idle, skeleton = human.clips["idle"], human.skeleton
    hips = skeleton.index("hips")
    translations, turns = idle.poses.translations * size, idle.poses.rotations.copy()
    back = rotations.about("y", np.pi)
    translations[:, hips] = rotations.rotate(back, translations[:, hips]) + [2.0, 0.0, 3.0]
    turns[:, hips] = rotations.multiply(back, turns[:, hips])
    rest = replace(skeleton.rest, translations=skeleton.rest.translations * size)
    person = replace(skeleton, rest=rest)
    clip = replace(idle, poses=Pose(translations, turns), loop=False)
    recording = Recording("still", clip, person, human.anatomy)
    walks = [exported(human, "Walk")]
    walker = make_locomotion(taught.character, walks, idle=recording).character
    made = walker.clips["idle"]
    assert abs(facing_error(made.poses, Rig(walker.skeleton, walker.anatomy))) < math.radians(10)
    at = made.poses.globals(walker.skeleton)[:, walker.anatomy.joints["hips"], :3, 3].mean(0)
    assert np.abs(at[[0, 2]]).max() < 0.05


@pytest.mark.full
@pytest.mark.slow(reason="two walks are made of recordings")
@pytest.mark.usefixtures("straight_only")
def test_made_clips_look_ahead_though_the_neck_was_recorded_straight(human):
    """Motion capture has straight necks at rest, so people who look ahead seem to look down."""
    recording = exported(human, "Walk")
    neck = recording.anatomy.joints["neck"]
    turns = recording.clip.poses.rotations.copy()
    bent = rotations.about("x", np.radians(25.0))
    turns[:, neck] = rotations.multiply(turns[:, neck], bent)
    nodding = turns.copy()
    nodding[:, neck] = rotations.multiply(
        nodding[:, neck], rotations.about("x", 0.3 * np.sin(np.arange(len(turns)) / 5.0))
    )
    pitches = []
    for each in (turns, nodding):
        clip = replace(recording.clip, poses=replace(recording.clip.poses, rotations=each))
        larger = replace(
            recording.skeleton.rest, translations=recording.skeleton.rest.translations * 1.1
        )
        other = replace(recording.skeleton, rest=larger)
        made = make_locomotion(human, [replace(recording, clip=clip, skeleton=other)]).character
        rig = Rig(made.skeleton, made.anatomy)
        head = turns_from_rest(made.clips["Walk"].poses, rig, [made.anatomy.joints["head"]])[:, 0]
        pitches.append(np.degrees(np.arcsin(rotations.rotate(head, [0.0, 0.0, 1.0])[:, 1])))
    assert -8.0 < pitches[0].mean() < 2.0
    assert np.ptp(pitches[1]) > 20.0


@pytest.mark.slow(reason="a recording is retargeted to a walk")
@pytest.mark.usefixtures("straight_only")
def test_steps_of_a_single_limping_stride_are_made_alike(human):
    walk = exported(human, "Walk", 1.6)
    poses, limp = walk.clip.poses, np.linspace(0.0, 1.0, len(walk.clip))
    turns = poses.rotations.copy()
    for joint in map(human.skeleton.index, ("LeftUpLeg", "RightArm")):
        turns[:, joint] = rotations.multiply(turns[:, joint], rotations.about("x", limp))
    limping = replace(walk, clip=replace(walk.clip, poses=replace(poses, rotations=turns)))
    made = make_locomotion(replace(human, clips={}), [limping])
    assert not made.recordings[0].warnings  # 7.6 cm apart without
    clip, skeleton = made.character.clips["Walk"], made.character.skeleton
    at = clip.in_place.globals(skeleton)[..., :3, 3]
    left, right = (at[:, skeleton.index(f"{side}Hand"), 2] for side in ("Left", "Right"))
    assert np.ptp(left) == pytest.approx(np.ptp(right), rel=0.05)


@pytest.mark.parametrize(("speed", "gap"), [(1.0, 0.0), (-1.0, 0.2), (0.3, -0.2)])
def test_a_closed_loop_goes_on_at_its_end_as_it_begins(human, speed, gap):
    idle = human.clips["idle"]
    rest, frames = idle.poses[np.zeros(61, int)], np.linspace(0.0, 1.0, 61)
    rest.translations[:, 1, 0] += gap * frames + speed * frames**2
    rest.rotations[:, 1] = rotations.multiply(
        rest.rotations[:, 1], rotations.about("y", gap * frames + speed * frames**2)
    )
    loop = close_loop(replace(idle, poses=rest, rate=60.0, loop=False), [rest]).poses
    for values in (loop.translations, loop.rotations):
        assert np.allclose(values[0], values[-1], atol=1e-9)
        before, after = values[-1] - values[-2], values[1] - values[0]
        assert np.allclose(before, after, atol=0.01)  # 0.033 without
