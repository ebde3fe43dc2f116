"""Which player a robot shows, and what it does when that player is gone."""

import pytest

from cubeling.affect import Emotion
from cubeling.robot.errors import RobotError
from cubeling.robot.network import Member, Pattern, RobotNode
from cubeling.robot.network.arbiter import HOLD_S, MAX_PLAYERS
from cubeling.robot.network.endpoint import LOST_AFTER_S
from cubeling.robot.network.followers import MAX_ROBOTS
from cubeling.robot.network.messages import (
    ActionMessage,
    EmotionMessage,
    StateMessage,
    StatusMessage,
    decode,
    encode,
)
from tests.robot.network.conftest import FakeRobot

HAPPY = Emotion(0.8, 0.5, "happy")
ANGRY = Emotion(-0.8, 0.5, "angry")
NEUTRAL = Emotion(0.0, 0.0, "neutral")


def test_an_action_makes_its_player_active(network):
    ann, bob = network.player("a"), network.player("b")
    network.node("rex")
    ann.feel(HAPPY)
    network.run(0.5)
    bob.feel(ANGRY)
    network.run(0.5)
    shown = network.robots["rex"].shown
    assert shown[-1] == HAPPY  # a mere emotion takes nobody's robot
    network.act("b")
    network.run(0.5)
    assert shown[-1] == ANGRY
    ann.feel(Emotion(0.9, 0.5))
    network.run(0.5)
    assert shown[-1] == ANGRY
    network.act("a")
    network.run(0.5)
    assert shown[-1] == Emotion(0.9, 0.5)


@pytest.mark.parametrize("end", ["goodbye", "last will", "silence"])
def test_the_emotion_of_a_player_who_is_gone_is_held_for_a_while(network, end):
    ann = network.player("a")
    network.node("rex")
    ann.feel(HAPPY)
    network.run(3.0)
    rex = network.robots["rex"]
    noticed = 0.0
    if end == "goodbye":
        network.clients.pop("a").close()
    elif end == "last will":
        network.offline.add("a")
        network.buses["a"].disconnect()
    else:  # its program hangs: no beat, and a connection that stands
        del network.clients["a"]
        noticed = LOST_AFTER_S
    network.run(noticed + HOLD_S - 2.2)
    assert rex.shown[-1] == HAPPY
    network.run(2.5)
    assert rex.shown[-1] == NEUTRAL


def test_another_online_player_becomes_active_when_one_is_gone(network):
    ann, bob = network.player("a"), network.player("b")
    network.node("rex")
    ann.feel(HAPPY)
    network.run(0.5)
    bob.feel(ANGRY)
    network.run(0.5)
    network.clients.pop("a").close()
    network.run(HOLD_S + 0.5)
    assert network.robots["rex"].shown[-1] == ANGRY


def test_a_robot_without_a_broker_goes_to_neutral(network):
    ann = network.player("a")
    network.node("rex")
    ann.feel(HAPPY)
    network.run(0.5)
    network.broker.kill()
    network.run(LOST_AFTER_S + HOLD_S + 0.5)
    assert network.robots["rex"].shown[-1] == NEUTRAL
    network.broker.start()
    network.run(0.5)
    assert network.robots["rex"].shown[-1] == HAPPY


def test_late_messages_of_an_earlier_epoch_have_no_effect(network):
    node = network.node("rex")
    for session, number in ((2, 1), (1, 1), (1, 2), (2, 2), (1, 3)):
        action = ActionMessage(session, number, 1, f"a{session}{number}")
        node.receive("cubeling/1/hall/player/a/action", encode(action), network.now)
        emotion = EmotionMessage(session, number, session / 10, 0.0)
        node.receive("cubeling/1/hall/player/a/emotion", encode(emotion), network.now)
        node.receive(
            "cubeling/1/hall/player/a/status", encode(StatusMessage(1, 9, "closed")), network.now
        )
        node.tick(network.now)
    assert network.robots["rex"].played == ["a21", "a22"]
    assert network.robots["rex"].shown == [Emotion(0.2, 0.0)]
    network.now += HOLD_S
    node.tick(network.now)
    assert network.robots["rex"].shown == [Emotion(0.2, 0.0)]


def test_a_retained_emotion_of_a_closed_player_is_not_shown(network):
    ann = network.player("a")
    ann.feel(HAPPY)
    network.run(0.5)
    network.clients.pop("a").close()
    network.node("rex")
    network.run(1.0)
    assert network.robots["rex"].shown == []


def test_a_robot_follows_only_the_given_players(network):
    network.player("a")
    network.player("b")
    network.node("rex", follow="b")
    network.run(0.5)
    network.act("a")
    network.act("b")
    network.run(0.5)
    assert network.robots["rex"].played == ["b1"]
    assert [robot.name for robot in network.clients["b"].endpoint.followers.robots] == ["rex"]
    assert not network.clients["a"].endpoint.followers.robots


def test_the_state_is_published_when_it_changes_at_a_limited_rate(network):
    ann = network.player("a")
    network.node("rex")
    topic = "cubeling/1/hall/robot/rex/state"
    told: list[StateMessage] = []
    onlooker = network.broker.bus()
    onlooker.subscribe(topic, lambda _, payload: told.append(decode(StateMessage, payload)))
    onlooker.open()
    network.run(3.0)
    assert len(told) == 1
    for step in range(100):
        ann.feel(Emotion(step / 100, 0.5))
        network.run(0.02)
    network.robots["rex"].link = "lost"
    network.run(1.0)
    assert len(told) < 2.0 / 0.2 + 5
    assert [state.number for state in told] == list(range(1, len(told) + 1))
    assert (told[-1].link, told[-1].player, told[-1].commanded) == ("lost", "hall/a", (0.99, 0.5))
    status = decode(
        StatusMessage, network.broker.retained["cubeling/1/hall/robot/rex/status"].payload
    )
    assert status.status == "online"  # the node is, the robot is not


def test_the_table_of_players_is_bounded(network):
    node = RobotNode(Member("hall", "robot", "rex"), FakeRobot(), 1, (Pattern.parse("*", "hall"),))
    for number in range(10 * MAX_PLAYERS):
        for kind, message in (
            ("emotion", EmotionMessage(1, 1, 0.1, 0.1)),
            ("status", StatusMessage(1, 1, "online")),
        ):
            topic = f"cubeling/1/hall/player/p{number}/{kind}"
            node.receive(topic, encode(message), number / 1000)
    assert len(node.arbiter.players) == MAX_PLAYERS


def test_the_table_of_robots_is_bounded(network):
    ann = network.player("a")
    for number in range(10 * MAX_ROBOTS):
        for status in ("online", "lost") if number % 2 else ("online",):
            said = StatusMessage(1, 1, status, ("hall/*",))
            ann.receive(f"cubeling/1/hall/robot/r{number}/status", encode(said), network.now)
    assert len(ann.followers.robots) == MAX_ROBOTS


@pytest.mark.parametrize(
    "text", ["", "a/b/c", "a b", "+", "#", "hall/", "/a", "-a", "x" * 33, "\n"]
)
def test_an_invalid_name_is_refused_in_one_line(text):
    with pytest.raises(RobotError) as refused:
        Pattern.parse(text, "hall")
    assert "\n" not in str(refused.value)
