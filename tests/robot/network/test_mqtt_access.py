"""A real broker with passwords, access rules and TLS."""

import shutil
import socket
import ssl
import subprocess
import threading
from pathlib import Path
from typing import Any

import pytest
from paho.mqtt.client import Client, MQTTMessageInfo

from cubeling import robot
from cubeling.robot.errors import RobotError
from cubeling.robot.network import (
    Address,
    Credentials,
    Message,
    MqttBus,
)
from tests.robot.network.mosquitto import needs_mosquitto

pytestmark = needs_mosquitto


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


def test_tls_needs_the_right_authority(mosquitto, authority, soon):
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
