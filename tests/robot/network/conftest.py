"""Players and robots at one broker in virtual time, on lines that lose, double and reorder."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from affect import Emotion
from robot.contract.catalogue import Catalogue
from robot.contract.telemetry import LinkState, Telemetry
from robot.errors import RobotError
from robot.network import BusClient, Member, MemoryBroker, MemoryBus, Pattern, Player, RobotNode
from robot.network.bus import Handler
from tests.robot.network.mosquitto import Mosquitto

NAMES = tuple(f"{player}{number}" for player in "abc" for number in range(1, 100))


class FakeRobot:
    """Plays at once, and keeps what it was asked."""

    def __init__(self) -> None:
        self.played: list[str] = []
        self.felt: list[Emotion] = []
        self.link: LinkState = "ready"
        self.busy = False
        self.catalogue = Catalogue("fake", "1", (), NAMES, (), ("neutral", "happy", "angry"))

    @property
    def telemetry(self) -> Telemetry:
        last = self.felt[-1] if self.felt else None
        return Telemetry(self.link, commanded=last, acknowledged=last, observed=last)

    def express(self, emotion: Emotion, label: str | None = None) -> None:
        self.felt.append(emotion)

    def play(self, name: str) -> None:
        if self.busy:
            raise RobotError("one too many")
        self.played.append(name)


@dataclass
class Harm:
    """What happens to a message on its last stretch, from the broker to a member."""

    drop: float = 0.0
    double: float = 0.0
    late: float = 0.0


class Room:
    """A broker, and whoever is at it."""

    def __init__(self, seed: int = 0) -> None:
        self.now = 1000.0
        self.broker = MemoryBroker()
        self.harm = Harm()
        self.random = np.random.default_rng(seed)
        self.buses: dict[str, MemoryBus] = {}
        self.stations: dict[str, BusClient[Any]] = {}
        self.robots: dict[str, FakeRobot] = {}
        self.made: dict[str, list[str]] = {}
        self.held: set[str] = set()  # who cannot reconnect
        self._mail: list[tuple[float, Handler, str, bytes]] = []
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
        self.stations[name].endpoint.act(self.made[name][-1], 0.0, self.now)

    def run(self, seconds: float, step: float = 0.02) -> None:
        for _ in range(round(seconds / step)):
            self.now += step
            due = [mail for mail in self._mail if mail[0] <= self.now]
            self._mail = [mail for mail in self._mail if mail[0] > self.now]
            for _, handler, topic, payload in due:
                handler(topic, payload)
            for name, station in self.stations.items():
                if self.buses[name].state == "away" and name not in self.held:
                    self.buses[name].reconnect()
                station.step()

    def vanish(self, name: str) -> None:
        """Kill a member's program: no goodbye."""
        del self.stations[name]
        self.buses.pop(name).disconnect()

    def _session(self) -> int:
        self._sessions += 1
        return self._sessions

    def _put(self, name: str, endpoint: Player | RobotNode) -> None:
        bus = HarmedBus(self)
        self.buses[name] = bus
        self.stations[name] = BusClient(endpoint, bus, lambda: self.now)
        bus.open()


class HarmedBus(MemoryBus):
    """Its messages meet their fates one by one."""

    def __init__(self, room: Room) -> None:
        super().__init__(room.broker)
        self._room = room

    def subscribe(self, topic_filter: str, handler: Handler) -> None:
        super().subscribe(topic_filter, lambda topic, payload: self._mail(handler, topic, payload))

    def _mail(self, handler: Handler, topic: str, payload: bytes) -> None:
        room = self._room
        drop, double, late = room.random.random(3)
        for _ in range((drop >= room.harm.drop) * (1 + (double < room.harm.double))):
            delay = room.random.random() * 2.0 if late < room.harm.late else 0.0
            room._mail.append((room.now + delay, handler, topic, payload))


@pytest.fixture
def room() -> Room:
    return Room()


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
