"""Whose mood a robot shows, and what it does when its player is gone."""

import pytest

from affect import Emotion
from robot.errors import RobotError
from robot.network import Member, Pattern, RobotNode
from robot.network.arbiter import HOLD_S, MAX_PLAYERS
from robot.network.endpoint import LOST_AFTER_S
from robot.network.followers import MAX_ROBOTS
from robot.network.messages import (
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


def test_an_action_gives_the_robot_to_who_did_it(room):
    ann, bob = room.player("a"), room.player("b")
    room.node("rex")
    ann.feel(HAPPY)
    room.run(0.5)
    bob.feel(ANGRY)
    room.run(0.5)
    felt = room.robots["rex"].felt
    assert felt[-1] == HAPPY  # a mere feeling takes nobody's robot
    room.act("b")
    room.run(0.5)
    assert felt[-1] == ANGRY
    ann.feel(Emotion(0.9, 0.5))
    room.run(0.5)
    assert felt[-1] == ANGRY
    room.act("a")
    room.run(0.5)
    assert felt[-1] == Emotion(0.9, 0.5)


@pytest.mark.parametrize("end", ["goodbye", "last will", "silence"])
def test_a_player_who_is_gone_keeps_its_mood_on_the_robot_for_a_while(room, end):
    ann = room.player("a")
    room.node("rex")
    ann.feel(HAPPY)
    room.run(3.0)
    rex = room.robots["rex"]
    noticed = 0.0
    if end == "goodbye":
        room.stations.pop("a").close()
    elif end == "last will":
        room.held.add("a")
        room.buses["a"].disconnect()
    else:  # its program hangs: no beat, and a connection that stands
        del room.stations["a"]
        noticed = LOST_AFTER_S
    room.run(noticed + HOLD_S - 2.2)
    assert rex.felt[-1] == HAPPY
    room.run(2.5)
    assert rex.felt[-1] == NEUTRAL


def test_a_robot_goes_from_a_player_who_is_gone_to_one_who_is_there(room):
    ann, bob = room.player("a"), room.player("b")
    room.node("rex")
    ann.feel(HAPPY)
    room.run(0.5)
    bob.feel(ANGRY)
    room.run(0.5)
    room.stations.pop("a").close()
    room.run(HOLD_S + 0.5)
    assert room.robots["rex"].felt[-1] == ANGRY


def test_a_robot_cut_off_from_the_broker_is_neutral_in_the_end(room):
    ann = room.player("a")
    room.node("rex")
    ann.feel(HAPPY)
    room.run(0.5)
    room.broker.kill()
    room.run(LOST_AFTER_S + HOLD_S + 0.5)
    assert room.robots["rex"].felt[-1] == NEUTRAL
    room.broker.start()
    room.run(0.5)
    assert room.robots["rex"].felt[-1] == HAPPY


def test_what_comes_late_from_an_earlier_run_moves_nothing(room):
    node = room.node("rex")
    for session, number in ((2, 1), (1, 1), (1, 2), (2, 2), (1, 3)):
        action = ActionMessage(session, number, 1, f"a{session}{number}")
        node.receive("cubeling/1/hall/player/a/action", encode(action), room.now)
        feeling = EmotionMessage(session, number, session / 10, 0.0)
        node.receive("cubeling/1/hall/player/a/emotion", encode(feeling), room.now)
        node.receive(
            "cubeling/1/hall/player/a/status", encode(StatusMessage(1, 9, "closed")), room.now
        )
        node.tick(room.now)
    assert room.robots["rex"].played == ["a21", "a22"]
    assert room.robots["rex"].felt == [Emotion(0.2, 0.0)]
    room.now += HOLD_S
    node.tick(room.now)
    assert room.robots["rex"].felt == [Emotion(0.2, 0.0)]


def test_a_retained_feeling_of_nobody_moves_no_robot(room):
    ann = room.player("a")
    ann.feel(HAPPY)
    room.run(0.5)
    room.stations.pop("a").close()
    room.node("rex")
    room.run(1.0)
    assert room.robots["rex"].felt == []


def test_a_robot_follows_whom_it_was_told_and_nobody_else(room):
    room.player("a")
    room.player("b")
    room.node("rex", follow="b")
    room.run(0.5)
    room.act("a")
    room.act("b")
    room.run(0.5)
    assert room.robots["rex"].played == ["b1"]
    assert [robot.name for robot in room.stations["b"].endpoint.followers.robots] == ["rex"]
    assert not room.stations["a"].endpoint.followers.robots


def test_the_state_tells_what_the_robot_does_only_when_it_changes_and_not_too_often(room):
    ann = room.player("a")
    room.node("rex")
    topic = "cubeling/1/hall/robot/rex/state"
    told: list[StateMessage] = []
    onlooker = room.broker.bus()
    onlooker.subscribe(topic, lambda _, payload: told.append(decode(StateMessage, payload)))
    onlooker.open()
    room.run(3.0)
    assert len(told) == 1
    for step in range(100):
        ann.feel(Emotion(step / 100, 0.5))
        room.run(0.02)
    room.robots["rex"].link = "lost"
    room.run(1.0)
    assert len(told) < 2.0 / 0.2 + 5
    assert [state.number for state in told] == list(range(1, len(told) + 1))
    assert (told[-1].link, told[-1].player, told[-1].commanded) == ("lost", "hall/a", (0.99, 0.5))
    status = decode(StatusMessage, room.broker.retained["cubeling/1/hall/robot/rex/status"].payload)
    assert status.status == "online"  # the node is, the robot is not


def test_more_players_than_a_robot_can_count_make_no_memory_grow(room):
    node = RobotNode(Member("hall", "robot", "rex"), FakeRobot(), 1, (Pattern.parse("*", "hall"),))
    for number in range(10 * MAX_PLAYERS):
        for kind, message in (
            ("emotion", EmotionMessage(1, 1, 0.1, 0.1)),
            ("status", StatusMessage(1, 1, "online")),
        ):
            topic = f"cubeling/1/hall/player/p{number}/{kind}"
            node.receive(topic, encode(message), number / 1000)
    assert len(node.arbiter.players) == MAX_PLAYERS


def test_more_robots_than_a_player_can_count_make_no_memory_grow(room):
    ann = room.player("a")
    for number in range(10 * MAX_ROBOTS):
        for status in ("online", "lost") if number % 2 else ("online",):
            said = StatusMessage(1, 1, status, ("hall/*",))
            ann.receive(f"cubeling/1/hall/robot/r{number}/status", encode(said), room.now)
    assert len(ann.followers.robots) == MAX_ROBOTS


@pytest.mark.parametrize(
    "text", ["", "a/b/c", "a b", "+", "#", "hall/", "/a", "-a", "x" * 33, "\n"]
)
def test_what_can_be_no_name_is_refused_in_one_line(text):
    with pytest.raises(RobotError) as refused:
        Pattern.parse(text, "hall")
    assert "\n" not in str(refused.value)
