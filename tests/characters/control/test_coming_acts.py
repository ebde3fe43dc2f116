"""A shift of the weight ends before an act that is told ahead."""

import numpy as np
import pytest

from cubeling.characters import ActionIntent, Animator, CharacterCommand, ComingAct
from cubeling.characters.control.command import SpeechIntent
from cubeling.characters.speech.speech import GestureSpan, Utterance
from tests.bench.coming_acts import MAX_SHARE, Stander
from tests.bundled_characters import bundled_character


def shifting(stander):
    """Let a character begin to shift its weight, and return a copy of it."""
    stander.play(0.5)
    stander.standing.talk(shift=True)
    stander.play(0.2)
    return stander.copies()


@pytest.mark.slow("a body stands for some dozen seconds")
def test_a_shift_is_led_to_the_first_posture_of_an_act():
    stander = Stander(bundled_character("human"))
    kept = shifting(stander)
    away = {}
    for told in (True, False):
        stander.restore(kept)
        away[told] = stander.before("nod", told=told)
    assert away[True] < MAX_SHARE * away[False]


@pytest.mark.slow("a body stands for some dozen seconds")
def test_it_shifts_again_after_an_act_and_when_none_comes():
    stander = Stander(bundled_character("human"))
    stander.play(2.0, ComingAct(1.0))  # it never comes
    assert stander.way(stander.play(20.0)).sum() > 0.02


@pytest.mark.slow("a body stands and speaks for some dozen seconds")
def test_before_a_tagged_gesture_the_weight_comes_to_rest():
    stander = Stander(bundled_character("human"))
    kept = shifting(stander)
    ways = {}
    for tagged in (True, False):
        stander.restore(kept)
        begin = kept[1]
        spans = (GestureSpan("point_self", 1.0, 2.0),) if tagged else ()
        said = SpeechIntent(Utterance("I am here", "en", 3.0, gestures=spans), begin)
        stander.play(0.9, speech=said)
        ways[tagged] = stander.way(stander.play(0.3, speech=said)).sum()
    assert ways[True] < 0.2 * ways[False]


def test_what_comes_too_soon_is_no_leap():
    stander = Stander(bundled_character("human"))
    kept = shifting(stander)
    recorded = stander.way(stander.play(0.5)).max()
    stander.restore(kept)
    hurried = stander.way(stander.play(0.5, ComingAct(kept[1] + 0.04, "nod"))).max()
    assert hurried < 3.0 * recorded


def test_an_animator_takes_an_action_that_it_does_not_know_as_any_act():
    animator = Animator(bundled_character("human"))
    for number in range(30):
        now = number / 30
        animator.update(
            CharacterCommand(now, action=ActionIntent("idle"), coming=ComingAct(1.0, "moonwalk"))
        )
    assert np.isfinite(animator.update(CharacterCommand(1.0)).pose.rotations).all()
