"""A robot that is unplugged and plugged in again, under the same name or another."""

import os
import sys
from types import SimpleNamespace

import pytest

from cubeling import robot
from cubeling.affect import Emotion
from cubeling.robot.link.transport import UsbIdentity, find_port, usb_identity
from cubeling.robot.simulators.cubeling.simulator import Simulator
from cubeling.robot.simulators.port import SimulatedPort

HAPPY = Emotion(0.8, 0.5)


@pytest.fixture
def usb(monkeypatch):
    """The USB devices of this computer, by port: (vendor, product, serial number, socket)."""
    devices: dict[str, tuple[object, ...]] = {}

    def comports():
        return [
            SimpleNamespace(device=name, vid=vid, pid=pid, serial_number=serial, location=location)
            for name, (vid, pid, serial, location) in devices.items()
        ]

    monkeypatch.setattr("cubeling.robot.link.transport.list_ports.comports", comports)
    return devices


def test_a_device_is_known_by_its_serial_number_wherever_it_is_plugged_in(usb):
    usb["/dev/ttyACM0"] = (0x2E8A, 5, "A1", "1-2")
    known = usb_identity("/dev/ttyACM0")
    usb.clear()
    usb["/dev/ttyACM0"] = (0x2E8A, 5, "B2", "1-2")
    usb["/dev/ttyACM1"] = (0x2E8A, 5, "A1", "1-4")
    assert known is not None
    assert find_port(known) == "/dev/ttyACM1"


def test_a_device_without_a_serial_number_is_known_by_its_socket(usb):
    usb["/dev/ttyUSB0"] = (0x1A86, 7, None, "1-2")
    known = usb_identity("/dev/ttyUSB0")
    usb.clear()
    usb["/dev/ttyUSB3"] = (0x1A86, 7, None, "1-2")
    usb["/dev/ttyUSB4"] = (0x1A86, 7, None, "1-3")
    assert known is not None
    assert find_port(known) == "/dev/ttyUSB3"


def test_two_devices_that_could_be_it_are_not_guessed_between(usb):
    usb["/dev/ttyACM1"] = usb["/dev/ttyACM2"] = (1, 2, "same", "1-1")
    assert find_port(UsbIdentity(1, 2, "same", "1-9")) is None


def test_what_is_no_usb_device_has_no_identity(usb):
    usb["/dev/ttyS0"] = (None, None, None, None)
    assert usb_identity("/dev/ttyS0") is None
    assert usb_identity("/dev/nothing") is None


@pytest.mark.skipif(sys.platform == "win32", reason="needs pseudo-terminals")
@pytest.mark.parametrize("new_name", ["ttyACM0", "ttyACM1"])
def test_unplugging_is_noticed_and_plugging_in_recovered_from_within_a_second(
    new_name, tmp_path, usb, soon
):
    old, new = tmp_path / "ttyACM0", tmp_path / new_name
    body = Simulator(seed=2)
    first = SimulatedPort(body)
    old.symlink_to(first.url)
    usb[str(old)] = (0x2E8A, 5, "A1", "1-2")
    with robot.connect(str(old)) as dino:
        dino.express(HAPPY)
        soon(lambda: dino.telemetry.acknowledged == HAPPY)
        os.unlink(old)
        usb.clear()
        first.close()
        soon(lambda: dino.telemetry.state == "lost", within=1.0)
        with SimulatedPort(body) as second:
            new.symlink_to(second.url)
            usb[str(new)] = (0x2E8A, 5, "A1", "1-4")
            soon(lambda: dino.telemetry.state == "ready", within=1.0)
            soon(lambda: dino.telemetry.acknowledged == HAPPY, within=1.0)
