import numpy as np

from app.pipeline.scenario import Inputs
from app.scenarios import Follow
from app.scenarios.follow import TREATS
from characters import Animator, Character


class Play:
    """A human that follows a hand."""

    def __init__(self, hand):
        self.hand, self.follow = hand, Follow()
        self.animator, self.posed = Animator(Character.load("human")), None

    def on(self, seconds, **first):
        """Let some time pass and return what was asked for and what was done."""
        asked, done = [], []
        for number in range(round(seconds * 30)):
            controls = self.hand.frame(**(first if number == 0 else {}))
            inputs = Inputs(actions=self.animator.actions)
            command = self.follow.update(controls, self.posed, inputs).command
            self.posed = self.animator.update(command)
            asked.append(command.activity)
            done.append(self.posed.state)
        return asked, done


def test_a_shaken_cube_is_answered_with_one_thing_after_the_other(hand):
    play = Play(hand)
    play.on(0.2)
    for treat in (*TREATS, TREATS[0]):
        asked, done = play.on(4.0, shaken=True)
        assert treat in done
        assert set(done) <= {treat, "idle"}
        assert asked[-1] == "idle"


def test_a_second_shake_meanwhile_changes_nothing(hand):
    play = Play(hand)
    play.on(0.5, shaken=True)
    asked, _ = play.on(0.5, shaken=True)
    assert set(asked) == {TREATS[0]}


def test_a_character_that_knows_no_such_thing_goes_on(hand):
    follow = Follow()
    outcome = follow.update(hand.frame(shaken=True), None, Inputs(actions=("kiss",)))
    assert outcome.command.activity == "idle"
    turned = hand.frame(shaken=True, camera_angle=np.pi / 2)
    for _ in range(30):
        outcome = follow.update(turned, None, Inputs())
        turned = hand.frame()
    assert outcome.command.activity == "move"
