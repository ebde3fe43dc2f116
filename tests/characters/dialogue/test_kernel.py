"""The verify list of S16, and what the kernel promises beyond it."""

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from cubeling.app.pipeline.checkpoint import Checkpoint
from cubeling.characters.dialogue.kernel import MAX_STEPS, Dialogue, heard_of
from cubeling.characters.dialogue.vocabulary import MAX_LINE_CHARS
from cubeling.characters.speech.speech import Utterance, Word
from tests.characters.dialogue.scripts import dialogue, said, unit

CYCLIC = {"cyclic": "yes"}

HELLO = "hello *"


def test_the_greater_priority_always_wins(tmp_path: Path) -> None:
    for seed in range(40):
        talk = dialogue(
            tmp_path,
            unit("low", HELLO, "low", priority="1", **CYCLIC)
            + unit("high", HELLO, "high", priority="2", **CYCLIC)
            + unit("none", HELLO, "none", **CYCLIC),
            seed=seed,
        )
        assert said(talk, "Hello, you!") == "high"


def test_equal_priorities_are_chosen_equally_often(tmp_path: Path) -> None:
    names, draws = "abcd", 1200
    texts = {name: f"<text>say {name}</text><text>tell {name}</text>" for name in names}
    units = "".join(unit(name, HELLO, texts[name], **CYCLIC) for name in names)
    talk = dialogue(tmp_path, units, seed=5)
    counts = np.zeros(len(names))
    for number in range(draws):
        answer = said(talk, "hello", float(number))
        counts[names.index(answer[-1])] += 1
    expected = draws / len(names)
    chi_squared = float(((counts - expected) ** 2 / expected).sum())
    assert chi_squared < 11.34, counts  # of 3 degrees of freedom, at 1 %


def test_the_transitions_of_a_unit_are_chosen_equally_often(tmp_path: Path) -> None:
    steps = "".join(
        f'<transition><condition type="input_match">go</condition>'
        f'<action type="say">way {number}</action></transition>'
        for number in range(3)
    )
    talk = dialogue(tmp_path, f'<unit name="u"><state name="q">{steps}</state></unit>', seed=2)
    counts = np.zeros(3)
    for number in range(900):
        answer = said(talk, "go", float(number))
        counts[int(answer[-1])] += 1
    assert float(((counts - 300) ** 2 / 300).sum()) < 9.21, counts  # 2 degrees of freedom, 1 %


ASKING = """
<unit name="asking" strong="yes" cyclic="yes"><state name="q0">
  <transition to="q1"><condition type="input_match">ask me</condition>
    <action type="say">Cats or dogs?</action></transition></state>
  <state name="q1"><transition to="q2"><condition type="input_match">cats | dogs</condition>
    <action type="say">Me too!</action></transition></state>
  <state name="q2" accepting="yes"/></unit>
"""


def test_a_strong_unit_keeps_the_floor_and_releases_it_when_stuck(tmp_path: Path) -> None:
    talk = dialogue(
        tmp_path, ASKING + unit("louder", "cats | fish", "I am louder", priority="9", **CYCLIC)
    )
    assert said(talk, "ask me") == "Cats or dogs?"
    assert said(talk, "fish", 1.0) == "I am louder", "it is stuck at this"
    assert said(talk, "ask me", 2.0) == "", "it still waits for its answer"
    talk = dialogue(
        tmp_path, ASKING + unit("louder", "cats | fish", "I am louder", priority="9", **CYCLIC)
    )
    said(talk, "ask me")
    assert said(talk, "cats", 1.0) == "Me too!", "although a greater priority matches"
    assert said(talk, "cats", 2.0) == "I am louder", "it is at its start again"


def test_a_cyclic_unit_answers_again_and_another_once(tmp_path: Path) -> None:
    again = dialogue(tmp_path, unit("u", HELLO, "Hi!</action><action type='say'>You!", **CYCLIC))
    once = dialogue(tmp_path, unit("u", HELLO, "Hi!"))
    assert [said(again, "hello", float(now)) for now in range(3)].count("") == 0
    assert [said(once, "hello", float(now)) for now in range(3)] == ["Hi!", "", ""]


def test_an_emotion_changes_the_answer(tmp_path: Path) -> None:
    def answer(kind: str, text: str) -> str:
        return (
            '<transition><condition type="input_match">how are you</condition>'
            f'<condition type="{kind}"><emotion>fear</emotion><value>0.3</value></condition>'
            f'<action type="say">{text}</action></transition>'
        )

    talk = dialogue(
        tmp_path,
        '<unit name="u"><state name="q">'
        + answer("above_threshold", "I am afraid.")
        + answer("below_threshold", "I am fine.")
        + "</state></unit>",
    )
    assert said(talk, "How are you?", 0.0, feelings={"fear": 0.5}) == "I am afraid."
    assert said(talk, "How are you?", 1.0, feelings={"fear": 0.1, "hate": 0.9}) == "I am fine."
    assert said(talk, "How are you?", 2.0) == "I am fine."


def test_egges_example_is_read_as_published(tmp_path: Path) -> None:
    talk = dialogue(
        tmp_path,
        """<unit name="u"><state name="q0"><transition to="q1">
        <condition type="input_match">hello my name is *</condition>
        <action type="emotional_influence"><emotion>hate</emotion><value>0.6</value></action>
        <action type="say"><begin_gesture id="g1" anim="shake_head"/>Unfortunately, I have
        <begin_gesture id="g2" anim="raise_shoulders"/>no idea <end_gesture id="g2"/>
        what you are talking about.<end_gesture id="g1"/></action></transition></state>
        <state name="q1" accepting="yes"/></unit>""",
    )
    talk.hear("Hello. My name is Creon!")
    turn = talk.update(0.0)
    assert turn is not None
    assert turn.influences == (("hate", 0.6),)
    assert turn.text == (
        '<begin_gesture id="g1" anim="shake_head"/>Unfortunately, I have '
        '<begin_gesture id="g2" anim="raise_shoulders"/>no idea <end_gesture id="g2"/> what you '
        'are talking about.<end_gesture id="g1"/>'
    )


def test_lambda_steps_follow_in_one_turn_and_are_bounded(tmp_path: Path) -> None:
    chain = "".join(
        f'<state name="s{n}"><transition to="s{n + 1}"><action type="say">{n}</action>'
        "</transition></state>"
        for n in range(40)
    )
    talk = dialogue(tmp_path, f'<unit name="u">{chain}<state name="s40" accepting="yes"/></unit>')
    turns = [talk.update(0.1 * number) for number in range(1, 5)]
    lengths = [0 if turn is None else len(turn.text.split()) for turn in turns]
    assert lengths == [MAX_STEPS, MAX_STEPS, 40 - 2 * MAX_STEPS, 0]


def test_silence_is_waited_for_and_speech_puts_it_off(tmp_path: Path) -> None:
    talk = dialogue(
        tmp_path,
        '<unit name="u"><state name="q"><transition><condition type="silence">2</condition>'
        '<action type="say">Hm.</action><action type="say">So?</action></transition></state>'
        "</unit>",
    )
    times = [
        0.1 * step
        for step in range(100)
        if talk.update(0.1 * step, busy=2.0 <= 0.1 * step < 4.0) is not None
    ]
    assert times == pytest.approx([5.95, 7.95, 9.95], abs=0.11)


def test_a_question_that_was_passed_over_is_forgotten(tmp_path: Path) -> None:
    back = (
        '<transition to="q0"><condition type="passed_over"/></transition></state><state name="q2"'
    )
    talk = dialogue(
        tmp_path,
        ASKING.replace('</state>\n  <state name="q2"', f"{back}")
        + unit("other", "fish", "Fish!", **CYCLIC),
    )
    said(talk, "ask me")
    assert said(talk, "fish", 1.0) == "Fish!"
    assert said(talk, "cats", 2.0) == "", "it is no answer any more"
    assert said(talk, "ask me", 3.0) == "Cats or dogs?"


def test_a_text_is_never_said_three_times_running(tmp_path: Path) -> None:
    talk = dialogue(
        tmp_path,
        unit("only", HELLO, "Hello!", priority="3", **CYCLIC)
        + unit("other", HELLO, "You said that.", **CYCLIC),
    )
    answers = [said(talk, "hello", float(now)) for now in range(9)]
    assert "" not in answers
    assert not any(a == b == c for a, b, c in zip(answers, answers[1:], answers[2:], strict=False))


def test_a_reply_that_repeats_itself_does_not_grow_for_ever(tmp_path: Path) -> None:
    texts = "<text>I said: {said}</text><text>Once more: {said}</text>"
    talk = dialogue(tmp_path, unit("u", "again", texts, **CYCLIC))
    talk.remember_said("Hello. " * 100)
    assert len(talk.state.profile["said"]) <= MAX_LINE_CHARS
    talk.remember_said("Hello.")
    for number in range(100):
        reply = said(talk, "again", float(number))
        assert reply in ("I said: Hello.", "Once more: Hello.")
        talk.remember_said(reply)


def test_actions_of_one_line_may_have_different_numbers_of_texts(tmp_path: Path) -> None:
    three, one = "".join(f"<text>{n} times</text>" for n in range(3)), "<text>Oh!</text>"
    both = f'{three}</action><action type="say">{one}'
    talk = dialogue(tmp_path, unit("u", HELLO, both, **CYCLIC))
    for number in range(30):
        assert said(talk, "hello", float(number)).endswith("times Oh!")


def test_every_text_comes_before_one_comes_again(tmp_path: Path) -> None:
    texts = "".join(f"<text>{number} times</text>" for number in range(5))
    talk = dialogue(tmp_path, unit("u", HELLO, texts, **CYCLIC), seed=3)
    answers = [said(talk, "hello", float(now)) for now in range(20)]
    for begin in range(0, 20, 5):
        assert len(set(answers[begin : begin + 5])) == 5
    assert all(a != b for a, b in pairwise(answers))


def test_what_is_typed_wrong_or_in_another_language_is_understood(tmp_path: Path) -> None:
    talk = dialogue(
        tmp_path,
        """<unit name="u"><state name="q"><transition><condition type="input_match">
        <text lang="en">* my favourite dinosaur is {pet} *</text>
        <text lang="es">* mi dinosaurio favorito es el {pet} *</text></condition>
        <action type="say"><text lang="en">A {pet}!</text><text lang="es">¡Un {pet}!</text>
        </action></transition></state></unit>""",
        languages="en es",
    )
    assert said(talk, "Well, my favorite dinosuar is Triceratops!") == "A Triceratops!"
    assert said(talk, "mi dinosauro favorito es el diplodocus", 1.0) == "¡Un diplodocus!"
    assert talk.state.language == "es"
    assert said(talk, "xyzzy plugh", 2.0) == ""
    assert talk.state.language == "es", "nonsense is no other language"


def test_words_of_the_cube_are_answered_only_by_name(tmp_path: Path) -> None:
    any_text = "<text>Pardon?</text><text>What?</text>"
    talk = dialogue(
        tmp_path,
        unit("all", "*", any_text, **CYCLIC)
        + unit("shaken", "the cube was shaken", "Whoa!", **CYCLIC),
    )
    for text, answered in (("the cube was shaken", "Whoa!"), ("face up: heart", "")):
        talk.hear(text, typed=False)
        turn = talk.update(0.0)
        assert (turn.text if turn else "") == answered
    assert said(talk, "face up: heart", 1.0) in ("Pardon?", "What?")


def test_a_checkpoint_goes_on_as_the_dialogue_does(tmp_path: Path) -> None:
    texts = "".join(f"<text>{number} times</text>" for number in range(9))
    talk = dialogue(tmp_path, ASKING + unit("u", HELLO, texts, **CYCLIC), seed=1)
    asked = ["hello", "ask me", "hello", "cats", "hello", "hello"]
    for number, text in enumerate(asked):
        said(talk, text, float(number))
    saved = Checkpoint({"talk": talk})
    first = [said(talk, text, 10.0 + n) for n, text in enumerate(asked)]
    copies = [saved.content()["talk"] for _ in range(2)]
    for copy in copies:
        assert isinstance(copy, Dialogue)
        assert copy.script is talk.script, "what is frozen is shared"
        assert [said(copy, text, 10.0 + n) for n, text in enumerate(asked)] == first


def test_what_was_heard_ends_where_it_was_cut_off() -> None:
    words = tuple(
        Word(text, start, start + 0.3, offset)
        for text, start, offset in (("Dinosaurs", 0.1, 0), ("were", 0.6, 10), ("big", 1.0, 15))
    )
    said = Utterance("Dinosaurs were big!", "en", 1.5, words)
    assert [heard_of(said, at) for at in (0.0, 0.2, 0.7, 1.2, 2.0)] == [
        "",
        "Dinosaurs…",
        "Dinosaurs were…",
        "Dinosaurs were big!",
        "Dinosaurs were big!",
    ]
