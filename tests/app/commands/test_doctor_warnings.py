"""What `cubeling doctor` warns of: slow drawing, and a port without a robot."""

from types import SimpleNamespace

import pytest

from cubeling.app.commands.look import doctor
from cubeling.characters import rendering
from cubeling.robot.link.ports import SerialPort

BUILT_IN = SerialPort("/dev/ttyS0", "n/a", None, None, None)
ON_USB = SerialPort("/dev/ttyACM0", "Pico", "a Raspberry Pi Pico", 0x2E8A, 5)


def finding(name):
    return next(each for each in doctor.examine(cameras=False) if each.name == name)


@pytest.mark.parametrize(
    ("renderer", "warned"),
    [
        ("llvmpipe (LLVM 15.0.7, 256 bits)", True),
        ("softpipe", True),
        ("Mesa Intel(R) UHD Graphics 620 (KBL GT2)", False),
        ("NVIDIA GeForce RTX 3060/PCIe/SSE2", False),
    ],
)
def test_software_rendering_is_named_with_its_speed(monkeypatch, renderer, warned):
    context = SimpleNamespace(
        info={"GL_RENDERER": renderer}, version_code=450, release=lambda: None
    )
    monkeypatch.setattr(rendering, "create_context", lambda: context)
    drawing = finding("drawing")
    assert renderer in drawing.found
    assert drawing.verdict == ("missing" if warned else "good")
    assert ("software rendering" in drawing.found) == warned
    assert ("pictures a second" in drawing.found) == warned


def test_a_built_in_port_is_no_robot(monkeypatch):
    monkeypatch.setattr("cubeling.robot.serial_ports", lambda: [BUILT_IN])
    robot = finding("robot")
    assert robot.verdict == "missing"
    assert "/dev/ttyS0: built in, probably with nothing connected" in robot.found
    assert robot.remedy == "cubeling robot try /dev/ttyS0"


def test_a_port_on_usb_may_be_a_robot(monkeypatch):
    monkeypatch.setattr("cubeling.robot.serial_ports", lambda: [ON_USB, BUILT_IN])
    robot = finding("robot")
    assert (robot.verdict, robot.found) == ("good", "/dev/ttyACM0")


def test_what_a_phone_needs_is_named_with_the_browser_for_its_tests(monkeypatch):
    monkeypatch.setattr("shutil.which", lambda name, path=None: None)
    assert finding("phone").verdict == "good"
    assert "tests of the page are left out" in finding("phone").found
    monkeypatch.setattr(doctor, "PHONE_LIBRARIES", ("aiohttp", "no_such_library"))
    assert finding("phone").remedy == "pip install no_such_library"
