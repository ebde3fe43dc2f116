"""A robot in C, made of PROTOCOL.md and our header, is one that our host works with, and conforms.

The whole suite runs on it in virtual time; what a real line adds is tried on a pseudo-terminal.
"""

import functools
import shutil
import struct
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from cubeling import robot
from cubeling.robot.conformance import (
    PortChannel,
    SimulatedChannel,
    all_checks,
    run_checks,
    select_checks,
)
from cubeling.robot.link.transport import opener
from tests.examples import some
from tools.protocol_reference import HEADER_FILE

HERE = Path(__file__).parent
COMPILER = shutil.which("gcc") or shutil.which("cc") or shutil.which("clang")
pytestmark = [
    pytest.mark.skipif(COMPILER is None, reason="no C compiler here"),
    pytest.mark.skipif(sys.platform == "win32", reason="there are no pseudo-terminals"),
]

STRICT = ("-std=c99", "-O1", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Werror")
CHECKED = ("-fsanitize=address,undefined", "-fno-sanitize-recover=all")

STEP_AT_MOST = 0xFFFF
"""Bytes that one step can hold."""


@pytest.fixture(scope="module")
def build(tmp_path_factory):
    """Compile the robot, with whatever gives it its time and its line."""
    folder = tmp_path_factory.mktemp("robot")

    @functools.cache
    def built(main: str, source: Path = HERE / "robot.c") -> Path:
        program: Path = folder / f"{main}_{source.parent.name}"
        assert COMPILER is not None
        include = ("-I", str(HEADER_FILE.parent), "-I", str(HERE))
        command = [COMPILER, *STRICT, *CHECKED, *include, "-o", str(program)]
        command += [str(source), str(HERE / f"{main}.c"), "-lm"]
        done = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
        assert done.returncode == 0, done.stderr
        return program

    return built


class Stepped:
    """The robot in C as a simulated one: a process that lives step by step."""

    edge = b"\0"

    def __init__(self, program: Path) -> None:
        self.process = subprocess.Popen([program], stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        self._said = b""

    def receive(self, data: bytes, now: float) -> None:
        assert len(data) <= STEP_AT_MOST
        assert self.process.stdin is not None
        assert self.process.stdout is not None
        self.process.stdin.write(struct.pack("<IH", round(1000 * now), len(data)) + data)
        self.process.stdin.flush()
        (size,) = struct.unpack("<H", self.process.stdout.read(2))
        self._said += self.process.stdout.read(size)

    def advance(self, now: float) -> None:
        self.receive(b"", now)

    def bytes_to_send(self) -> bytes:
        said, self._said = self._said, b""
        return said

    def reboot(self) -> None:
        raise NotImplementedError("a new process is a new robot")

    def portrait(self) -> tuple[float, str]:
        raise NotImplementedError("nobody looks at it")

    def __enter__(self) -> "Stepped":
        return self

    def __exit__(self, *_: object) -> None:
        self.process.communicate(timeout=10)  # closes its input, and so ends it


def failures(program: Path, one_of: int = 1) -> list[str]:
    """Return the names of the checks that the robot fails, of one in so many, in virtual time."""
    with Stepped(program) as stepped:
        report = run_checks(SimulatedChannel(stepped), all_checks()[::one_of], host=1)
    assert stepped.process.returncode == 0  # or the sanitizers have found something
    assert not report.cut_short
    return [one.check.name for one in report.results if one.verdict != "ok"]


@pytest.mark.slow(reason="another process is asked for every millisecond of the checks")
@pytest.mark.parametrize("one_of", some([4, 1]))
def test_it_conforms_in_every_check(build, one_of):
    assert failures(build("steps"), one_of) == []


@pytest.mark.full
def test_a_mistake_in_it_is_seen(build, tmp_path):
    source = (HERE / "robot.c").read_text()
    mistaken = source.replace("if (number <= self->taken)", "if (number == self->taken)")
    assert mistaken != source
    (tmp_path / "robot.c").write_text(mistaken)
    assert "repeat without effect" in failures(build("steps", tmp_path / "robot.c"))


@pytest.fixture
def url(build) -> Iterator[str]:
    """The robot behind a pseudo-terminal, in real time."""
    with subprocess.Popen([build("terminal")], stdout=subprocess.PIPE, text=True) as process:
        try:
            assert process.stdout is not None
            yield process.stdout.readline().strip()
            assert process.poll() is None  # or the sanitizers have found something
        finally:
            process.kill()


def test_our_host_is_connected_and_obeyed_on_a_real_line(url, soon):
    with robot.connect(url) as dino:
        assert dino.catalogue.motions == ("nod", "wag", "prick up")
        dino.express(robot.Emotion(-0.6, -0.4, "sad"))
        soon(lambda: dino.telemetry.label == "sad")
        dino.play("wag")
        soon(lambda: dino.telemetry.motion == "wag")
        dino.stop()
        soon(lambda: dino.telemetry.stopped and dino.telemetry.motion is None)
        assert dino.telemetry.reckoned
        assert dino.telemetry.joints.keys() == {"neck", "tail", "ears"}


QUICK = (
    "garbage before a frame",
    "half a frame before a frame",
    "frame in pieces",
    "frames in one go",
    "longest frame received",
    "flood survived",
    "hello answered",
    "catalogue complete",
    "command acknowledged",
    "beat answered",
    "bye ends the session",
)
"""What a real line may spoil, of the checks that do not wait for a failsafe or an emotion."""

ATTEMPTS = 3
"""A robot on a busy computer may answer late once; one with a mistake is wrong every time."""


def test_it_conforms_on_a_real_line(url):
    checks = select_checks(QUICK)
    port = opener(url)()
    try:
        for attempt in range(ATTEMPTS):
            report = run_checks(PortChannel(port, time.monotonic), checks, host=attempt + 1)
            checks = [one.check for one in report.results if one.verdict != "ok"]
            if not checks:
                break
    finally:
        port.close()
    assert [check.name for check in checks] == []
