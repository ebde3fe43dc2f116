"""Players and robots' nodes in virtual time: nothing is lost, nothing doubled."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from affect import Emotion
from robot.network import Member, Player
from robot.network.endpoint import LOST_AFTER_S
from robot.network.followers import Followers
from robot.network.messages import AckMessage, ActionMessage, StatusMessage, decode, encode
from robot.network.player import EMOTION_EVERY_S, MAX_AGE_S, MAX_PENDING_ACTIONS
from tests.robot.network.conftest import Harm, Room

STEPS = st.lists(
    st.one_of(
        st.tuples(st.just("act"), st.sampled_from("ab"), st.integers(1, 4)),
        st.tuples(st.just("feel"), st.sampled_from("ab"), st.integers(1, 3)),
        st.tuples(st.just("kill"), st.just(""), st.integers(0, 100)),
        st.tuples(st.just("cut"), st.sampled_from(["a", "b", "rex", "max"]), st.just(0)),
        st.tuples(st.just("wait"), st.just(""), st.integers(1, 200)),
    ),
    max_size=12,
)


@settings(max_examples=30)
@given(
    seed=st.integers(0, 10_000),
    drop=st.sampled_from([0.0, 0.1, 0.3]),
    double=st.sampled_from([0.0, 0.3]),
    late=st.sampled_from([0.0, 0.3]),
    steps=STEPS,
)
def test_every_action_is_done_once_and_in_order_whatever_the_bus_does(
    seed, drop, double, late, steps
):
    room = Room(seed)
    for name in "ab":
        room.player(name)
    for name in ("rex", "max"):
        room.node(name)
    room.run(0.5)
    room.harm = Harm(drop, double, late)
    feelings = {"a": 0, "b": 0}
    for what, who, amount in steps:
        if what == "act":
            for _ in range(amount):
                room.act(who)
        elif what == "feel":
            feelings[who] += 1
            side = {"a": 1, "b": -1}[who]
            room.stations[who].endpoint.feel(Emotion(side * feelings[who] / 100, 0.5))
        elif what == "kill":
            room.broker.kill()
            room.run(amount * 0.02)
            room.broker.start()
        elif what == "cut":
            room.buses[who].disconnect()
        elif what == "wait":
            room.run(amount * 0.02, step=0.04)
        room.run(0.12, step=0.04)
    room.harm = Harm()
    room.run(12.0, step=0.04)
    for robot in room.robots.values():
        for name in "ab":
            assert [did for did in robot.played if did[0] == name] == room.made[name]
        for side in (1, -1):  # of no player is an older feeling shown after a newer one
            shown = [side * e.valence for e in robot.felt if side * e.valence > 0]
            changes = [value for i, value in enumerate(shown) if i == 0 or value != shown[i - 1]]
            assert changes == sorted(changes)
    assert room.stations["a"].endpoint.pending == room.stations["b"].endpoint.pending == 0


def test_the_last_feeling_is_on_the_robot_after_the_broker_lost_its_memory(room):
    ann = room.player("a")
    room.node("rex")
    ann.feel(Emotion(0.2, 0.2))
    room.run(0.2)
    room.broker.kill()
    ann.feel(Emotion(0.9, 0.9, "happy"))
    room.run(1.0)
    assert room.robots["rex"].felt[-1] == Emotion(0.2, 0.2)
    room.broker.start()
    room.run(0.2)
    assert room.robots["rex"].felt[-1] == Emotion(0.9, 0.9, "happy")


def test_a_feeling_is_said_again_to_a_broker_that_forgot_it(room):
    room.player("a").feel(Emotion(0.9, 0.9))
    room.run(0.5)
    room.broker.kill()
    room.broker.start()
    room.run(0.5)
    room.node("rex")
    room.run(0.5)
    assert room.robots["rex"].felt == [Emotion(0.9, 0.9)]


def test_feelings_are_rate_limited_and_the_latest_wins(room):
    ann = room.player("a")
    room.node("rex")
    for number in range(100):
        ann.feel(Emotion(number / 100, 0.0))
        room.run(0.02)
    room.run(0.2)
    felt = room.robots["rex"].felt
    assert felt[-1].valence == 0.99
    assert len(felt) <= 2.0 / EMOTION_EVERY_S + 2


def test_an_action_too_old_is_given_up_and_counted(room):
    ann = room.player("a", max_age=MAX_AGE_S)
    room.node("rex")
    room.run(0.5)
    room.broker.kill()
    room.act("a")
    room.run(MAX_AGE_S - 1.0)
    room.act("a")
    room.run(2.0)
    room.broker.start()
    room.run(2.0)
    assert room.robots["rex"].played == ["a2"]
    assert (ann.counts.expired, ann.pending) == (1, 0)


def test_only_so_many_actions_wait_and_those_given_up_are_counted(room):
    ann = room.player("a")
    room.node("rex")
    room.run(0.5)
    room.broker.kill()
    for _ in range(MAX_PENDING_ACTIONS + 3):
        room.act("a")
    assert (ann.pending, ann.counts.overrun) == (MAX_PENDING_ACTIONS, 3)
    room.broker.start()
    room.run(2.0)
    assert room.robots["rex"].played == room.made["a"][3:]


def test_a_robot_whose_line_broke_gets_what_it_missed(room):
    room.player("a")
    room.node("rex")
    room.node("max")
    room.run(0.5)
    room.buses["rex"].disconnect()
    room.held.add("rex")
    for _ in range(3):
        room.act("a")
    room.run(3.0)
    assert room.robots["max"].played == ["a1", "a2", "a3"]
    room.held.clear()
    room.run(1.0)
    assert room.robots["rex"].played == ["a1", "a2", "a3"]


def test_a_node_that_is_started_anew_does_nothing_twice(room):
    room.player("a")
    room.node("rex")
    room.node("max")
    room.run(0.5)
    room.act("a")
    room.run(0.5)
    room.vanish("max")  # keeps the player's next action waiting
    room.act("a")
    room.run(0.5)
    room.vanish("rex")
    room.node("rex")
    room.run(3.0)
    assert room.robots["rex"].played == ["a1", "a2"]


def test_a_player_started_anew_begins_a_new_count_and_an_old_clock_does_no_harm(room):
    room.player("a")
    room.node("rex")
    room.run(0.5)
    room.act("a")
    room.run(0.5)
    room.vanish("a")
    room.player("a", session=5)  # its clock went back to long ago
    room.run(0.5)
    room.act("a")
    room.run(0.5)
    assert room.robots["rex"].played == ["a1", "a2"]


def test_of_two_programs_under_one_name_the_one_started_last_speaks(room):
    first = room.player("a", session=500)
    old = room.stations["a"]
    rex = room.node("rex")
    room.run(2.0)
    room.stations["first"], room.buses["first"] = old, room.buses["a"]
    second = room.player("a", session=5)  # by a clock that is behind
    room.run(0.5)
    assert "another program" in first.problem
    assert second.problem == ""
    room.act("a")
    first.feel(Emotion(-1.0, 1.0))
    room.run(3.0)
    assert room.robots["rex"].played == ["a1"]
    assert room.robots["rex"].felt == []
    room.stations["old"], room.buses["old"] = room.stations["rex"], room.buses["rex"]
    room.node("rex")
    room.run(0.5)
    assert "another program" in rex.problem
    room.act("a")
    room.run(1.0)
    assert room.robots["rex"].played == ["a1", "a2"]


def test_a_busy_robot_gets_the_action_later(room):
    room.player("a")
    room.node("rex")
    room.run(0.5)
    room.robots["rex"].busy = True
    room.act("a")
    room.act("a")
    room.run(0.5)
    room.robots["rex"].busy = False
    room.run(2.0)
    assert room.robots["rex"].played == ["a1", "a2"]


def test_a_lost_robot_misses_the_action_and_its_node_says_so(room):
    room.player("a")
    node = room.node("rex")
    room.run(0.5)
    room.robots["rex"].link = "lost"
    room.act("a")
    room.run(0.5)
    room.robots["rex"].link = "ready"
    room.run(2.0)
    assert room.robots["rex"].played == []
    assert (node.counts["missed"], room.stations["a"].endpoint.pending) == (1, 0)


def test_what_nobody_follows_is_not_waited_for_for_ever(room):
    ann = room.player("a", max_age=MAX_AGE_S)
    room.node("rex", follow="b")
    room.run(0.5)
    room.act("a")
    room.run(MAX_AGE_S + 1.0)
    assert (ann.pending, ann.counts.sent) == (0, 1)
    assert room.robots["rex"].played == []


def test_a_robot_that_said_goodbye_is_not_waited_for(room):
    ann = room.player("a")
    room.node("rex")
    room.node("max")
    room.run(0.5)
    room.stations.pop("max").close()
    room.act("a")
    room.run(0.5)
    assert ann.pending == 0


def test_a_robot_that_is_silent_is_waited_for_but_not_pestered(room):
    ann = room.player("a")
    room.node("rex")
    room.run(0.5)
    del room.stations["rex"]  # its program hangs, and the connection stands
    room.act("a")
    room.run(LOST_AFTER_S)
    sent = ann.counts.sent
    assert 3 < sent < 10
    room.run(10.0)
    assert (ann.counts.sent, ann.pending) == (sent, 1)


def test_a_late_acknowledgement_takes_nothing_back():
    ann, rex = Member("hall", "player", "a"), Member("hall", "robot", "rex")
    followers = Followers(ann)
    followers.receive_status(rex, StatusMessage(1, 1, "online", ("hall/a",)), 0.0)
    assert followers.acknowledge(rex, 5)
    assert not followers.acknowledge(rex, 3)
    assert followers.taken_by_all() == 5


def test_an_acknowledgement_of_the_session_before_says_nothing_of_this_one(room):
    ann = Player(Member("hall", "player", "a"), session=5)
    ann.connected(0.0)
    robot = "cubeling/1/hall/robot/rex"
    ann.receive(f"{robot}/status", encode(StatusMessage(1, 1, "online", ("*/*",))), 0.0)
    ann.act("a1", 0.0, 0.0)
    ann.outgoing(0.0)
    ann.receive(f"{robot}/taken", encode(AckMessage(1, 1, {"hall/a": (5, 1)})), 0.1)
    ann.tick(0.1)
    assert ann.pending == 0
    ann.receive("cubeling/1/hall/player/a/status", encode(StatusMessage(900, 1, "lost")), 0.2)
    ann.act("a2", 0.0, 0.3)
    ann.receive(f"{robot}/taken", encode(AckMessage(1, 1, {"hall/a": (5, 1)})), 0.3)
    ann.tick(0.4)
    assert ann.pending == 1
    (action,) = [letter for letter in ann.outgoing(0.4) if letter.topic.endswith("action")]
    assert decode(ActionMessage, action.payload).session == 901


def test_nothing_that_arrives_stops_a_member(room):
    ann, node = room.player("a"), room.node("rex")
    room.run(0.1)
    random = np.random.default_rng(3)
    topics = [f"cubeling/1/hall/{place}" for place in (
        "robot/rex/status", "robot/rex/taken", "player/a/status", "player/a/action",
        "player/b/emotion", "robot/x/status", "player//action", "player/a/later")]  # fmt: skip
    bad = [b"", b"{", b"[" * 4000, b"null", b"7", b'"x"', b"{}", b'{"session":1e999}',
           b'{"session":true,"number":1}', b'{"session":-1}', b"\xff\xfe", b"x" * 5000,
           b'{"session":1,"number":1,"oldest":1,"name":"a\\u0000"}',
           b'{"session":1,"number":1,"oldest":1,"name":"\\ud800"}',
           b'{"session":1,"number":NaN,"status":[]}']  # fmt: skip
    for payload in [*bad, *(random.bytes(30) for _ in range(50))]:
        for topic in topics:
            for endpoint in (ann, node):
                endpoint.receive(topic, payload, room.now)
    assert ann.counts.malformed > 50
    assert node.malformed > 100
    room.act("a")
    room.run(1.0)
    assert room.robots["rex"].played == ["a1"]
