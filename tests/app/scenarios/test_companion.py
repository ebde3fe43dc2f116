"""The companion scenario, by the rules of the thesis (M11)."""

import pytest

from cubeling.app.pipeline.scenario import Inputs
from cubeling.app.pipeline.table.situation import Situation
from cubeling.app.scenarios import make_scenario
from cubeling.characters import Animator, Character, CharacterCommand
from cubeling.tracking import CubeModel


@pytest.fixture
def companion():
    return make_scenario("companion")


def play(companion, frames):
    outcome = None
    for controls in frames:
        outcome = companion.update(controls, Situation(), Inputs())
    assert outcome is not None
    return outcome


def test_a_newly_placed_face_starts_in_the_middle(companion, hand):
    play(companion, [hand.frame(), *hand.tip("front"), *hand.turn(0.8, 1)])
    outcome = play(companion, hand.tip("right"))
    assert outcome.command.activity == "shout"
    assert outcome.command.weight == 0.0


def test_two_turns_lead_from_one_end_to_the_other(companion, hand):
    low = play(companion, [hand.frame(), *hand.tip("front"), *hand.turn(-1, 2)])
    assert low.command.weight == pytest.approx(-1.0)
    half = play(companion, hand.turn(1, 2))
    assert half.command.weight == pytest.approx(0.0, abs=1e-9)
    high = play(companion, hand.turn(1, 2))
    assert high.command.weight == pytest.approx(1.0)


def test_intensity_saturates_and_turning_back_works_at_once(companion, hand):
    play(companion, [hand.frame(), *hand.tip("front"), *hand.turn(3.5, 4)])
    outcome = play(companion, hand.turn(-0.25, 1))
    assert outcome.command.weight == pytest.approx(0.75)


def test_the_turns_from_end_to_end_can_be_chosen(hand):
    companion = make_scenario("companion", turns=1.0)
    outcome = play(companion, [hand.frame(), *hand.tip("front"), *hand.turn(0.25, 1)])
    assert outcome.command.weight == pytest.approx(0.5)


def test_the_action_changes_only_when_the_cube_rests_again(companion, hand):
    play(companion, [hand.frame()])
    frames = hand.tip("front")
    for controls in frames[:-1]:
        assert companion.update(controls, Situation(), Inputs()).command.activity == "idle"
    assert companion.update(frames[-1], Situation(), Inputs()).command.activity == "kiss"


def test_kisses_lead_from_angry_over_neutral_to_happy_and_shouts_back(companion, hand):
    labels: list[str] = []

    def record(frames):
        for controls in frames:
            label = companion.update(controls, Situation(), Inputs()).emotion.emotion.label
            if not labels or labels[-1] != label:
                labels.append(label)

    record([hand.frame(), *hand.tip("front"), *hand.turn(1, 1), *hand.wait(8)])
    record([*hand.tip("left"), *hand.turn(1, 1), *hand.wait(20)])
    record([*hand.tip("back"), *hand.turn(1, 1), *hand.wait(20)])
    assert labels == ["neutral", "happy", "neutral", "angry", "neutral", "happy"]


def test_idle_and_a_hidden_cube_leave_the_mood(companion, hand):
    play(companion, [hand.frame(), *hand.tip("front"), *hand.wait(3)])
    before = play(companion, hand.tip("top")).emotion.emotion
    assert play(companion, hand.wait(10)).emotion.emotion == before
    before = play(companion, hand.tip("front")).emotion.emotion
    play(companion, [hand.frame(visible=False) for _ in range(19)])  # it may act for 0.6 s more
    hidden = play(companion, [hand.frame(visible=False) for _ in range(3)]).emotion.emotion
    later = play(companion, [hand.frame(visible=False) for _ in range(200)])
    assert later.emotion.emotion == hidden
    assert not later.command.visible


def test_full_intensity_makes_a_neutral_robot_happy_in_about_three_seconds(companion, hand):
    play(companion, [hand.frame(), *hand.tip("front"), *hand.turn(-1, 1)])
    assert play(companion, hand.wait(30)).emotion.emotion.label == "neutral"
    before = play(companion, hand.turn(2, 0.1)).emotion.emotion.valence
    needed = (0.33 - before) / 0.1
    assert play(companion, hand.wait(needed - 0.2)).emotion.emotion.label == "neutral"
    assert play(companion, hand.wait(0.4)).emotion.emotion.label == "happy"


def test_a_face_without_an_action_role_is_idle(hand):
    companion = make_scenario("companion", CubeModel.load("locomotion"))
    outcome = play(companion, [hand.frame(), *hand.tip("left"), *hand.turn(0.5, 1)])
    assert outcome.command.activity == "idle"


@pytest.mark.parametrize(
    ("known", "done"), [(("wave", "cheer", "shake"), "shake"), (("wave",), "idle"), ((), "idle")]
)
def test_who_cannot_shout_does_something_like_it_and_feels_the_same(companion, hand, known, done):
    play(companion, [hand.frame(), *hand.tip("front")])
    character = Character.load("human")
    posed = Animator(character).update(CharacterCommand(0.0))
    outcome = play(companion, hand.tip("right"))
    seen = Situation(posed, actions=known)
    other = companion.update(hand.frame(), seen, Inputs())
    assert outcome.command.activity == "shout"
    assert other.command.activity == done
    assert other.icon == "shout"
