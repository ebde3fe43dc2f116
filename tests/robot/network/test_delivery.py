"""Players and robots' nodes in virtual time: no action is lost or doubled."""

import numpy as np
from hypothesis import given, settings, strategies as st

from cubeling.affect import Emotion
from cubeling.robot.network import Member, Player
from cubeling.robot.network.endpoint import LOST_AFTER_S
from cubeling.robot.network.followers import Followers
from cubeling.robot.network.messages import AckMessage, ActionMessage, StatusMessage, decode, encode
from cubeling.robot.network.player import EMOTION_EVERY_S, MAX_AGE_S, MAX_PENDING_ACTIONS
from tests.examples import examples
from tests.robot.network.conftest import DeliveryFaults, NetworkWorld

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


@settings(max_examples=examples(30))
@given(
    seed=st.integers(0, 10_000),
    drop=st.sampled_from([0.0, 0.1, 0.3]),
    double=st.sampled_from([0.0, 0.3]),
    late=st.sampled_from([0.0, 0.3]),
    steps=STEPS,
)
def test_every_action_is_done_once_and_in_order_despite_all_faults(seed, drop, double, late, steps):
    network = NetworkWorld(seed)
    for name in "ab":
        network.player(name)
    for name in ("rex", "max"):
        network.node(name)
    network.run(0.5)
    network.faults = DeliveryFaults(drop, double, late)
    emotions = {"a": 0, "b": 0}
    for what, who, amount in steps:
        if what == "act":
            for _ in range(amount):
                network.act(who)
        elif what == "feel":
            emotions[who] += 1
            side = {"a": 1, "b": -1}[who]
            network.clients[who].endpoint.feel(Emotion(side * emotions[who] / 100, 0.5))
        elif what == "kill":
            network.broker.kill()
            network.run(amount * 0.02)
            network.broker.start()
        elif what == "cut":
            network.buses[who].disconnect()
        elif what == "wait":
            network.run(amount * 0.02, step=0.04)
        network.run(0.12, step=0.04)
    network.faults = DeliveryFaults()
    network.run(12.0, step=0.04)
    for robot in network.robots.values():
        for name in "ab":
            assert [did for did in robot.played if did[0] == name] == network.made[name]
        for side in (1, -1):  # of no player is an older feeling shown after a newer one
            shown = [side * e.valence for e in robot.shown if side * e.valence > 0]
            changes = [value for i, value in enumerate(shown) if i == 0 or value != shown[i - 1]]
            assert changes == sorted(changes)
    assert network.clients["a"].endpoint.pending == network.clients["b"].endpoint.pending == 0


def test_the_last_emotion_is_on_the_robot_after_the_broker_lost_its_memory(network):
    ann = network.player("a")
    network.node("rex")
    ann.feel(Emotion(0.2, 0.2))
    network.run(0.2)
    network.broker.kill()
    ann.feel(Emotion(0.9, 0.9, "happy"))
    network.run(1.0)
    assert network.robots["rex"].shown[-1] == Emotion(0.2, 0.2)
    network.broker.start()
    network.run(0.2)
    assert network.robots["rex"].shown[-1] == Emotion(0.9, 0.9, "happy")


def test_an_emotion_is_published_again_to_a_broker_that_lost_it(network):
    network.player("a").feel(Emotion(0.9, 0.9))
    network.run(0.5)
    network.broker.kill()
    network.broker.start()
    network.run(0.5)
    network.node("rex")
    network.run(0.5)
    assert network.robots["rex"].shown == [Emotion(0.9, 0.9)]


def test_emotions_are_rate_limited_and_the_latest_wins(network):
    ann = network.player("a")
    network.node("rex")
    for number in range(100):
        ann.feel(Emotion(number / 100, 0.0))
        network.run(0.02)
    network.run(0.2)
    shown = network.robots["rex"].shown
    assert shown[-1].valence == 0.99
    assert len(shown) <= 2.0 / EMOTION_EVERY_S + 2


def test_an_expired_action_is_dropped_and_counted(network):
    ann = network.player("a", max_age=MAX_AGE_S)
    network.node("rex")
    network.run(0.5)
    network.broker.kill()
    network.act("a")
    network.run(MAX_AGE_S - 1.0)
    network.act("a")
    network.run(2.0)
    network.broker.start()
    network.run(2.0)
    assert network.robots["rex"].played == ["a2"]
    assert (ann.counts["expired"], ann.pending) == (1, 0)


def test_pending_actions_are_bounded_and_dropped_ones_are_counted(network):
    ann = network.player("a")
    network.node("rex")
    network.run(0.5)
    network.broker.kill()
    for _ in range(MAX_PENDING_ACTIONS + 3):
        network.act("a")
    assert (ann.pending, ann.counts["overrun"]) == (MAX_PENDING_ACTIONS, 3)
    network.broker.start()
    network.run(2.0)
    assert network.robots["rex"].played == network.made["a"][3:]


def test_a_robot_gets_missed_actions_after_a_reconnection(network):
    network.player("a")
    network.node("rex")
    network.node("max")
    network.run(0.5)
    network.buses["rex"].disconnect()
    network.offline.add("rex")
    for _ in range(3):
        network.act("a")
    network.run(3.0)
    assert network.robots["max"].played == ["a1", "a2", "a3"]
    network.offline.clear()
    network.run(1.0)
    assert network.robots["rex"].played == ["a1", "a2", "a3"]


def test_a_restarted_node_does_nothing_twice(network):
    network.player("a")
    network.node("rex")
    network.node("max")
    network.run(0.5)
    network.act("a")
    network.run(0.5)
    network.vanish("max")  # keeps the player's next action waiting
    network.act("a")
    network.run(0.5)
    network.vanish("rex")
    network.node("rex")
    network.run(3.0)
    assert network.robots["rex"].played == ["a1", "a2"]


def test_a_restarted_player_starts_a_later_epoch_even_with_an_earlier_clock(network):
    network.player("a")
    network.node("rex")
    network.run(0.5)
    network.act("a")
    network.run(0.5)
    network.vanish("a")
    network.player("a", session=5)  # its clock went back to long ago
    network.run(0.5)
    network.act("a")
    network.run(0.5)
    assert network.robots["rex"].played == ["a1", "a2"]


def test_of_two_programs_with_one_name_the_later_one_publishes(network):
    first = network.player("a", session=500)
    old = network.clients["a"]
    rex = network.node("rex")
    network.run(2.0)
    network.clients["first"], network.buses["first"] = old, network.buses["a"]
    second = network.player("a", session=5)  # by a clock that is behind
    network.run(0.5)
    assert "another program" in first.problem
    assert second.problem == ""
    network.act("a")
    first.feel(Emotion(-1.0, 1.0))
    network.run(3.0)
    assert network.robots["rex"].played == ["a1"]
    assert network.robots["rex"].shown == []
    network.clients["old"], network.buses["old"] = network.clients["rex"], network.buses["rex"]
    network.node("rex")
    network.run(0.5)
    assert "another program" in rex.problem
    network.act("a")
    network.run(1.0)
    assert network.robots["rex"].played == ["a1", "a2"]


def test_a_busy_robot_gets_the_action_later(network):
    network.player("a")
    network.node("rex")
    network.run(0.5)
    network.robots["rex"].busy = True
    network.act("a")
    network.act("a")
    network.run(0.5)
    network.robots["rex"].busy = False
    network.run(2.0)
    assert network.robots["rex"].played == ["a1", "a2"]


def test_an_action_missed_by_a_lost_robot_is_counted(network):
    network.player("a")
    node = network.node("rex")
    network.run(0.5)
    network.robots["rex"].link = "lost"
    network.act("a")
    network.run(0.5)
    network.robots["rex"].link = "ready"
    network.run(2.0)
    assert network.robots["rex"].played == []
    assert (node.counts["missed"], network.clients["a"].endpoint.pending) == (1, 0)


def test_actions_without_followers_expire(network):
    ann = network.player("a", max_age=MAX_AGE_S)
    network.node("rex", follow="b")
    network.run(0.5)
    network.act("a")
    network.run(MAX_AGE_S + 1.0)
    assert (ann.pending, ann.counts["sent"]) == (0, 1)
    assert network.robots["rex"].played == []


def test_a_closed_robot_is_not_waited_for(network):
    ann = network.player("a")
    network.node("rex")
    network.node("max")
    network.run(0.5)
    network.clients.pop("max").close()
    network.act("a")
    network.run(0.5)
    assert ann.pending == 0


def test_actions_for_a_lost_robot_are_kept_but_not_resent(network):
    ann = network.player("a")
    network.node("rex")
    network.run(0.5)
    del network.clients["rex"]  # its program hangs, and the connection stands
    network.act("a")
    network.run(LOST_AFTER_S)
    sent = ann.counts["sent"]
    assert 3 < sent < 10
    network.run(10.0)
    assert (ann.counts["sent"], ann.pending) == (sent, 1)


def test_a_late_acknowledgement_changes_nothing():
    ann, rex = Member("hall", "player", "a"), Member("hall", "robot", "rex")
    followers = Followers(ann)
    followers.receive_status(rex, StatusMessage(1, 1, "online", ("hall/a",)), 0.0)
    assert followers.acknowledge(rex, 5)
    assert not followers.acknowledge(rex, 3)
    assert followers.number_taken_by_all() == 5


def test_an_acknowledgement_of_an_earlier_session_is_ignored(network):
    ann = Player(Member("hall", "player", "a"), session=5)
    ann.on_connect(0.0)
    robot = "cubeling/1/hall/robot/rex"
    ann.receive(f"{robot}/status", encode(StatusMessage(1, 1, "online", ("*/*",))), 0.0)
    ann.act("a1", 0.0, 0.0)
    ann.outgoing_messages(0.0)
    ann.receive(f"{robot}/taken", encode(AckMessage(1, 1, {"hall/a": (5, 1)})), 0.1)
    ann.tick(0.1)
    assert ann.pending == 0
    ann.receive("cubeling/1/hall/player/a/status", encode(StatusMessage(900, 1, "lost")), 0.2)
    ann.act("a2", 0.0, 0.3)
    ann.receive(f"{robot}/taken", encode(AckMessage(1, 1, {"hall/a": (5, 1)})), 0.3)
    ann.tick(0.4)
    assert ann.pending == 1
    (action,) = [
        message for message in ann.outgoing_messages(0.4) if message.topic.endswith("action")
    ]
    assert decode(ActionMessage, action.payload).session == 901


def test_no_message_stops_a_member(network):
    ann, node = network.player("a"), network.node("rex")
    network.run(0.1)
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
                endpoint.receive(topic, payload, network.now)
    assert ann.malformed > 50
    assert node.malformed > 100
    network.act("a")
    network.run(1.0)
    assert network.robots["rex"].played == ["a1"]
