"""One gesticon: what a name moves, whoever asks for it, a tagged text or a block of BML."""

from dataclasses import replace

import numpy as np
import pytest

from cubeling.affect import Emotion
from cubeling.characters import Animator, CharacterCommand, RootDelta
from cubeling.characters.behaviour import GestureCollection
from cubeling.characters.behaviour.gesticon import Gesticon, Meaning
from cubeling.characters.control.command import SpeechIntent
from cubeling.characters.control.layers.clips import clip_joints
from cubeling.characters.control.speech_profile import SpeechProfile
from cubeling.characters.control.tagged_gestures import (
    TaggedGestures,
    known_gestures,
    meanings_of,
)
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.masks import subtree
from cubeling.characters.speech.speech import Accent, GestureSpan, Phone, Utterance, Word
from cubeling.characters.speech.tagged_text import TaggedText
from tests.bundled_characters import BUNDLED, bundled_character

RATE = 15
SAD = Emotion(-0.8, -0.4)
SAID = Utterance("No idea", "en", 2.4, (), (Phone("a", 0.0, 2.4),), (Accent(0.5, 0.8),))

THESIS = (
    '<begin_gesture id="g1" anim="shake_head"/>Unfortunately, I have <begin_gesture id="g2" '
    'anim="raise_shoulders"/>no idea <end_gesture id="g2"/> what you are talking about.'
    '<end_gesture id="g1"/>',
    '<begin_gesture id="g1" anim="hello"/>Hello there, <end_gesture id="g1"/> how are you doing '
    "today?",
    '<begin_gesture id="g1" anim="raise_eyebrows"/>Really?<end_gesture id="g1"/>',
)
"""The sentences of Egges 2006, section 5.3."""


def played(character, name, seconds=3.2):
    """Return the poses of a sad character that speaks, and is asked for a gesture by its text."""
    spans = (GestureSpan(name, 0.4, 2.0),) if name else ()
    speech = SpeechIntent(replace(SAID, gestures=spans), 0.6)
    animator = Animator(character, place=RootDelta())
    times = [number / RATE for number in range(round(seconds * RATE))]
    return [
        animator.update(
            CharacterCommand(now, emotion=SAD, speech=speech if now < speech.end else None)
        ).pose
        for now in times
    ]


def apart(one, other):
    """Return the angles between joints of two sequences of poses, (frames, joints) [degrees]."""
    a, b = (np.stack([pose.rotations for pose in poses]) for poses in (one, other))
    turns = rotations.to_rotation_vector(rotations.multiply(rotations.conjugate(a), b))
    return np.degrees(np.linalg.norm(turns, axis=-1))


@pytest.mark.parametrize("name", BUNDLED)
def test_a_head_shake_moves_head_and_neck_only(name):
    character = bundled_character(name)
    anatomy, skeleton = character.anatomy, character.skeleton
    moved = apart(played(character, ""), played(character, "shake_head"))
    neck, head = anatomy.joint("neck"), anatomy.joint("head")
    assert head is not None
    above = subtree(skeleton, head if neck is None else neck)
    below = [joint for joint in range(len(skeleton)) if joint not in above]
    assert moved[:, skeleton.with_ancestors([head])].sum(axis=1).max() > 5.0
    assert moved[:, below].max() < 0.5  # posture and mood stay
    assert moved[-5:].max() < 0.5


@pytest.mark.parametrize("marked", THESIS)
def test_the_sentences_of_the_thesis_are_performed(marked):
    human, text = bundled_character("human"), TaggedText.read(marked)
    names = [span.name for span in text.spans]
    assert list(meanings_of(human, names)) == list(dict.fromkeys(names))
    words = tuple(
        Word(word, 0.3 * number, 0.3 * number + 0.25, text.text.index(word))
        for number, word in enumerate(text.text.split())
    )
    length = words[-1].end
    said = Utterance(text.text, "en", length, words, gestures=text.gesture_spans(words, length))
    tagged, speech = TaggedGestures(human), SpeechIntent(said, 1.0)
    asked = set()
    for number in range(round(RATE * (length + 2.0))):
        now = number / RATE
        behaviour = tagged.add(CharacterCommand(now, speech=speech)).behaviour
        if behaviour is not None:
            asked |= {key for key, intents in vars(behaviour).items() if intents}
    assert asked == {f"{kind}s" for kind in meanings_of(human, names).values()}


@pytest.mark.parametrize(
    ("name", "meaning"),
    [
        ("shake_head", Meaning("head", "SHAKE")),
        ("raise_shoulders", Meaning("gesture", "SHRUG")),
        ("hello", Meaning("gesture", "WAVE")),
        ("raise_eyebrows", Meaning("face", "RAISE_BROWS")),
        ("Beat_Pos_B_Social", None),
    ],
)
def test_names_lead_to_what_is_meant(name, meaning):
    assert Gesticon.bundled().meaning(name) == meaning


def test_all_gestures_of_the_gesticon_are_there():
    from cubeling.characters.behaviour import GestureCollection
    from cubeling.characters.behaviour.realization.head_movements import HEAD_MOVEMENTS

    collection, human = GestureCollection.load_bundled(), bundled_character("human")
    for name in Gesticon.bundled().names:
        meaning = Gesticon.bundled().meaning(name)
        assert meaning is not None
        if meaning.kind == "gesture":
            assert name in collection
        if meaning.kind == "head":
            assert name in HEAD_MOVEMENTS
        if meaning.kind == "face":
            assert meanings_of(human, [name]) == {name: "face"}
    assert {"WAVE", "SHAKE", "RAISE_BROWS", "jump", "surprised"} <= {*known_gestures(human)}


def test_a_clip_takes_the_joints_that_it_moves():
    human = bundled_character("human")
    shaken = {human.skeleton.names[joint] for joint in clip_joints(human, "shake")}
    assert "head" in shaken
    assert not any("Arm" in name or "Hand" in name for name in shaken)
    waved = {human.skeleton.names[joint] for joint in clip_joints(human, "wave")}
    assert {"RightArm", "RightForeArm", "RightHand"} <= waved
    assert not waved & {"LeftArm", "spine1", "chest", "LeftUpLeg"}
    jumped = apart(played(human, ""), played(human, "jump"))
    assert jumped[:, human.anatomy.joint("rightUpperArm")].max() > 5.0
    assert jumped[:, human.anatomy.joint("leftUpperLeg")].max() < 0.5


def stroke_of_beat(accents, *, liveliness=1.0):
    """Return ready and end of the stroke of a beat that a text of 3 s asks for [s]."""
    human = bundled_character("human")
    said = Utterance("a b", "en", 3.0, accents=accents, gestures=(GestureSpan("BEAT", 0.4, 2.4),))
    speech = SpeechIntent(said, 0.0, SpeechProfile(liveliness=liveliness))
    tagged = TaggedGestures(human)
    for number in range(3 * RATE):
        behaviour = tagged.add(CharacterCommand(number / RATE, speech=speech)).behaviour
        if behaviour is not None and behaviour.gestures:
            times = behaviour.gestures[0].times
            return times.ready, times.stroke_end
    raise AssertionError("no gesture is asked for")


def test_the_last_apex_of_a_gesture_comes_with_an_accent_that_is_near():
    ready, written = stroke_of_beat(())
    apex = ready + GestureCollection.load_bundled().get("BEAT").apex * (written - ready)
    near, far = (Accent(apex + 0.22 + away, 1.0) for away in (0.2, 0.7))
    assert stroke_of_beat((near,))[1] == pytest.approx(written + 0.2)
    assert stroke_of_beat((far,))[1] == pytest.approx(written)
    assert stroke_of_beat((near,), liveliness=0.0)[1] == pytest.approx(written)
