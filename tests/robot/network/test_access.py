"""How to get into a broker: URLs, passwords, certificates; no message shows a password."""

import os
import sys
from pathlib import Path

import pytest

from cubeling.robot.errors import RobotError
from cubeling.robot.network import Address, Credentials
from cubeling.robot.network.mqtt import access


def test_a_url_has_host_port_user_and_password():
    address = Address.of("mqtt://ann:se%40same@museum.local:1884")
    assert (address.host, address.port, address.user) == ("museum.local", 1884, "ann")
    assert address.password == "se@same"
    assert str(address) == "mqtt://museum.local:1884"
    assert "same" not in repr(address)


@pytest.mark.parametrize(("url", "port"), [("mqtt://h", 1883), ("mqtts://h/", 8883)])
def test_each_scheme_has_its_default_port(url, port):
    address = Address.of(url)
    assert address.port == port
    assert (address.tls is not None) == (port == 8883)


def test_the_password_comes_from_the_url_then_the_file_then_the_environment(tmp_path, monkeypatch):
    monkeypatch.setenv("CUBELING_MQTT_PASSWORD", "variable")
    file = tmp_path / "password"
    file.write_text("from the file\nnot this\n")
    given = Credentials(user="ann", password_file=file)
    assert Address.of("mqtt://ann:url@h", given).password == "url"
    assert Address.of("mqtt://h", given).password == "from the file"
    assert Address.of("mqtt://ann@h").password == "variable"
    assert Address.of("mqtt://h").password is None  # nobody has no password


@pytest.mark.parametrize(
    ("url", "given", "says"),
    [
        ("museum.local", {}, "mqtt://HOST"),
        ("http://museum.local", {}, "http"),
        ("mqtt://", {}, "mqtt://HOST"),
        ("mqtt://ann:secret@h:port", {}, "port"),
        ("mqtt://ann:secret@h:99999", {}, "port"),
        ("mqtt://ann:secret@h/topic", {}, "only a host"),
        ("mqtt://ann:secret@a..b", {}, "host name"),
        ("mqtt://:secret@h", {}, "needs a user"),
        ("mqtt://h", {"ca": Path("ca.pem")}, "mqtts://"),
        ("mqtts://h", {"ca": Path("absent.pem")}, "absent.pem"),
        ("mqtts://h", {"key": Path("a.key")}, "certificate"),
        ("mqtts://h", {"certificate": Path("absent.pem")}, "absent.pem"),
        ("mqtt://h", {"user": "ann", "password_file": Path("absent")}, "absent"),
    ],
)
def test_errors_are_one_line_without_the_password(url, given, says):
    with pytest.raises(RobotError, match=says) as refused:
        Address.of(url, Credentials(**given))
    assert "secret" not in str(refused.value)
    assert "\n" not in str(refused.value)


def test_an_empty_password_file_and_an_invalid_certificate_are_refused(tmp_path):
    file = tmp_path / "file"
    file.write_text("\n")
    with pytest.raises(RobotError, match="first line"):
        Address.of("mqtt://h", Credentials(user="ann", password_file=file))
    with pytest.raises(RobotError, match="no readable certificate"):
        Address.of("mqtts://h", Credentials(ca=file))


@pytest.mark.skipif(sys.platform == "win32", reason="there are no named pipes")
def test_a_password_may_come_from_a_pipe_with_a_timeout(tmp_path, monkeypatch):
    monkeypatch.setattr(access, "PASSWORD_TIMEOUT_S", 0.2)
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    given = Credentials(user="ann", password_file=pipe)
    with pytest.raises(RobotError, match="must be the password"):
        Address.of("mqtt://h", given)  # nobody writes
    writer = os.open(pipe, os.O_RDWR)
    os.write(writer, b"secret\n")
    assert Address.of("mqtt://h", given).password == "secret"
    os.close(writer)
    for option in ("ca", "certificate", "key"):
        wrong = Credentials(**{option: pipe})
        with pytest.raises(RobotError, match="not a file"):
            Address.of("mqtts://h", wrong)


@pytest.mark.skipif(not os.path.exists("/dev/zero"), reason="there is no /dev/zero")
def test_a_device_is_not_a_password_file():
    given = Credentials(user="ann", password_file=Path("/dev/zero"))
    with pytest.raises(RobotError, match="must be the password"):
        Address.of("mqtt://h", given)
