"""Acts that an experimenter or another program asks for, whatever the scenario decides."""

import numpy as np
import pytest

from cubeling.affect import Emotion
from cubeling.app.pipeline.playground import Playground
from cubeling.app.pipeline.scenario import Inputs
from cubeling.app.pipeline.step import ReplayInputs
from cubeling.app.pipeline.table.acts import ACTION_S, MAX_SAID_CHARS, Act
from cubeling.app.session.encoding import decode, encode
from cubeling.characters import Character, CharacterCommand
from cubeling.tracking import CubeModel, Frame
from tests.bench.keep_clear import drive

BLACK = np.zeros((90, 160, 3), np.uint8)
ANGER = Emotion(-0.7, 0.8, "angry")


@pytest.fixture(scope="module")
def take():
    """A cube that drives a character about."""
    return drive(0, "follow", CubeModel.load("locomotion").edge)


@pytest.fixture
def table(take):
    """Return a function that plays, with acts by the number of their frame."""

    def play(acts, frames, others=(), **inputs):
        playground = Playground("follow", take.intrinsics, others=others)
        for index, state in enumerate(take.states[:frames]):
            asked = Inputs(acts=acts.get(index, ()), **(inputs if index == frames - 1 else {}))
            frame = Frame(BLACK, state.timestamp, index)
            yield playground.step(frame, asked, ReplayInputs(state=state), drawn=False)

    return play


@pytest.mark.slow(reason="four seconds of a person are animated")
def test_an_action_takes_the_place_of_the_scenarios_for_its_time(table):
    steps = list(table({10: (Act("action", "wave", 0.4),)}, 120))
    waving = [step for step in steps if step.command.activity == "wave"]
    assert waving[0] is steps[10]
    assert {step.command.weight for step in waving} == {0.4}
    assert {step.outcome.icon for step in waving} == {"wave"}
    lasted = waving[-1].frame.timestamp - waving[0].frame.timestamp
    assert lasted == pytest.approx(ACTION_S, abs=0.05)
    assert "wave" in {step.posed.state for step in steps}


def test_idle_ends_an_action_and_starting_over_ends_all(table):
    acts = {5: (Act("action", "wave"), Act("emotion", emotion=ANGER)), 8: (Act("action", "idle"),)}
    steps = list(table(acts, 12, clear=True))
    assert [at for at, step in enumerate(steps) if step.command.activity == "wave"] == [5, 6, 7]
    shown = [at for at, step in enumerate(steps) if step.emotion.emotion == ANGER]
    assert shown == [5, 6, 7, 8, 9, 10]


def test_an_emotion_is_shown_by_face_and_robot_until_it_is_let_go(table):
    acts = {3: (Act("emotion", emotion=ANGER),), 6: (Act("emotion"),)}
    steps = list(table(acts, 9))
    assert [step.emotion.emotion == ANGER for step in steps] == [3 <= at < 6 for at in range(9)]
    assert all(step.command.emotion == step.emotion.emotion for step in steps)


def test_a_gesture_is_made_besides_and_moves_the_head(table):
    plain, nodding = (list(table(acts, 40)) for acts in ({}, {5: (Act("gesture", "nod"),)}))
    asked = [at for at, step in enumerate(nodding) if step.command.behaviour is not None]
    assert asked[0] == 5
    assert asked == list(range(5, asked[-1] + 1))
    assert [step.command.activity for step in nodding] == [step.command.activity for step in plain]
    head = Character.load("human").anatomy.joints["head"]
    turned = [
        np.abs(a.posed.pose.rotations - b.posed.pose.rotations)[head].max()
        for a, b in zip(plain, nodding, strict=True)
    ]
    assert max(turned[:5]) == 0.0
    assert max(turned) > 0.03


def test_what_is_said_is_a_reply_and_cuts_off_what_was_being_said(table):
    steps = list(table({4: (Act("say", "Hello."),)}, 6))
    assert [step.outcome.reply is not None for step in steps] == [at == 4 for at in range(6)]
    assert steps[4].outcome.reply.text == "Hello."
    assert steps[4].outcome.hush


def test_an_act_is_for_one_of_the_cast(table):
    vleo = Character.load("vleo")
    steps = list(table({4: (Act("action", "kiss", who="vleo"),)}, 6, others=(vleo,)))
    assert [step.command.activity == "kiss" for step in steps] == [False] * 6
    assert [step.others[0].command.activity for step in steps[4:]] == ["kiss", "kiss"]


@pytest.mark.parametrize(
    ("act", "words"),
    [
        (Act("action", "fly"), "has no action 'fly'; its actions: "),
        (Act("gesture", "nosuch"), "has no gesture 'nosuch'"),
        (Act("say", ""), "1 to 500 characters, not 0"),
        (Act("say", "x" * (MAX_SAID_CHARS + 1)), "not 501"),
        (Act("say", '<begin_gesture id="a"/>Hi'), "nothing is said"),
        (Act("action", "wave", who="nobody"), "nobody in the cast is called 'nobody'"),
        (Act("action", "x" * 1000), "x" * 40 + "'"),
    ],
)
def test_what_nobody_can_do_is_refused_in_one_line(take, act, words):
    cast = Playground("follow", take.intrinsics).cast
    assert words in cast.refusal(act)
    assert "\n" not in cast.refusal(act)


@pytest.mark.parametrize(
    "act",
    [Act("action", "wave"), Act("action", "idle"), Act("gesture", "nod"), Act("say", "Hi."),
     Act("emotion", emotion=ANGER), Act("emotion")],
)  # fmt: skip
def test_what_can_be_done_is_not_refused(take, act):
    assert Playground("follow", take.intrinsics).cast.refusal(act) == ""


@pytest.mark.full
@pytest.mark.slow(reason="two seconds of a person are animated")
def test_after_a_checkpoint_acts_go_on_as_they_did(take):
    """So a player may go back in a recording in which somebody was directed."""
    playground = Playground("follow", take.intrinsics)
    acts = Inputs(acts=(Act("gesture", "nod"), Act("emotion", emotion=ANGER), Act("say", "Hi.")))

    def play(first, last):
        found = []
        for index, state in enumerate(take.states[first:last], first):
            frame = Frame(BLACK, state.timestamp, index)
            asked = acts if index == 4 else Inputs()
            found.append(playground.step(frame, asked, ReplayInputs(state=state), drawn=False))
        return found

    play(0, 8)
    checkpoint = playground.checkpoint()
    once = play(8, 30)
    playground.restore(checkpoint)
    for before, after in zip(once, play(8, 30), strict=True):
        assert encode(before.command) == encode(after.command)
        assert encode(before.posed) == encode(after.posed)
    assert any(step.command.behaviour is not None for step in once)
    assert decode(CharacterCommand, encode(once[0].command)).emotion == ANGER
