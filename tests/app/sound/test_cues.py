"""Cues: what is heard when, in a session that is played by commands."""

import dataclasses

import numpy as np
import pytest

from cubeling.affect import Emotion
from cubeling.app.pipeline.scenario import EmotionTarget, Outcome
from cubeling.app.pipeline.step import Performance, Step
from cubeling.app.sound import SoundCues
from cubeling.characters import Animator, Character, RootDelta
from cubeling.characters.rendering import FloorPath
from cubeling.tracking import CubeState, Frame
from tests.characters.commands import command

FRAME = 1 / 30
LIPS_PART_S = 0.12  # after the beginning of "mwah"


@pytest.fixture(scope="module")
def vleo():
    return Character.load("vleo")


@pytest.fixture
def steps(hand):
    """Return a function that makes steps of poses, in which nothing else happens."""
    hand.frame()
    controls = hand.frame(camera_from_table=None)
    calm = EmotionTarget(Emotion(0.0, 0.0, "neutral"), 0.0)
    outcome = Outcome(command(0.0), calm, hint="")
    frame = Frame(np.zeros((1, 1, 3), np.uint8), 0.0, 0)
    state = CubeState(False, None, np.zeros(6), np.zeros((6, 6)), "markers", (), 0.0, 0.0)
    return lambda posed, **changes: Step(
        frame, state, controls, dataclasses.replace(outcome, **changes), posed, None
    )


def played(character, activities, steps, weight=0.0):
    """Return the time and the cue of each sound of some activities, and the poses."""
    animator, cues = Animator(character, place=RootDelta()), SoundCues(character)
    heard, poses = [], []
    for frame, activity in enumerate(activities):
        poses.append(animator.update(command(frame * FRAME, activity, weight=weight)))
        heard += [(frame * FRAME, cue) for cue in cues.update(steps(poses[-1]))]
    return heard, poses


def times(heard, name):
    return [time for time, cue in heard if cue.name == name]


@pytest.mark.parametrize("weight", [-1.0, 0.0, 1.0])
def test_each_kiss_is_heard_when_its_lips_part(vleo, steps, weight):
    heard, poses = played(vleo, ["idle"] * 10 + ["kiss"] * 200, steps, weight)
    pucker = np.array([posed.pose.morphs[vleo.morphs.index("ou")] for posed in poses])
    kisses = times(heard, "kiss")
    assert len(kisses) == 3  # 6.7 s of a loop of 2.4 s
    for start in kisses:
        around = slice(round(start / FRAME), round(start / FRAME) + 12)
        peak = (around.start + int(np.argmax(pucker[around]))) * FRAME
        assert start + LIPS_PART_S == pytest.approx(peak, abs=1.01 * FRAME)


def test_each_shout_is_heard_when_the_mouth_opens_and_more_so_at_high_intensity(vleo, steps):
    loud = {}
    for weight in (-1.0, 1.0):
        heard, poses = played(vleo, ["shout"] * 130, steps, weight)
        mouth = np.array([posed.pose.morphs[vleo.morphs.index("aa")] for posed in poses])
        opened = 1 + np.flatnonzero((mouth[1:] > 0.5) & (mouth[:-1] <= 0.5))
        assert times(heard, "shout") == pytest.approx(opened * FRAME)
        loud[weight] = next(cue.gain for _, cue in heard if cue.name == "shout")
    assert loud[1.0] > loud[-1.0]


def test_a_jump_for_joy_is_a_leap_and_a_landing(vleo, steps):
    heard, _ = played(vleo, ["kiss"] * 70, steps, weight=1.0)
    names = [cue.name for _, cue in heard]
    assert names.count("hop") == 2  # it jumps, and hops once more
    assert names.count("land") >= 2
    assert times(heard, "hop")[0] < times(heard, "land")[0]


def test_a_walking_human_steps_and_a_running_one_sounds_otherwise(steps):
    human = Character.load("human")
    cues, names, rates = SoundCues(human), [], []
    animator = Animator(human)
    for frame in range(180):
        speed = 2.0 if frame < 90 else 4.5
        going = command(frame * FRAME, "move", speed, np.array([0.0, 9.0]), stop=False)
        for cue in cues.update(steps(animator.update(going))):
            names.append((frame < 90, cue.name))
            rates.append(cue.rate)
    assert names.count((True, "step")) >= 4
    assert names.count((False, "running_step")) >= 5
    assert {name for _, name in names} == {"step", "running_step"}
    assert len(set(rates)) == 2  # the left foot, and the right one


def test_a_hidden_character_and_idling_are_silent(vleo, steps):
    assert not played(vleo, ["idle"] * 90, steps)[0]
    cues, animator = SoundCues(vleo), Animator(vleo)
    for frame in range(60):
        hidden = animator.update(command(frame * FRAME, "shout", visible=False))
        assert not cues.update(steps(hidden))


def test_the_robots_mood_is_heard_when_its_word_changes_and_not_too_often(vleo, steps):
    posed = Animator(vleo).update(command(0.0))
    cues, heard = SoundCues(vleo), []
    words = ["happy"] * 30 + ["neutral", "happy"] * 15 + ["angry"] * 60 + ["gloating"] * 40
    for frame, word in enumerate(words):
        emotion = EmotionTarget(Emotion(0.2, 0.1, word), frame * FRAME)
        heard += [(frame, cue.name) for cue in cues.update(steps(posed, emotion=emotion))]
    assert heard == [(30, "neutral"), (60, "angry"), (120, "happy")]
    silent = SoundCues(vleo, moods=(False,))
    for word in ("neutral", "happy"):
        emotion = EmotionTarget(Emotion(0.2, 0.1, word), 0.0)
        assert not silent.update(steps(posed, emotion=emotion))


def test_the_second_robot_is_heard_beside_the_first_and_lower(vleo, steps):
    posed = Animator(vleo).update(command(0.0))
    cues, heard = SoundCues(vleo, moods=(True, True)), []
    for frame, word in enumerate(["happy"] * 40 + ["angry"] * 40):
        step = steps(posed, emotion=EmotionTarget(Emotion(0.2, 0.1, "happy"), frame * FRAME))
        felt = EmotionTarget(Emotion(0.2, 0.1, word), frame * FRAME)
        other = Performance("ann", dataclasses.replace(step.outcome, emotion=felt), posed)
        heard += cues.update(dataclasses.replace(step, others=(other,)))
    assert [(cue.name, cue.rate < 1.0) for cue in heard] == [("angry", True)]


def test_the_cube_a_path_and_a_new_start_are_heard(vleo, steps):
    posed = Animator(vleo).update(command(0.0))
    cues = SoundCues(vleo)
    step = steps(posed)
    placed = dataclasses.replace(step, controls=dataclasses.replace(step.controls, placed=True))
    assert [cue.name for cue in cues.update(placed)] == ["placed"]
    for points, closed, names in (
        (1, False, ["pencil"]),
        (1, False, []),
        (3, False, ["pencil"]),
        (3, True, ["pencil"]),
        (0, False, []),
    ):
        floor = (FloorPath(np.zeros((points, 2)), closed),)
        assert [cue.name for cue in cues.update(steps(posed, floor=floor))] == names
    assert [cue.name for cue in cues.update(step, started_over=True)] == ["start_over"]


def test_what_stands_at_the_left_is_heard_at_the_left(vleo, steps):
    pans = []
    for x in (-0.3, 0.0, 0.3, 2.0):
        animator, cues = Animator(vleo, place=RootDelta(x=x)), SoundCues(vleo)
        camera = np.diag([1.0, -1.0, -1.0, 1.0])
        camera[2, 3] = 0.8
        for frame in range(30):
            step = steps(animator.update(command(frame * FRAME, "shout")))
            controls = dataclasses.replace(step.controls, camera_from_table=camera)
            for cue in cues.update(dataclasses.replace(step, controls=controls)):
                pans.append(cue.pan)
                break
            else:
                continue
            break
    assert pans == sorted(pans)
    assert pans[1] == pytest.approx(0.0, abs=0.01)
    assert pans[3] == 1.0
