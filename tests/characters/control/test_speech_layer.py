"""The body of who speaks: beats, gestures that a text asks for, nods, and interruptions."""

import itertools
from dataclasses import replace

import numpy as np
import pytest

from cubeling.app.pipeline.checkpoint import Checkpoint
from cubeling.characters import ActionIntent, Animator, Character, CharacterCommand, RootDelta
from cubeling.characters.control.command import SpeechIntent
from cubeling.characters.control.layers import LIVELINESS
from cubeling.characters.control.speech_profile import SpeechProfile
from cubeling.characters.skeleton import rotations
from cubeling.characters.speech.speech import Accent, GestureSpan, Phone, Utterance

RATE = 30
SEED = 3
"""That of the character and of its animators, which then share its gaits."""
ACCENTS = (Accent(1.0, 0.9), Accent(2.2, 0.6), Accent(3.4, 1.0))
SAID = Utterance("One two three", "en", 4.0, (), (Phone("a", 0.0, 4.0),), ACCENTS)


@pytest.fixture(scope="module")
def human():
    return replace(Character.load("human"), seed=SEED)


@pytest.fixture(scope="module")
def vleo():
    return Character.load("vleo")


def played(character, speech_at, seconds=7.0, action=None, layers=None):
    """Return the poses of a character; `speech_at` gives what it says at a time."""
    animator = Animator(character, place=RootDelta(), seed=SEED, layers=layers)
    poses = []
    for number in range(round(seconds * RATE)):
        now = number / RATE
        command = CharacterCommand(now, speech=speech_at(now), action=action)
        poses.append(animator.update(command).pose)
    return poses


@pytest.fixture(scope="module")
def silent(human):
    """Return what the human does for so long without a word; it is played once."""
    poses = played(human, lambda _: None, 9.0)
    return lambda seconds: poses[: round(seconds * RATE)]


STILL = SpeechProfile(liveliness=0.0)
"""Of who does nothing but gestures and nods."""


def always(speech):
    return lambda now: speech if now < speech.end else None


def turned(one, other, joint=None):
    """Return how far joints are turned between two sequences of poses, (frames,) or largest [°]."""
    a, b = (np.stack([pose.rotations for pose in poses]) for poses in (one, other))
    apart = rotations.to_rotation_vector(rotations.multiply(rotations.conjugate(a), b))
    angles = np.degrees(np.linalg.norm(apart, axis=-1))
    return angles.max(axis=1) if joint is None else angles[:, joint]


def test_hands_beat_with_a_speech_and_rest_before_and_after_it(human, silent):
    speech = SpeechIntent(SAID, 1.0, STILL)  # else she may stand on the other leg afterwards
    quiet, spoken = silent(9.0), played(human, always(speech), 9.0)
    arm = turned(quiet, spoken, human.anatomy.joint("rightUpperArm"))
    other = turned(quiet, spoken, human.anatomy.joint("leftUpperArm"))
    moved = np.maximum(arm, other)
    assert moved[: RATE // 2].max() < 1e-6
    assert moved[RATE : 5 * RATE].max() > 15.0
    assert moved[-RATE // 2 :].max() < 0.5


def test_hips_and_knees_join_in_and_the_feet_stay(human, silent):
    quiet, spoken = silent(7.0), played(human, always(SpeechIntent(SAID, 0.5)))
    for part in ("leftUpperLeg", "rightLowerLeg"):
        assert turned(quiet, spoken, human.anatomy.joint(part)).max() > 1.0
    feet = [human.anatomy.joint(f"{side}Foot") for side in ("left", "right")]
    places = np.stack([pose.globals(human.skeleton)[feet, :3, 3] for pose in spoken])
    assert np.linalg.norm(np.diff(places, axis=0), axis=-1).max() * RATE < 5e-3


def test_a_profile_without_liveliness_leaves_the_legs_alone(human, silent):
    still = SpeechIntent(SAID, 0.5, STILL)
    quiet, spoken = silent(7.0), played(human, always(still))
    for part in ("leftUpperLeg", "rightLowerLeg", "leftFoot"):
        assert turned(quiet, spoken, human.anatomy.joint(part)).max() < 1e-6


def test_a_head_nods_with_the_accents_where_there_are_no_hands(vleo):
    assert vleo.gestures is None or vleo.gestures.phrases
    still = replace(vleo, gestures=None)
    speech = SpeechIntent(SAID, 0.5, STILL)
    quiet, spoken = played(still, lambda _: None), played(still, always(speech))
    nod = turned(quiet, spoken, still.anatomy.joint("head"))
    for accent in ACCENTS:
        at = round((0.5 + accent.time) * RATE)
        assert nod[at - 4 : at + 3].max() > 1.0
    assert nod[round((0.5 + 4.6) * RATE) :].max() < 0.2


def test_the_same_speech_gives_the_same_motion(human):
    speech = SpeechIntent(SAID, 0.5)
    one, other = played(human, always(speech), 3.0), played(human, always(speech), 3.0)
    assert all(np.array_equal(a.rotations, b.rotations) for a, b in zip(one, other, strict=True))


def test_a_speech_that_is_cut_off_leaves_no_jump(human):
    speech = SpeechIntent(SAID, 0.2)
    poses = played(human, lambda now: speech if now < 1.2 else None, 3.0)
    quiet = played(human, lambda _: None, 3.0)
    frames = [poses[number : number + 2] for number in range(len(poses) - 1)]
    steps = [turned(a[:1], a[1:]).item() for a in frames]
    cut = round(1.2 * RATE)
    assert max(steps[cut - 1 : cut + 12]) < 30.0  # a stroke turns a joint by so much a frame
    arms = [human.anatomy.joint(f"{side}UpperArm") for side in ("left", "right")]
    assert max(turned(quiet, poses, arm)[cut + 12 :].max() for arm in arms) < 0.5


def test_a_new_speech_takes_over_from_an_old_one(human, silent):
    first = SpeechIntent(SAID, 0.2, STILL)
    second = SpeechIntent(replace(SAID, text="Four"), 1.5, STILL)
    poses = played(human, lambda now: first if now < 1.5 else always(second)(now), 8.0)
    quiet = silent(8.0)
    arms = [human.anatomy.joint(f"{side}UpperArm") for side in ("left", "right")]
    moved = np.max([turned(quiet, poses, arm) for arm in arms], axis=0)
    assert moved[round(2.0 * RATE) : round(5.5 * RATE)].max() > 15.0
    assert moved[-10:].max() < 0.5


def test_a_text_asks_for_a_clip_and_it_plays_in_its_span(human, silent):
    said = replace(SAID, accents=(), gestures=(GestureSpan("wave", 1.0, 2.5),))
    speech = SpeechIntent(said, 0.5, STILL)
    quiet, spoken = silent(5.0), played(human, always(speech), 5.0)
    arm = turned(quiet, spoken, human.anatomy.joint("rightUpperArm"))
    inside = slice(round(1.9 * RATE), round(2.6 * RATE))
    assert arm[inside].max() > 20.0
    assert arm[: round(1.45 * RATE)].max() < 0.5
    assert arm[round(3.05 * RATE) :].max() < 0.5


def test_an_expression_that_a_text_asks_for_shows_in_its_span(human):
    said = replace(SAID, accents=(), gestures=(GestureSpan("surprised", 1.0, 2.5),))
    layers = [LIVELINESS["face_shift"]]
    poses = played(human, always(SpeechIntent(said, 0.5)), 4.0, layers=layers)
    number = human.morphs.index("surprised")
    shown = [0.0 if pose.morphs is None else pose.morphs[number] for pose in poses]
    assert shown[round(2.2 * RATE)] == pytest.approx(1.0)
    assert max(shown[: round(1.4 * RATE)]) == max(shown[round(3.1 * RATE) :]) == 0.0


def test_hands_leave_the_beats_to_an_action(human):
    speech = SpeechIntent(SAID, 1.5)
    wave = ActionIntent("wave", 1.0)
    quiet = played(human, lambda _: None, 4.0, action=wave)
    spoken = played(human, always(speech), 4.0, action=wave)
    arm = turned(quiet, spoken, human.anatomy.joint("rightUpperArm"))
    assert arm[RATE * 2 : round(2.6 * RATE)].max() < 2.0  # then the wave is over
    assert arm[RATE * 3 :].max() > 15.0


def test_the_slider_makes_gestures_stronger(human):
    moved = {}
    for emphasis in (-1.0, 1.0):
        speech = SpeechIntent(SAID, 0.5, SpeechProfile(gesture_emphasis=emphasis))
        poses = played(human, always(speech), 5.0)
        steps = np.concatenate([turned([a], [b]) for a, b in itertools.pairwise(poses)])
        moved[emphasis] = steps.mean()
    assert moved[1.0] > 1.1 * moved[-1.0]


def test_who_performs_a_tagged_text_goes_on_from_a_checkpoint(human):
    said = replace(SAID, gestures=(GestureSpan("SHRUG", 0.3, 1.5),))
    animator = Animator(human, place=RootDelta(), seed=SEED)

    def play(body, first, last):
        commands = (
            CharacterCommand(n / RATE, speech=SpeechIntent(said, 0.0)) for n in range(first, last)
        )
        return [body.update(command).pose.rotations for command in commands]

    play(animator, 0, 20)
    copy = Checkpoint({"animator": animator})
    one, other = play(animator, 20, 30), play(copy.content()["animator"], 20, 30)
    assert np.array_equal(one, other)
