"""Ports are listed with a guess of what they are, and not opened."""

from types import SimpleNamespace

import pytest

from cubeling.robot.link import ports


def test_a_pleo_is_recognised_and_usb_comes_first(monkeypatch):
    found = [
        SimpleNamespace(device="/dev/ttyS0", description="n/a", vid=None, pid=None),
        SimpleNamespace(device="/dev/ttyACM0", description="Pleo", vid=0x6962, pid=1),
    ]
    monkeypatch.setattr("serial.tools.list_ports.comports", lambda: found)
    pleo, plain = ports.serial_ports()
    assert (pleo.url, pleo.guess) == ("/dev/ttyACM0", "a Pleo")
    assert (plain.url, plain.guess) == ("/dev/ttyS0", None)


@pytest.mark.parametrize(("vendor", "what"), [(0x303A, "an ESP32"), (0x1234, None), (None, None)])
def test_only_what_is_known_is_guessed(monkeypatch, vendor, what):
    found = SimpleNamespace(device="/dev/ttyACM0", description="n/a", vid=vendor, pid=1)
    monkeypatch.setattr("serial.tools.list_ports.comports", lambda: [found])
    assert ports.serial_ports()[0].guess == what
