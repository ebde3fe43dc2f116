"""A real broker: killed, hanging, absent."""

import math
import os
import signal
import socket
import threading
import time
from collections.abc import Iterator
from typing import Any

import pytest

from cubeling import robot
from cubeling.affect import Emotion
from cubeling.robot.network import (
    Address,
    BusClient,
    Member,
    Message,
    MqttBus,
    Pattern,
    Player,
    RobotNode,
    Roster,
)
from cubeling.robot.network.mqtt.bus import MAX_QUEUED, MAX_RETRY_DELAY_S
from cubeling.robot.protocol import messages as m
from cubeling.robot.simulators import SIMULATORS
from cubeling.robot.simulators.cubeling.simulator import Simulator
from tests.robot.network.mosquitto import needs_mosquitto

pytestmark = needs_mosquitto


SPEED_UP = 20.0
"""Speed factor of slow robots and their drivers."""


class RecordingRobot:
    """A robot that records the actions that it accepted."""

    def __init__(self, url: str, speed: float) -> None:
        self.robot = robot.connect(url, clock=lambda: speed * time.monotonic())
        self.played: list[str] = []
        self.catalogue = self.robot.catalogue
        self.express = self.robot.express

    @property
    def telemetry(self) -> robot.Telemetry:
        return self.robot.telemetry

    def play(self, name: str) -> None:
        self.robot.play(name)
        self.played.append(name)

    def can(self, names: list[str]) -> list[str]:
        return [name for name in names if name in self.catalogue.motions + self.catalogue.sounds]


@pytest.fixture
def robots(monkeypatch, soon) -> Iterator[dict[str, RecordingRobot]]:
    """Return robots of three kinds; of the first, the actions of the body are recorded too."""
    bodies: list[tuple[int, int]] = []

    def recording(seed: int) -> Simulator:
        simulator = Simulator(seed)
        play = simulator.body.play

        def seen(item: int, index: int) -> None:
            bodies.append((item, index))
            play(item, index)

        monkeypatch.setattr(simulator.body, "play", seen)
        return simulator

    monkeypatch.setitem(SIMULATORS, "cubeling", recording)
    urls = {
        "rex": ("sim:cubeling", 1.0),
        "max": ("sim:pleo", SPEED_UP),
        "ida": ("sim:opencat", SPEED_UP),
    }
    made = {name: RecordingRobot(url, speed) for name, (url, speed) in urls.items()}
    yield made
    catalogue = made["rex"].catalogue
    words = {m.ITEM_MOTION: catalogue.motions, m.ITEM_SOUND: catalogue.sounds}
    soon(lambda: [words[item][index] for item, index in bodies] == made["rex"].played)
    for one in made.values():
        one.robot.close()


@pytest.fixture
def join(request):
    """Connect members to a broker; they are closed with the test."""
    clients: list[BusClient[Any]] = []

    def put(broker, endpoint, name: str) -> BusClient[Any]:
        client = BusClient(endpoint, MqttBus(Address.of(broker.url), name), time.monotonic)
        clients.append(client)
        return client.open()

    yield put
    for client in clients:
        client.close()


def everyone(pattern: str = "*") -> tuple[Pattern, ...]:
    return (Pattern.parse(pattern, "hall"),)


MOTIONS = ["nod", "wag tail", "hi", "kiss", "sit", "bow", "shout"]
SOUNDS = ["chirp", "growl", "purr"]


def test_no_action_is_lost_or_doubled_when_the_broker_is_killed(mosquitto, join, robots, soon):
    broker = mosquitto()
    roster = join(broker, Roster(), "roster")
    for name, one in robots.items():
        join(broker, RobotNode(Member("hall", "robot", name), one, 1, everyone()), name)
    players = {
        name: join(broker, Player(Member("hall", "player", name), 1, math.inf), name)
        for name in ("ann", "bob")
    }
    done: dict[str, list[str]] = {"ann": [], "bob": []}

    def act(name: str, words: list[str], times: int) -> None:
        with players[name].lock:
            for _ in range(times):
                done[name].append(words[len(done[name]) % len(words)])
                players[name].endpoint.act(done[name][-1], 0.5, time.monotonic())
        players[name].wake()

    def all_have_taken_all() -> bool:
        return all(
            client.endpoint.pending == 0
            and all(
                one.taken == len(done[name]) for one in client.endpoint.followers.robots.values()
            )
            for name, client in players.items()
        )

    soon(lambda: all(len(client.endpoint.followers.robots) == 3 for client in players.values()))
    act("ann", MOTIONS, 2)
    act("bob", SOUNDS, 2)
    soon(all_have_taken_all)
    act("ann", MOTIONS, 4)  # some of these are on their way when it dies
    act("bob", SOUNDS, 3)
    broker.kill()
    act("bob", SOUNDS, 2)
    act("ann", MOTIONS, 3)
    with players["ann"].lock:
        players["ann"].endpoint.feel(Emotion(0.75, 0.5, "happy"))
    soon(lambda: all(client.state == "away" for client in players.values()))
    assert "127.0.0.1" in players["ann"].problem
    broker.start()
    soon(all_have_taken_all, within=10.0)
    act("ann", MOTIONS, 1)  # it acts last, so it has the robots
    soon(all_have_taken_all, within=10.0)
    soon(
        lambda: all(
            one.telemetry.commanded == Emotion(0.75, 0.5, "happy") for one in robots.values()
        )
    )
    for one in robots.values():
        for name, words in (("ann", MOTIONS), ("bob", SOUNDS)):
            assert [did for did in one.played if did in words] == one.can(done[name])
        assert one.telemetry.counts.dropped == 0

    def told() -> bool:
        with roster.lock:
            members = roster.endpoint.members
            states = [
                members[Member("hall", "robot", name)].messages.get("state") for name in robots
            ]
            return (
                len(members) == 5
                and all(one.presence(time.monotonic()) == "online" for one in members.values())
                and all(state and state.player == "hall/ann" for state in states)
                and all(state.commanded == (0.75, 0.5) for state in states)
                and all(state.link in ("ready", "degraded") for state in states)
            )

    soon(lambda: len(roster.endpoint.members) == 5)
    soon(told)
    bob = Member("hall", "player", "bob")
    players["bob"].close()
    soon(lambda: roster.endpoint.members[bob].messages["status"].status == "closed")


def test_a_member_that_dies_is_lost_by_its_last_will(mosquitto, join, soon):
    broker = mosquitto()
    roster = join(broker, Roster(), "roster")
    member = Member("hall", "player", "ann")
    join(broker, Player(member, 1), "the same")
    soon(lambda: member in roster.endpoint.members)
    other = join(broker, Roster(), "the same")  # takes the name over: the broker drops the first
    soon(lambda: roster.endpoint.members[member].messages["status"].status == "lost")
    soon(lambda: other.state == "connected")  # both connect again and again under one name


def test_an_absent_broker_blocks_nobody_and_is_found_when_it_starts(mosquitto, soon):
    broker = mosquitto()
    broker.kill()
    bus = MqttBus(Address.of(broker.url), "ann")
    changes: list[str] = []
    bus.on_change(lambda: changes.append(bus.state))
    began = time.monotonic()
    bus.open()
    assert not bus.publish(Message("cubeling/x", b""))
    assert time.monotonic() - began < 1.0
    assert "no broker listens there" in bus.problem
    broker.start()
    soon(lambda: bus.state == "connected", within=MAX_RETRY_DELAY_S + 2.0)
    bus.close()
    bus.close()
    assert changes[-1] == "closed"


def test_a_hanging_broker_fills_no_memory_and_delays_no_publisher(mosquitto):
    broker = mosquitto()
    bus = MqttBus(Address.of(broker.url), "ann")
    bus.open()
    os.kill(broker.pid, signal.SIGSTOP)
    took, taken = [], 0
    for _ in range(5000):
        began = time.perf_counter()
        taken += bus.publish(Message("cubeling/x", b"x" * 1000))
        took.append(time.perf_counter() - began)
    os.kill(broker.pid, signal.SIGCONT)
    bus.close()
    assert taken <= MAX_QUEUED
    assert sorted(took)[4950] < 0.005  # the last percent is the scheduler's


def test_a_port_without_an_mqtt_broker_is_given_up_in_bounded_time(monkeypatch, soon):
    monkeypatch.setattr("cubeling.robot.network.mqtt.bus.KEEPALIVE_S", 1)
    with socket.create_server(("127.0.0.1", 0)) as mute:
        bus = MqttBus(Address.of(f"mqtt://127.0.0.1:{mute.getsockname()[1]}"), "ann")
        bus.open()
        assert "is there an MQTT broker" in bus.problem
        bus.close()
    assert not [thread for thread in threading.enumerate() if thread.name.endswith("-ann")]
