"""What a face shows while an action shows an emotion by its clips."""

import numpy as np
import pytest

from cubeling.affect import Emotion
from cubeling.affect.words import WORD_PLACES
from cubeling.characters import ActionIntent, Animator, Character, CharacterCommand


def face(action, word):
    """The morphs of the robot by name, after two seconds of an action with an emotion."""
    robot = Character.load("robot")
    animator = Animator(robot)
    for frame in range(120):
        posed = animator.update(
            CharacterCommand(
                frame / 60,
                action=ActionIntent(action, 0.0),
                emotion=Emotion(*WORD_PLACES[word], word),
                gaze=np.array([0.0, 0.1, 1.0]),
            )
        )
    assert posed.pose.morphs is not None
    return dict(zip(robot.morphs, posed.pose.morphs, strict=True))


def test_an_action_of_an_emotion_has_the_face_of_its_clips():
    shown = face("angry", "angry")
    assert max(shown[name] for name in ("happy", "angry", "sad", "surprised")) < 0.05


@pytest.mark.parametrize(("action", "word", "morph"), [("angry", "afraid", "surprised")])
def test_a_finer_emotion_of_the_same_mood_has_its_own_face(action, word, morph):
    assert face(action, word)[morph] > 0.3


def test_another_mood_does_not_show_on_an_action():
    assert face("angry", "happy")["happy"] < 0.05
