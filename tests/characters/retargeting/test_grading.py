"""Made gaits are measured: their faults are told, and what is no gait is refused."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, strategies as st

from cubeling.characters import Character, CharacterError, Pose
from cubeling.characters.locomotion.gaits import Gaits
from cubeling.characters.retargeting import GaitReport, Recording, make_locomotion
from cubeling.characters.retargeting.locomotion.grading import refuse_other_motion
from cubeling.characters.retargeting.locomotion.recorded_gait import extract_gait
from cubeling.characters.retargeting.measures import bone_change, facing_error, knee_bends, sole_dip
from cubeling.characters.retargeting.rig import Rig
from cubeling.characters.retargeting.root import move_to_trajectory
from cubeling.characters.skeleton import rotations
from tests.characters.retargeting.test_retarget_locomotion import exported
from tests.examples import some

GOOD = GaitReport("walk", "walk", 1.0, 1.4, 0.0, 0.01, 0.0, 0.0, 0.0, 0.0, 0.0, 0.92)


@pytest.fixture(scope="module")
def human():
    return Character.load("human")


def made(human, recording):
    return make_locomotion(replace(human, clips={}), [recording])


def moving(human, way):
    """The walk of the human on another way: rows of x, z and yaw are multiplied by it."""
    walk = human.clips["Walk"]
    poses = move_to_trajectory(walk.in_place, walk.track * way)
    return Recording("moved", replace(walk, poses=poses), human.skeleton, human.anatomy)


@pytest.mark.usefixtures("straight_only")
@pytest.mark.parametrize("name", some(["Walk", "Run"]))
def test_our_own_walk_and_run_have_no_fault(human, name):
    (report,) = made(human, exported(human, name, 3.2)).recordings
    assert not report.warnings


@pytest.mark.parametrize(
    ("fault", "change"),
    [
        ("seam", {"seam": 0.15}),
        ("slide", {"slide": 0.65}),
        ("sinking", {"sinking": 0.03}),
        ("knees", {"knee_excess": np.radians(15.0)}),
        ("bones", {"bone_change": 0.4}),
        ("facing", {"facing": -np.radians(80.0)}),
    ],
)
@given(size=st.floats(0.01, 100.0))
def test_a_fault_is_told_in_one_line_at_any_size(fault, change, size):
    lengths = ("speed", "seam", "slide", "sinking", "leg_length")
    report = replace(GOOD, **change)
    scaled = replace(report, **{name: size * getattr(report, name) for name in lengths})
    assert list(report.warnings) == list(scaled.warnings) == [fault]
    assert "\n" not in report.warnings[fault]


def test_steps_on_the_spot_are_refused_as_a_walk(human):
    walk = human.clips["Walk"]
    gaits = Gaits(human.clips, human.skeleton, human.clips["idle"].sample(0.0))
    steps = gaits.at(gaits.speed(walk.cycle.length / walk.duration), 0.0, stride=0.1)
    phases = np.linspace(0.0, 1.0, len(walk))
    poses = [steps.at(float(phase)) for phase in phases]
    deltas = [steps.between(0.0, float(phase)) for phase in phases]
    pose = Pose(np.stack([p.translations for p in poses]), np.stack([p.rotations for p in poses]))
    track = np.array([[delta.x, delta.z, delta.yaw] for delta in deltas])
    boxing = replace(walk, poses=move_to_trajectory(pose, track))
    with pytest.raises(CharacterError, match=r"no walk, at 0\.\d\d m/s|goes nowhere \(0\.\d\d m/s"):
        made(human, exported(human, "boxing", 3.0, boxing))


def test_a_walk_backwards_is_refused(human):
    with pytest.raises(CharacterError, match="goes backwards: its body looks 180° away"):
        made(human, moving(human, [1.0, -1.0, 1.0]))


def test_a_walk_that_does_not_repeat_is_refused(human):
    recording = exported(human, "Walk", 1.2)
    clip, hips = recording.clip, human.anatomy.joints["hips"]
    sinking = clip.poses.translations.copy()
    sinking[:, hips, 1] += np.linspace(0.0, 1.5, len(clip))
    poses = replace(clip.poses, translations=sinking)
    with pytest.raises(CharacterError, match=r"no step repeats|no whole cycle"):
        made(human, replace(recording, clip=replace(clip, poses=poses)))


def test_feet_that_never_stand_still_are_refused(human):
    walk = human.clips["Walk"]
    gait = extract_gait(moving(human, 1.0), human, human)
    skating = move_to_trajectory(walk.in_place, walk.track * [1.0, 1.9, 1.0])
    with pytest.raises(CharacterError, match="no foot stands still; they slide at"):
        refuse_other_motion(replace(gait, clip=replace(walk, poses=skating)))


@pytest.mark.usefixtures("straight_only")
def test_a_body_that_grows_is_told(human):
    walk = human.clips["Walk"]
    longer = walk.poses.translations.copy()
    longer[:, human.anatomy.joints["leftLowerArm"]] *= 1.4
    clip = replace(walk, poses=replace(walk.poses, translations=longer))
    own = Recording("grown", clip, human.skeleton, human.anatomy)
    (report,) = made(human, own).recordings
    assert "40%" in report.warnings["bones"]


def test_measures_of_known_poses(human):
    rig = Rig(human.skeleton, human.anatomy)
    poses = human.clips["idle"].in_place[0:3]
    left = rig.legs[0]
    bent = poses.rotations.copy()
    bent[:, left.lower] = rotations.multiply(bent[:, left.lower], rotations.about("x", 0.5))
    before, after = (knee_bends(p, rig, left) for p in (poses, replace(poses, rotations=bent)))
    assert np.allclose(after - before, 0.5, atol=0.02)
    turned = poses.rotations.copy()
    turned[:, 0] = rotations.about("y", 0.7)
    facing = [facing_error(p, rig) for p in (poses, replace(poses, rotations=turned))]
    assert facing[1] - facing[0] == pytest.approx(0.7, abs=0.06)
    lowered = poses.translations.copy()
    lowered[:, 0, 1] -= 0.05
    dips = [sole_dip(p, rig, human.meshes) for p in (poses, replace(poses, translations=lowered))]
    assert dips[1] - dips[0] == pytest.approx(0.05, abs=0.003)
    assert bone_change(poses, rig) < 1e-6
