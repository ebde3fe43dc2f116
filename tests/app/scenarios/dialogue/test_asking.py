"""A language model that is asked where the script has no answer of its own."""

import pytest

from cubeling.app.pipeline.scenario import ModelAnswer
from cubeling.app.scenarios.dialogue.asking import FILLERS, LOOK_ASIDE_S, MAX_THINK_S
from cubeling.app.scenarios.dialogue.scenario import TYPING_S
from tests.app.scenarios.dialogue.test_talk import Conversation

VAGUE = "why is the sky blue"
BLUE = "Because the air scatters blue light."


@pytest.fixture
def talk(hand):
    conversation = Conversation(hand, asks_model=True)
    conversation.until_spoken()
    conversation.wait(6.0)
    return conversation


def ask(talk, text=VAGUE):
    question = talk.frame(typed=text).question
    assert question is not None
    assert question.text == text
    return question


def test_only_what_the_script_has_no_answer_to_is_asked(talk, hand):
    for known in ("tell me a joke", "my name is Lucy", "how old are you", "kiss"):
        assert talk.frame(typed=known).question is None
        talk.wait(6.0)
    ask(talk)
    ask(talk, "xyzzy plugh")
    assert Conversation(hand).frame(typed=VAGUE).question is None


def test_an_answer_is_said_and_remembered_as_heard(talk):
    question = ask(talk)
    talk.frame(answer=ModelAnswer(question.number, BLUE))
    assert talk.replies[-1] == BLUE
    talk.wait(6.0)
    assert talk.profile["said"] == BLUE


def test_a_filler_and_a_look_aside_come_within_a_second(talk):
    ask(talk)
    asked, before, aside = talk.now, len(talk.replies), []
    for _ in range(round(30 * 4.0)):
        if talk.frame().thinks:
            aside.append(talk.now - asked)
        if len(talk.replies) > before:
            assert talk.now - asked < 1.0 - 0.2  # the voice takes up to 0.2 s
            before = 10**6
    assert before == 10**6
    assert talk.replies[-1] in FILLERS["en"]
    assert aside[0] < 1.0
    assert aside[-1] - aside[0] == pytest.approx(LOOK_ASIDE_S, abs=0.1)


def test_an_answer_that_comes_meanwhile_follows_the_filler(talk):
    question = ask(talk)
    talk.wait(0.9)
    talk.frame(answer=ModelAnswer(question.number, BLUE))
    assert talk.replies[-1] in FILLERS["en"], "it is said to its end"
    talk.wait(3.0)
    assert talk.replies[-1] == BLUE


def test_an_answer_waits_for_who_is_typing(talk):
    question = ask(talk)
    talk.frame(hush=True)
    talk.frame(answer=ModelAnswer(question.number, BLUE))
    talk.wait(2.0)
    assert talk.replies[-1] != BLUE
    talk.wait(TYPING_S)
    assert talk.replies[-1] == BLUE


@pytest.mark.parametrize("failed", [True, False])
def test_without_an_answer_the_script_answers(talk, failed):
    question = ask(talk)
    asked, before = talk.now, len(talk.replies)
    if failed:
        talk.frame(answer=ModelAnswer(question.number, ""))
    else:
        talk.wait(MAX_THINK_S + 0.5)
    assert len(talk.replies) == before + (1 if failed else 2)
    assert talk.replies[-1] not in FILLERS["en"]
    assert talk.now - asked < MAX_THINK_S + 1.0
    talk.frame(answer=ModelAnswer(question.number, BLUE))
    assert talk.replies[-1] != BLUE, "it comes too late"


def test_who_says_something_else_does_not_wait(talk):
    first = ask(talk)
    talk.frame(typed="tell me a joke")
    joke = talk.replies[-1]
    talk.frame(answer=ModelAnswer(first.number, BLUE))
    talk.wait(1.5)
    assert talk.replies[-1] == joke
    second = ask(talk)
    talk.frame(answer=ModelAnswer(first.number, BLUE))
    assert talk.replies[-1] == joke, "it answers another question"
    talk.frame(answer=ModelAnswer(second.number, BLUE))
    assert talk.replies[-1] == BLUE
