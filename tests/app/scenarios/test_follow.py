"""The follow scenario: what a shaken cube makes the character do."""

import numpy as np

from cubeling.app.pipeline.scenario import Inputs
from cubeling.app.pipeline.table.situation import Situation
from cubeling.app.scenarios import make_scenario
from cubeling.app.scenarios.shake_reaction import SHAKE_ACTIONS
from cubeling.characters import Animator, Character


class Play:
    """A human character that follows the cube in a hand."""

    def __init__(self, hand):
        self.hand, self.follow = hand, make_scenario("follow")
        self.animator, self.posed = Animator(Character.load("human")), None

    def on(self, seconds, **first):
        """Play for some seconds; return the requested activities and the character's states."""
        asked, done = [], []
        for number in range(round(seconds * 30)):
            controls = self.hand.frame(**(first if number == 0 else {}))
            situation = Situation(self.posed, actions=self.animator.actions)
            command = self.follow.update(controls, situation, Inputs()).command
            self.posed = self.animator.update(command)
            asked.append(command.activity)
            done.append(self.posed.state)
        return asked, done


def test_each_shake_starts_the_next_action(hand):
    play = Play(hand)
    play.on(0.2)
    for action in (*SHAKE_ACTIONS, SHAKE_ACTIONS[0]):
        asked, done = play.on(4.0, gestures=("shaken",))
        assert action in done
        assert set(done) <= {action, "idle"}
        assert asked[-1] == "idle"


def test_a_shake_during_an_action_changes_nothing(hand):
    play = Play(hand)
    play.on(0.5, gestures=("shaken",))
    asked, _ = play.on(0.5, gestures=("shaken",))
    assert set(asked) == {SHAKE_ACTIONS[0]}


def test_a_character_without_these_actions_ignores_a_shake(hand):
    follow = make_scenario("follow")
    outcome = follow.update(
        hand.frame(gestures=("shaken",)), Situation(actions=("kiss",)), Inputs()
    )
    assert outcome.command.activity == "idle"
    turned = hand.frame(gestures=("shaken",), camera_angle=np.pi / 2)
    for _ in range(30):
        outcome = follow.update(turned, Situation(), Inputs())
        turned = hand.frame()
    assert outcome.command.activity == "move"
