"""A real broker: killed, with passwords and TLS, hanging, absent."""

import math
import os
import shutil
import signal
import socket
import ssl
import subprocess
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from paho.mqtt.client import Client, MQTTMessageInfo

import robot
from affect import Emotion
from robot.errors import RobotError
from robot.network import (
    Address,
    BusClient,
    Credentials,
    Member,
    Message,
    MqttBus,
    Pattern,
    Player,
    RobotNode,
    Roster,
)
from robot.network.mqtt.bus import MAX_QUEUED, MAX_RETRY_DELAY_S
from robot.protocol import messages as m
from robot.simulators import SIMULATORS
from robot.simulators.cubeling.simulator import Simulator
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
    assert other.state == "connected"


def test_a_wrong_password_is_refused_in_one_line_that_does_not_show_it(mosquitto, tmp_path):
    passwords = tmp_path / "passwords"
    passwords.touch()
    subprocess.run(["mosquitto_passwd", "-b", str(passwords), "ann", "right"], check=True)
    broker = mosquitto(f"password_file {passwords}")
    bus = MqttBus(Address.of(f"mqtt://ann:right@127.0.0.1:{broker.port}"), "ann")
    bus.open()
    assert bus.state == "connected"
    bus.close()
    bus = MqttBus(Address.of(f"mqtt://ann:sesame@127.0.0.1:{broker.port}"), "ann")
    with pytest.raises(RobotError, match="does not let us in as 'ann'") as refused:
        bus.open()
    assert "sesame" not in str(refused.value)
    with pytest.raises(RobotError, match="without a user"):
        MqttBus(Address.of(broker.url), "ann").open()


@pytest.mark.parametrize("early", [False, True])
def test_a_forbidden_topic_is_reported(mosquitto, tmp_path, monkeypatch, soon, early):
    """Also if the broker's answer comes before `publish` has returned."""
    publish = Client.publish

    def publish_and_wait(client: Client, *message: Any) -> MQTTMessageInfo:
        info = publish(client, *message)
        info.wait_for_publish(5.0)
        return info

    if early:
        monkeypatch.setattr(Client, "publish", publish_and_wait)
    rules = tmp_path / "acl"
    rules.write_text("topic read #\ntopic write cubeling/1/hall/player/ann/#\n")
    broker = mosquitto(f"acl_file {rules}")
    bus = MqttBus(Address.of(broker.url), "ann")
    bus.open()
    assert bus.publish(Message("cubeling/1/hall/player/bob/status", b"{}"))
    soon(lambda: "does not let us publish to cubeling/1/hall/player/bob/status" in bus.problem)
    bus.close()


def test_the_example_rules_let_each_user_publish_only_as_itself(mosquitto, tmp_path, soon):
    rules = Path(robot.__file__).parent / "network" / "mosquitto.example.acl"
    passwords = tmp_path / "passwords"
    passwords.touch()
    for user in ("ann", "hall"):
        subprocess.run(["mosquitto_passwd", "-b", str(passwords), user, "x"], check=True)
    broker = mosquitto(f"password_file {passwords}", f"acl_file {rules}", "max_packet_size 8192")
    heard: list[str] = []
    buses = {}
    for user in ("ann", "hall"):
        buses[user] = MqttBus(Address.of(f"mqtt://{user}:x@127.0.0.1:{broker.port}"), user)
    buses["hall"].subscribe("cubeling/1/#", lambda topic, _: heard.append(topic))
    for bus in buses.values():
        bus.open()
    buses["hall"].publish(Message("cubeling/1/museum/robot/ida/state", b"{}"))
    soon(lambda: heard)  # now it is subscribed
    heard.clear()
    allowed = ["cubeling/1/museum/robot/rex/state", "cubeling/1/museum/player/ann/action"]
    for user, topic in (
        ("ann", "cubeling/1/museum/player/bob/action"),
        ("hall", "cubeling/1/museum/player/ann/action"),
        ("ann", "cubeling/1/museum/robot/rex/state"),
        ("hall", allowed[0]),
        ("ann", allowed[1]),
    ):
        assert buses[user].publish(Message(topic, b"{}"))
    soon(lambda: sorted(heard) == sorted(allowed))
    soon(lambda: all("does not let us" in bus.problem for bus in buses.values()))
    for bus in buses.values():
        bus.close()


def openssl(*words: str) -> None:
    subprocess.run(["openssl", *words], check=True, capture_output=True)


@pytest.fixture
def authority(tmp_path):
    """Make a certificate authority, a broker's certificate by it, and another authority."""
    if shutil.which("openssl") is None:
        pytest.skip("the openssl command is not installed")
    key = ["-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1", "-nodes", "-days", "2"]
    for name in ("ca", "other"):
        openssl("req", "-x509", *key, "-subj", f"/CN={name}", "-keyout", f"{tmp_path}/{name}.key",
                "-out", f"{tmp_path}/{name}.pem")  # fmt: skip
    for name in ("broker", "client"):
        openssl("req", *key[:-2], "-subj", f"/CN={name}", "-keyout", f"{tmp_path}/{name}.key",
                "-out", f"{tmp_path}/{name}.csr")  # fmt: skip
        (tmp_path / "names").write_text("subjectAltName=DNS:localhost,IP:127.0.0.1\n")
        openssl("x509", "-req", "-in", f"{tmp_path}/{name}.csr", "-CA", f"{tmp_path}/ca.pem",
                "-CAkey", f"{tmp_path}/ca.key", "-CAcreateserial", "-days", "2",
                "-extfile", f"{tmp_path}/names", "-out", f"{tmp_path}/{name}.pem")  # fmt: skip
    return tmp_path


def tls(folder, *more: str) -> list[str]:
    return [f"cafile {folder}/ca.pem", f"certfile {folder}/broker.pem",
            f"keyfile {folder}/broker.key", *more]  # fmt: skip


def test_tls_needs_the_right_authority(mosquitto, authority, join, soon):
    broker = mosquitto(*tls(authority))
    url = f"mqtts://localhost:{broker.port}"
    bus = MqttBus(Address.of(url, Credentials(ca=authority / "ca.pem")), "ann")
    heard: list[bytes] = []
    bus.subscribe("cubeling/#", lambda _, payload: heard.append(payload))
    bus.open()
    assert bus.state == "connected"
    for number in range(60):
        bus.publish(Message("cubeling/x", b"%d" % number))
    soon(lambda: heard == [b"%d" % number for number in range(60)])
    bus.close()
    for wrong in (Credentials(ca=authority / "other.pem"), Credentials()):
        with pytest.raises(RobotError, match="untrusted certificate"):
            MqttBus(Address.of(url, wrong), "ann").open()


def test_messages_that_tls_has_already_decrypted_are_read_at_once(authority, soon):
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    context.load_cert_chain(authority / "broker.pem", authority / "broker.key")
    topic = b"cubeling/x"
    publish = bytes([0x30, 3 + len(topic) + 1, 0, len(topic)]) + topic + b"\0%d"
    over = threading.Event()

    def broker() -> None:
        with context.wrap_socket(server.accept()[0], server_side=True) as line:
            line.recv(1000)  # CONNECT
            line.sendall(b"\x20\3\0\0\0" + b"".join(publish % number for number in range(9)))
            over.wait(10.0)

    with socket.create_server(("127.0.0.1", 0)) as server:
        thread = threading.Thread(target=broker)
        thread.start()
        url = f"mqtts://localhost:{server.getsockname()[1]}"
        bus = MqttBus(Address.of(url, Credentials(ca=authority / "ca.pem")), "ann")
        heard: list[bytes] = []
        bus.subscribe("cubeling/#", lambda _, payload: heard.append(payload))
        bus.open()
        soon(lambda: heard == [b"%d" % number for number in range(9)])
        over.set()
        bus.close()
        thread.join(5.0)


def test_a_client_certificate_is_sent_to_a_broker_that_requires_one(mosquitto, authority):
    broker = mosquitto(*tls(authority, "require_certificate true"))
    url = f"mqtts://localhost:{broker.port}"
    ours = Credentials(
        ca=authority / "ca.pem", certificate=authority / "client.pem", key=authority / "client.key"
    )
    bus = MqttBus(Address.of(url, ours), "ann")
    bus.open()
    assert bus.state == "connected"
    bus.close()
    bus = MqttBus(Address.of(url, Credentials(ca=authority / "ca.pem")), "ann")
    bus.open()
    assert bus.state != "connected"
    bus.close()


def test_tls_on_a_plain_port_and_the_reverse_are_reported(mosquitto, authority, soon):
    plain, secret = mosquitto(), mosquitto(*tls(authority))
    given = Credentials(ca=authority / "ca.pem")
    for url, access, hint in (
        (f"mqtts://localhost:{plain.port}", given, "does it speak TLS there"),
        (secret.url, None, "does it want TLS"),
    ):
        bus = MqttBus(Address.of(url, access), "ann")
        bus.open()
        soon(lambda bus=bus, hint=hint: hint in bus.problem)
        bus.close()


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
    monkeypatch.setattr("robot.network.mqtt.bus.KEEPALIVE_S", 1)
    with socket.create_server(("127.0.0.1", 0)) as mute:
        bus = MqttBus(Address.of(f"mqtt://127.0.0.1:{mute.getsockname()[1]}"), "ann")
        bus.open()
        assert "is there an MQTT broker" in bus.problem
        bus.close()
    assert not [thread for thread in threading.enumerate() if thread.name.endswith("-ann")]
