"""A real broker: killed in the middle, behind passwords and TLS, hung, absent."""

import math
import os
import signal
import socket
import subprocess
import threading
import time
from pathlib import Path
from typing import Any

import pytest

import robot
from robot.emotion import Emotion
from robot.errors import RobotError
from robot.network import (
    Address,
    Credentials,
    Letter,
    Member,
    MqttBus,
    Pattern,
    Player,
    RobotNode,
    Roster,
    Station,
)
from robot.network.mqtt import RETRY_LAST, WAITING_MAX
from robot.protocol import messages as m
from robot.simulators import SIMULATORS
from robot.simulators.cubeling.simulator import Simulator
from tests.robot.network.mosquitto import needs_mosquitto

pytestmark = needs_mosquitto


@pytest.fixture
def played(monkeypatch):
    """What every simulated robot's body was made to play, by its seed."""
    done: dict[int, list[tuple[int, int]]] = {}

    def watched(seed: int) -> Simulator:
        simulator = Simulator(seed)
        play, done[seed] = simulator.body.play, []

        def seen(item: int, index: int) -> None:
            done[seed].append((item, index))
            play(item, index)

        monkeypatch.setattr(simulator.body, "play", seen)
        return simulator

    monkeypatch.setitem(SIMULATORS, "cubeling", watched)
    return done


@pytest.fixture
def join(request):
    """Put members on a broker; they leave with the test."""
    stations: list[Station[Any]] = []

    def put(broker, endpoint, name: str) -> Station[Any]:
        station = Station(endpoint, MqttBus(Address.of(broker.url), name), time.monotonic)
        stations.append(station)
        return station.open()

    yield put
    for station in stations:
        station.close()


def everyone(pattern: str = "*") -> tuple[Pattern, ...]:
    return (Pattern.parse(pattern, "hall"),)


def test_a_broker_killed_in_the_middle_costs_no_action_and_doubles_none(
    mosquitto, join, played, soon
):
    broker = mosquitto()
    dinos = [robot.connect(f"sim:cubeling?seed={seed}") for seed in (1, 2, 3)]
    motions, sounds = dinos[0].catalogue.motions, dinos[0].catalogue.sounds
    roster = join(broker, Roster(), "roster")
    for seed, dino in enumerate(dinos, start=1):
        member = Member("hall", "robot", f"dino{seed}")
        join(broker, RobotNode(member, dino, 1, everyone()), f"dino{seed}")
    ann, bob = (
        join(broker, Player(Member("hall", "player", name), 1, math.inf), name)
        for name in ("ann", "bob")
    )
    done = {"ann": 0, "bob": 0}

    def act(station, name, words, times):
        with station.lock:
            for _ in range(times):
                station.endpoint.act(words[done[name] % len(words)], 0.5, time.monotonic())
                done[name] += 1
        station.wake()

    def all_have_played() -> bool:
        wanted = done["ann"] + done["bob"]
        return all(len(one) >= wanted for one in played.values())

    def expected(item: int, words, name: str) -> list[tuple[int, int]]:
        return [(item, number % len(words)) for number in range(done[name])]

    soon(lambda: len(ann.endpoint.robots) == len(bob.endpoint.robots) == 3)
    act(ann, "ann", motions, 4)
    act(bob, "bob", sounds, 4)
    soon(all_have_played)
    act(ann, "ann", motions, 5)  # some of these are on their way when it dies
    act(bob, "bob", sounds, 5)
    broker.kill()
    act(bob, "bob", sounds, 3)
    act(ann, "ann", motions, 3)
    with ann.lock:
        ann.endpoint.feel(Emotion(0.75, 0.5), "happy")
    soon(lambda: ann.state == bob.state == "away")
    assert "127.0.0.1" in ann.trouble
    broker.start()
    soon(all_have_played)
    act(ann, "ann", motions, 1)  # it acts last, so it has the robots
    soon(all_have_played)
    soon(lambda: ann.endpoint.waiting == bob.endpoint.waiting == 0)
    soon(lambda: all(dino.telemetry.acknowledged == Emotion(0.75, 0.5) for dino in dinos))

    for seed in (1, 2, 3):
        assert [one for one in played[seed] if one[0] == m.ITEM_MOTION] == expected(
            m.ITEM_MOTION, motions, "ann"
        )
        assert [one for one in played[seed] if one[0] == m.ITEM_SOUND] == expected(
            m.ITEM_SOUND, sounds, "bob"
        )

    def told() -> bool:
        with roster.lock:
            members = roster.endpoint.members
            return len(members) == 5 and all(
                seen.presence(time.monotonic()) == "online" for seen in members.values()
            ) and all(
                (state := members[Member("hall", "robot", f"dino{seed}")].said.get("state"))
                and (state.player, state.link) == ("hall/ann", "ready")
                and state.commanded == (0.75, 0.5)
                for seed in (1, 2, 3)
            )  # fmt: skip

    soon(told)
    bob.close()
    soon(lambda: roster.endpoint.members[bob.endpoint.member].said["status"].status == "closed")
    for dino in dinos:
        dino.close()


def test_a_member_that_dies_is_lost_by_its_last_will(mosquitto, join, soon):
    broker = mosquitto()
    roster = join(broker, Roster(), "roster")
    member = Member("hall", "player", "ann")
    join(broker, Player(member, 1), "the same")
    soon(lambda: member in roster.endpoint.members)
    other = join(broker, Roster(), "the same")  # takes the name over: the broker drops the first
    soon(lambda: roster.endpoint.members[member].said["status"].status == "lost")
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


def test_what_the_broker_does_not_allow_is_told(mosquitto, tmp_path, soon):
    rules = tmp_path / "acl"
    rules.write_text("topic read #\ntopic write cubeling/1/hall/player/ann/#\n")
    broker = mosquitto(f"acl_file {rules}")
    bus = MqttBus(Address.of(broker.url), "ann")
    bus.open()
    assert bus.publish(Letter("cubeling/1/hall/player/bob/status", b"{}"))
    soon(lambda: "does not let us publish to cubeling/1/hall/player/bob/status" in bus.trouble)
    bus.close()


def test_the_example_rules_let_each_speak_for_itself_alone(mosquitto, tmp_path, soon):
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
    buses["hall"].publish(Letter("cubeling/1/museum/robot/ida/state", b"{}"))
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
        assert buses[user].publish(Letter(topic, b"{}"))
    soon(lambda: sorted(heard) == sorted(allowed))
    soon(lambda: all("does not let us" in bus.trouble for bus in buses.values()))
    for bus in buses.values():
        bus.close()


def openssl(*words: str) -> None:
    subprocess.run(["openssl", *words], check=True, capture_output=True)


@pytest.fixture
def authority(tmp_path):
    """Make an authority, a broker's certificate by it, and another authority."""
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


def test_tls_with_the_right_authority_and_no_other(mosquitto, authority, join, soon):
    broker = mosquitto(*tls(authority))
    url = f"mqtts://localhost:{broker.port}"
    bus = MqttBus(Address.of(url, Credentials(ca=authority / "ca.pem")), "ann")
    heard: list[bytes] = []
    bus.subscribe("cubeling/#", lambda _, payload: heard.append(payload))
    bus.open()
    assert bus.state == "connected"
    for number in range(60):  # several in one TLS record, too
        bus.publish(Letter("cubeling/x", b"%d" % number))
    soon(lambda: heard == [b"%d" % number for number in range(60)])
    bus.close()
    for wrong in (Credentials(ca=authority / "other.pem"), Credentials()):
        with pytest.raises(RobotError, match="not to be trusted"):
            MqttBus(Address.of(url, wrong), "ann").open()


def test_a_broker_that_asks_for_a_certificate_gets_one(mosquitto, authority):
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


def test_tls_where_none_is_spoken_and_the_reverse_are_told(mosquitto, authority, soon):
    plain, secret = mosquitto(), mosquitto(*tls(authority))
    given = Credentials(ca=authority / "ca.pem")
    for url, access, hint in (
        (f"mqtts://localhost:{plain.port}", given, "does it speak TLS there"),
        (secret.url, None, "does it want TLS"),
    ):
        bus = MqttBus(Address.of(url, access), "ann")
        bus.open()
        soon(lambda bus=bus, hint=hint: hint in bus.trouble)
        bus.close()


def test_a_broker_that_is_away_stops_nobody_and_is_found_when_it_comes(mosquitto, soon):
    broker = mosquitto()
    broker.kill()
    bus = MqttBus(Address.of(broker.url), "ann")
    changes: list[str] = []
    bus.on_change(lambda: changes.append(bus.state))
    began = time.monotonic()
    bus.open()
    assert not bus.publish(Letter("cubeling/x", b""))
    assert time.monotonic() - began < 1.0
    assert "nobody listens there" in bus.trouble
    broker.start()
    soon(lambda: bus.state == "connected", within=RETRY_LAST + 2.0)
    bus.close()
    bus.close()
    assert changes[-1] == "closed"


def test_a_broker_that_hangs_fills_no_memory_and_delays_no_publisher(mosquitto):
    broker = mosquitto()
    bus = MqttBus(Address.of(broker.url), "ann")
    bus.open()
    os.kill(broker.pid, signal.SIGSTOP)
    worst, taken = 0.0, 0
    for _ in range(5000):
        began = time.perf_counter()
        taken += bus.publish(Letter("cubeling/x", b"x" * 1000))
        worst = max(worst, time.perf_counter() - began)
    os.kill(broker.pid, signal.SIGCONT)
    bus.close()
    assert taken < 5000
    assert len(bus._waiting) <= WAITING_MAX
    assert worst < 0.1


def test_a_port_where_nobody_speaks_mqtt_is_left_in_bounded_time(monkeypatch, soon):
    monkeypatch.setattr("robot.network.mqtt.ANSWER_WITHIN", 0.3)
    with socket.create_server(("127.0.0.1", 0)) as mute:
        bus = MqttBus(Address.of(f"mqtt://127.0.0.1:{mute.getsockname()[1]}"), "ann")
        bus.open()
        assert "nobody speaks MQTT there" in bus.trouble
        bus.close()
    assert not [thread for thread in threading.enumerate() if thread.name == "mqtt ann"]
