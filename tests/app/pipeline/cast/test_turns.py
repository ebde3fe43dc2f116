"""Turn-taking: one of a cast speaks at a time."""

import math

import numpy as np
import pytest
from hypothesis import given, strategies as st

from cubeling.app.pipeline.cast.turns import MAX_WAIT_S, PAUSE_S, Turns
from cubeling.app.pipeline.table.attention import Attention, Company
from cubeling.app.pipeline.table.spoken_line import SpokenLine
from cubeling.characters import CharacterCommand, LocomotionIntent
from cubeling.characters.speech import Utterance
from tests.app.pipeline.cast.test_cast import state_and_controls

FRAME_S = 1 / 30


def line(text, seconds=1.0):
    return SpokenLine(Utterance(text, "en", seconds), np.zeros(1, np.float32), 16000)


def talk(led, wishes, seconds=8.0):
    """Return (time, text) of what begins, and (time, number) of who is interrupted.

    `wishes` are (time, number, text, duration).
    """
    turns, ends = Turns(led), [-math.inf] * len(led)
    begun, broken = [], []
    left = sorted(wishes, key=lambda wish: wish[0])
    for frame in range(round(seconds / FRAME_S)):
        now, lines = frame * FRAME_S, [None] * len(led)
        while left and left[0][0] <= now:
            _, number, text, duration = left.pop(0)
            lines[number] = line(text, duration)
        turn = turns.update(now, lines, ends)
        for number in turn.interrupted:
            ends[number] = -math.inf
            broken.append((now, number))
        if turn.begins is not None and turn.line is not None:
            begun.append((now, turn.line.utterance.text))
            ends[turn.begins] = now + turn.line.utterance.duration
        assert sum(now < end for end in ends) <= 1, "one speaks at a time"
    return begun, broken


def test_one_character_alone_speaks_at_once_and_breaks_itself_off():
    begun, broken = talk([True], [(0.0, 0, "one", 5.0), (1.0, 0, "two", 1.0)])
    assert begun == [(0.0, "one"), (1.0, "two")]
    assert not broken


def test_who_watches_waits_for_the_end_and_a_pause():
    begun, broken = talk([True, False], [(0.0, 0, "one", 2.0), (1.0, 1, "two", 1.0)])
    assert [text for _, text in begun] == ["one", "two"]
    assert begun[1][0] == pytest.approx(2.0 + PAUSE_S, abs=FRAME_S)
    assert not broken


def test_who_has_waited_for_too_long_gives_up():
    assert talk([True, False], [(0.0, 0, "one", 6.0), (1.0, 1, "two", 1.0)])[0] == [(0.0, "one")]
    late = 6.0 - MAX_WAIT_S + 2 * PAUSE_S
    assert len(talk([True, False], [(0.0, 0, "one", 6.0), (late, 1, "two", 1.0)])[0]) == 2


def test_a_character_that_a_cube_leads_takes_the_turn_from_one_that_watches():
    begun, broken = talk([True, False], [(0.0, 1, "one", 3.0), (1.0, 0, "two", 1.0)])
    assert begun == [(0.0, "one"), (1.0, "two")]
    assert broken == [(1.0, 1)]


def test_two_that_are_led_do_not_break_each_other_off():
    begun, broken = talk([True, True], [(0.0, 1, "one", 2.0), (1.0, 0, "two", 1.0)])
    assert [round(time, 1) for time, _ in begun] == [0.0, 2.3]
    assert not broken


def test_the_lead_comes_first_then_who_has_waited_longest():
    wishes = [(0.0, 0, "one", 1.0), (0.2, 2, "b", 0.5), (0.4, 1, "a", 0.5), (0.6, 0, "two", 0.5)]
    assert [text for _, text in talk([True, False, False], wishes)[0]] == ["one", "two", "b", "a"]


@given(
    st.lists(st.booleans(), min_size=2, max_size=5),
    st.lists(
        st.tuples(st.floats(0.0, 6.0), st.integers(0, 1), st.just("text"), st.floats(0.05, 3.0)),
        max_size=12,
    ),
)
def test_nobody_speaks_while_another_does(led, wishes):
    talk(led, wishes)  # which checks it in every frame


def test_who_waits_looks_at_the_speaker_even_on_its_way(hand):
    attention, mouth = Attention("auto", 0.06), np.array([0.2, 0.1, 0.0])
    state, controls = state_and_controls(hand)
    goes = CharacterCommand(controls.timestamp, locomotion=LocomotionIntent(2.0, np.zeros(2)))
    assert goes.activity == "move"
    looked = [
        attention.update(state, controls, goes, Company((mouth,), mouth, waits=waits)) is mouth
        for waits in (False, True)
    ]
    assert looked == [False, True]
