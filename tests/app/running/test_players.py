"""What a character's actions become on the network."""

import pytest

from cubeling.app.running.network.connection import Network
from cubeling.app.running.network.players import WEIGHT_RESTS_S, PlayerPublisher
from cubeling.characters import ActionIntent, CharacterCommand
from cubeling.robot.network import Credentials


@pytest.fixture
def player(monkeypatch):
    """A player, and the actions that it has published: names and weights."""
    published = []
    with Network(None, "home", Credentials(None, None, None)) as network:
        publisher = PlayerPublisher(network, "ann")
        act = publisher.client.endpoint.act

        def note(name, weight, now):
            published.append((name, weight))
            act(name, weight, now)

        monkeypatch.setattr(publisher.client.endpoint, "act", note)
        yield publisher, published


def turn(publisher, weights, start=0.0, action="kiss", visible=True):
    """Publish a command for each weight, at 30 Hz; return when the last one was [s]."""
    for index, weight in enumerate(weights):
        publisher.publish_action(
            CharacterCommand(
                start + index / 30, action=ActionIntent(action, weight), visible=visible
            )
        )
    return start + len(weights) / 30


def test_an_action_is_sent_again_when_the_knob_was_turned_and_rests(player):
    publisher, published = player
    now = turn(publisher, [0.0] * 30)
    now = turn(publisher, [index / 60 for index in range(60)], now)
    assert published == [("kiss", 0.0)], "the knob still turns"
    now = turn(publisher, [1.0] * (round(30 * WEIGHT_RESTS_S) + 2), now)
    assert published == [("kiss", 0.0), ("kiss", 1.0)]
    turn(publisher, [1.0] * 300, now)
    assert len(published) == 2, "a knob that rests sends nothing"


def test_a_small_change_is_not_sent(player):
    publisher, published = player
    turn(publisher, [0.0] * 10 + [0.1] * 60)
    assert published == [("kiss", 0.0)]


def test_an_idle_or_hidden_character_sends_nothing(player):
    publisher, published = player
    turn(publisher, [0.0] * 5 + [1.0] * 60, action="idle")
    turn(publisher, [0.0] * 5 + [1.0] * 60, 3.0, visible=False)
    assert published == []
