"""Players and robots at one broker in virtual time, with lost, doubled and delayed messages."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from cubeling.affect import Emotion
from cubeling.robot.contract.catalogue import Catalogue
from cubeling.robot.contract.telemetry import LinkState, Telemetry
from cubeling.robot.errors import RobotError
from cubeling.robot.network import (
    BusClient,
    Member,
    MemoryBroker,
    MemoryBus,
    Pattern,
    Player,
    RobotNode,
)
from cubeling.robot.network.bus import Handler
from tests.robot.network.mosquitto import Mosquitto

NAMES = tuple(f"{player}{number}" for player in "abc" for number in range(1, 100))


class FakeRobot:
    """Records its commands."""

    def __init__(self) -> None:
        self.played: list[str] = []
        self.shown: list[Emotion] = []
        self.link: LinkState = "ready"
        self.busy = False
        self.catalogue = Catalogue("fake", "1", (), NAMES, (), ("neutral", "happy", "angry"))

    @property
    def telemetry(self) -> Telemetry:
        last = self.shown[-1] if self.shown else None
        return Telemetry(self.link, commanded=last, acknowledged=last, observed=last)

    def express(self, emotion: Emotion, label: str | None = None) -> None:
        self.shown.append(emotion)

    def play(self, name: str) -> None:
        if self.busy:
            raise RobotError("one too many")
        self.played.append(name)


@dataclass
class DeliveryFaults:
    """Probabilities of faults between the broker and a member."""

    drop: float = 0.0
    double: float = 0.0
    late: float = 0.0


class NetworkWorld:
    """A broker and its members."""

    def __init__(self, seed: int = 0) -> None:
        self.now = 1000.0
        self.broker = MemoryBroker()
        self.faults = DeliveryFaults()
        self.random = np.random.default_rng(seed)
        self.buses: dict[str, MemoryBus] = {}
        self.clients: dict[str, BusClient[Any]] = {}
        self.robots: dict[str, FakeRobot] = {}
        self.made: dict[str, list[str]] = {}
        self.offline: set[str] = set()  # members that cannot reconnect
        self.in_flight: list[tuple[float, Handler, str, bytes]] = []
        self._sessions = 100

    def player(self, name: str, max_age: float = np.inf, session: int | None = None) -> Player:
        player = Player(Member("hall", "player", name), session or self._session(), max_age)
        self._put(name, player)
        self.made.setdefault(name, [])
        return player

    def node(self, name: str, follow: str = "*", **options) -> RobotNode:
        robot = self.robots.setdefault(name, FakeRobot())
        member = Member("hall", "robot", name)
        node = RobotNode(
            member, robot, self._session(), (Pattern.parse(follow, "hall"),), **options
        )
        self._put(name, node)
        return node

    def act(self, name: str) -> None:
        self.made[name].append(f"{name}{len(self.made[name]) + 1}")
        self.clients[name].endpoint.act(self.made[name][-1], 0.0, self.now)

    def run(self, seconds: float, step: float = 0.02) -> None:
        for _ in range(round(seconds / step)):
            self.now += step
            due = [one for one in self.in_flight if one[0] <= self.now]
            self.in_flight = [one for one in self.in_flight if one[0] > self.now]
            for _, handler, topic, payload in due:
                handler(topic, payload)
            for name, client in self.clients.items():
                if self.buses[name].state == "away" and name not in self.offline:
                    self.buses[name].open()
                client.step()

    def vanish(self, name: str) -> None:
        """Kill a member's program, without closing messages."""
        del self.clients[name]
        self.buses.pop(name).disconnect()

    def _session(self) -> int:
        self._sessions += 1
        return self._sessions

    def _put(self, name: str, endpoint: Player | RobotNode) -> None:
        bus = FaultyBus(self)
        self.buses[name] = bus
        self.clients[name] = BusClient(endpoint, bus, lambda: self.now)
        bus.open()


class FaultyBus(MemoryBus):
    """A bus with delivery faults."""

    def __init__(self, network: NetworkWorld) -> None:
        super().__init__(network.broker)
        self._network = network

    def subscribe(self, topic_filter: str, handler: Handler) -> None:
        super().subscribe(
            topic_filter, lambda topic, payload: self._deliver(handler, topic, payload)
        )

    def _deliver(self, handler: Handler, topic: str, payload: bytes) -> None:
        network = self._network
        drop, double, late = network.random.random(3)
        for _ in range((drop >= network.faults.drop) * (1 + (double < network.faults.double))):
            delay = network.random.random() * 2.0 if late < network.faults.late else 0.0
            network.in_flight.append((network.now + delay, handler, topic, payload))


@pytest.fixture
def network() -> NetworkWorld:
    return NetworkWorld()


@pytest.fixture
def mosquitto(tmp_path: Path) -> Iterator[Callable[..., Mosquitto]]:
    """Start brokers with the options given; they end with the test."""
    started: list[Mosquitto] = []

    def start(*options: str) -> Mosquitto:
        folder = tmp_path / f"broker{len(started)}"
        folder.mkdir()
        started.append(Mosquitto(folder, *options))
        started[-1].start()
        return started[-1]

    yield start
    for broker in started:
        broker.kill()
