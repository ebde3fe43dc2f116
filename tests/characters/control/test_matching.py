"""A character that walks by motion matching, on a small database of the human's own loops."""

import math
from dataclasses import replace
from functools import partial

import numpy as np
import pytest

from cubeling.characters import (
    ActionIntent,
    Animator,
    Character,
    CharacterCommand,
    CharacterError,
    Clip,
    LocomotionIntent,
    Pose,
    PosedCharacter,
    choose_controller,
    mirror_of,
)
from cubeling.characters.control.controllers.matching import MatchingController
from cubeling.characters.control.layers import FOOT_LAYERS
from cubeling.characters.motion.inertialization import Inertialization
from cubeling.characters.skeleton import rotations
from cubeling.characters.synthesis.matching.database import MotionDatabase, Playhead
from cubeling.characters.synthesis.matching.matched_motion import MatchedMotion

RATE = 60
LOOPS = ("idle", "Walk", "WalkRightMedium", "WalkRightShort", "Run", "RunRightMedium")
SCRIPT = ((0.0, 0.0), (2.0, 0.0), (4.5, 0.0), (2.0, 1.2), (4.5, 0.0), (0.0, 0.0), (0.0, 0.0))
"""Speed and heading [rad], each for a second."""


@pytest.fixture(scope="module")
def human() -> Character:
    return Character.load("human")


@pytest.fixture(scope="module")
def database(human) -> MotionDatabase:
    loops = [human.clips[name] for name in LOOPS]
    return MotionDatabase.of(loops, human.skeleton, human.anatomy, mirror_of(human))


def animated(human, database, place=None):
    return Animator(
        human,
        scale=1.0,
        place=place,
        layers=FOOT_LAYERS,
        controller=partial(MatchingController, database=database),
    )


def scripted(human, database):
    """Return what is shown in `SCRIPT`, and the controller."""
    animator = animated(human, database)
    shown: list[PosedCharacter] = []
    for frame in range(RATE * len(SCRIPT)):
        speed, yaw = SCRIPT[frame // RATE]
        x, z = (0.0, 0.0) if not shown else shown[-1].table_from_character[[0, 2], 3]
        target = np.array([x + 99 * math.sin(yaw), z + 99 * math.cos(yaw)])
        going = LocomotionIntent(speed, target, stop=False)
        stand = None if speed else ActionIntent("idle")
        shown.append(animator.update(CharacterCommand(frame / RATE, going, stand)))
    return shown, animator.controller


@pytest.fixture(scope="module")
def walked(human, database):
    return scripted(human, database)


def test_it_stands_walks_and_runs_as_asked(walked):
    states = [posed.state for posed in walked[0]]
    assert states[RATE - 1] == "idle"
    assert states[2 * RATE - 1] == "walk"
    assert states[3 * RATE - 1] == "run"
    assert states[4 * RATE - 1] == "walk"
    assert states[-1] == "idle"


def test_the_same_commands_give_the_same_frames(human, database, walked):
    again, _ = scripted(human, database)
    for one, other in zip(walked[0], again, strict=True):
        assert np.array_equal(one.pose.rotations, other.pose.rotations)
        assert np.array_equal(one.table_from_character, other.table_from_character)


def test_arms_may_play_another_clip_than_the_legs_and_stay_in_step(human, database):
    motion = MatchedMotion(database, database.stillest)
    walk, run = (LOOPS.index(name) for name in ("Walk", "WalkRightMedium"))
    found = database.match_arms(Playhead(run, 0.3), Playhead(walk, 0.2), math.inf)
    assert found is not None
    feet = database.arms.columns["feet"]
    row, wanted = database.row(found), database.row(Playhead(walk, 0.2))
    apart = np.linalg.norm(database.arms.values[row, feet] - database.arms.values[wanted, feet])
    assert apart < 1.0
    upper = set(database.upper.tolist())
    assert human.anatomy.joints["leftHand"] in upper
    assert human.anatomy.joints["leftFoot"] not in upper
    assert motion.sample(0.0).rotations.shape == human.skeleton.rest.rotations.shape


def test_planted_feet_do_not_slide(human, walked):
    feet = [human.anatomy.joints[side + "Toes"] for side in ("left", "right")]
    placed = np.stack(
        [p.table_from_character @ p.pose.globals(human.skeleton)[feet] for p in walked[0]]
    )[..., :3, 3]
    speeds = np.linalg.norm(np.diff(placed[..., [0, 2]], axis=0), axis=-1) * RATE
    low = placed[..., 1] - placed[..., 1].min() < 0.004
    planted = low[1:-2] & low[:-3] & low[2:-1] & low[3:]
    assert planted.mean() > 0.3
    assert speeds[:-2][planted].mean() < 0.02  # [m/s]; the benchmark measures it on more


def test_transitions_do_not_jump(human, database):
    """Position and velocity at a jump are continuous, for legs and arms."""
    motion = MatchedMotion(database, Playhead(LOOPS.index("Walk"), 0.1))
    run = {"path": np.array([0, 1.3, 0, 2.6, 0, 3.9]), "facing": np.array([0.0, 1] * 3)}
    fastest = 0.0
    poses = []
    for frame in range(RATE):
        time = frame / RATE
        if frame == RATE // 2:
            motion.match(time, lambda: run, sudden=True)
            assert database.clips[motion.legs(time).clip].name == "Run"
        poses.append(motion.sample(time))
        fastest = max(fastest, motion.travel(time, time + 1e-4).z / 1e-4)
    at = Pose.of_frames(poses).globals(human.skeleton)[..., :3, 3]
    changes = np.linalg.norm(np.diff(at, 2, axis=0), axis=-1).max(-1) * RATE
    around = slice(RATE // 2 - 3, RATE // 2 + 3)
    assert changes[around].max() < 2.0  # [m/s] a frame; the run itself has 1.9
    assert fastest < 4.0


def test_hips_that_shake_under_a_steady_trunk_do_not_shake_the_trunk_of_another_clip(human):
    """As in recordings, whose spines make up for the noise of the markers on the hips."""
    walk, run = human.clips["Walk"], human.clips["Run"]
    hips, spine = (human.anatomy.joints[part] for part in ("hips", "spine"))
    noise = rotations.about("z", 0.05 * np.random.default_rng(0).standard_normal(len(walk)))
    turns = walk.poses.rotations.copy()
    turns[:, hips] = rotations.multiply(turns[:, hips], noise)
    turns[:, spine] = rotations.multiply(rotations.conjugate(noise), turns[:, spine])
    shaken = replace(walk, poses=replace(walk.poses, rotations=turns))
    changes = []
    for legs in (walk, shaken):
        database = MotionDatabase.of([legs, run], human.skeleton, human.anatomy)
        motion = MatchedMotion(database, Playhead(0, 0.2))
        motion.match(0.0, lambda: {}, sudden=True)
        motion._arms.jump(Playhead(1, 0.1), 0.0)
        poses = [motion.sample(frame / RATE) for frame in range(RATE // 2)]
        head = Pose.of_frames(poses).globals(human.skeleton)[:, human.anatomy.joints["head"]]
        changes.append(np.abs(np.diff(head[:, :3, :3], 2, axis=0)).max())
    assert changes[1] < 1.5 * changes[0]


def test_arms_turn_the_same_way_round_as_the_joints_that_carry_them(human):
    """A shoulder that turns by 100° and an elbow by as much turn the forearm by 200°, not −160°."""
    arm = [human.anatomy.joints["left" + part] for part in ("UpperArm", "LowerArm")]
    rest = human.skeleton.rest
    bent = rest.rotations.copy()
    bent[arm] = rotations.multiply(rotations.about("y", math.radians(100)), bent[arm])
    poses = [replace(rest, rotations=turns) for turns in (bent, rest.rotations)]
    old, new = (pose.turned_in_character(human.skeleton) for pose in poses)
    passing = Inertialization.begin((old, old), (new, new), 0.1, 0.3, human.skeleton.parents)
    turns = np.degrees(passing.rotations.offset[arm])
    assert np.allclose(np.linalg.norm(turns, axis=1), [100.0, 200.0])
    assert turns[0] @ turns[1] > 0.0


def test_it_comes_to_a_target_and_stands(human, database):
    animator = Animator(human, controller=partial(MatchingController, database=database))
    for frame in range(5 * RATE):
        going = LocomotionIntent(2.0, np.array([0.1, 0.3]))
        posed = animator.update(CharacterCommand(frame / RATE, going))
    x, z = posed.table_from_character[[0, 2], 3]
    assert math.hypot(x - 0.1, z - 0.3) < 0.065  # [m on the table]
    assert posed.state == "idle"


def test_an_action_is_played_and_left_again(human, database):
    animator = animated(human, database)
    states = []
    for frame in range(6 * RATE):
        action = ActionIntent("wave") if frame < RATE else None
        going = LocomotionIntent(2.0, np.array([0.0, 99.0]))
        states.append(animator.update(CharacterCommand(frame / RATE, going, action)).state)
    assert states[RATE // 2] == "wave"
    assert states[-1] == "walk"


def test_a_character_that_cannot_walk_is_refused_in_one_line():
    with pytest.raises(CharacterError, match=r"vleo: has no walk of its own .* --motions") as error:
        choose_controller("matching", Character.load("vleo"))
    assert "\n" not in str(error.value)


def test_recordings_that_stay_in_place_are_refused(human):
    idle = human.clips["idle"]
    with pytest.raises(CharacterError, match=r"none of the clips \(idle\) moves over the ground"):
        MotionDatabase.of([idle], human.skeleton, human.anatomy)


def test_clips_of_another_skeleton_are_refused(human):
    vleo = Character.load("vleo")
    with pytest.raises(CharacterError, match="is of another skeleton; retarget it first"):
        MotionDatabase.of([vleo.clips["idle"]], human.skeleton, human.anatomy)


def test_a_skeleton_without_feet_is_refused(human):
    clip: Clip = human.clips["Walk"]
    legless = type(human.anatomy)("other", {"hips": 1})
    with pytest.raises(CharacterError, match="the skeleton has no leftFoot; give a character"):
        MotionDatabase.of([clip], human.skeleton, legless)


@pytest.mark.parametrize(
    ("files", "problem"),
    [
        (("nowhere.bvh",), "nowhere.bvh"),
        (("notes.txt",), "notes.txt"),
        (("",), "no motion in this folder"),
    ],
)
def test_motions_that_cannot_be_read_are_named(human, tmp_path, files, problem):
    names = [str(tmp_path / file) for file in files]
    with pytest.raises(CharacterError, match=problem) as error:
        choose_controller("matching", human, names)
    assert "\n" not in str(error.value)


def test_one_recording_is_enough(human):
    controller = choose_controller("matching", human, ["human#Walk"])(human, 1.0, None)
    command = CharacterCommand(0.0, LocomotionIntent(2.0, np.array([0.0, 99.0])))
    for _ in range(RATE):
        frame = controller.update(command, 1 / RATE)
    assert frame.state == "walk"
