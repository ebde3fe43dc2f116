"""Hosts and robots of earlier versions go on working with those of today, byte for byte.

The transcripts hold a session between the host and a robot as they were before version 3: the
handshake, emotions, a motion, a sound, a refused command, a stop, half a second without the
host, and its end. Each line is a time [ms], a direction and bytes.
"""

from dataclasses import replace
from pathlib import Path

import pytest

from cubeling.affect import Emotion
from cubeling.robot.drivers.cubeling.host import HostLink
from cubeling.robot.protocol import messages as m
from cubeling.robot.protocol.schema import pack, unpack
from cubeling.robot.protocol.wire import FrameReader, encode_frame
from cubeling.robot.simulators.cubeling.simulator import Simulator
from tests.robot.firmware.conftest import Dino

TRANSCRIPTS = sorted((Path(__file__).parent / "protocol" / "transcripts").glob("*.txt"))

END_MS = 1850
CUT_MS = range(800, 1300)
"""When the robot did not hear the host."""

ACTIONS = {
    300: lambda host: host.express(Emotion(0.8, 0.5, "happy")),
    400: lambda host: host.play(m.ITEM_MOTION, 3),
    450: lambda host: host.play(m.ITEM_SOUND, 1),
    500: lambda host: host.play(m.ITEM_MOTION, 200),
    600: lambda host: host.stop(),
    700: lambda host: host.express(Emotion(-0.9, 0.6)),
    1820: lambda host: host.close(),
}
"""What the host was asked to do."""


def said(path: Path) -> dict[str, dict[int, bytes]]:
    """Return what each side sent, by time."""
    directions: dict[str, dict[int, bytes]] = {"tx": {}, "rx": {}}
    for line in path.read_text().splitlines():
        ms, direction, data = line.split()
        directions[direction][int(ms)] = bytes.fromhex(data)
    return directions


@pytest.fixture(params=TRANSCRIPTS, ids=lambda path: path.stem)
def transcript(request) -> Path:
    path: Path = request.param
    return path


def test_a_host_of_an_earlier_version_hears_what_it_always_heard(transcript):
    robot = Simulator(3) if transcript.stem.startswith("simulator") else Dino()
    sent = said(transcript)
    answered = {}
    for ms in range(0, END_MS, 5):
        robot.receive(b"" if ms in CUT_MS else sent["tx"].get(ms, b""), ms / 1000)
        answer = robot.bytes_to_send()
        if answer:
            answered[ms] = answer
    assert {ms: without_catalogue(data) for ms, data in answered.items()} == {
        ms: without_catalogue(data) for ms, data in sent["rx"].items()
    }


def test_a_robot_of_an_earlier_version_is_told_what_it_was_always_told(transcript):
    version = int(transcript.stem[-1])
    sent = said(transcript)
    host = HostLink(host=7)
    told = {}
    for ms in range(0, END_MS, 5):
        if ms == 0:
            host.port_opened(0.0)
        ACTIONS.get(ms, lambda host: None)(host)
        host.receive(sent["rx"].get(ms - 5, b""), ms / 1000)
        host.tick(ms / 1000)
        data = host.bytes_to_send()
        if data:
            told[ms] = with_version(data, version)
    assert told == sent["tx"]
    telemetry = host.telemetry(END_MS / 1000)
    assert (telemetry.counts.sessions, telemetry.counts.refused) == (2, 1)
    assert (host.joint_mover, telemetry.measured_at, telemetry.log) == (None, None, ())


def without_catalogue(data: bytes) -> list[bytes]:
    """Return the frames without what WELCOME says of motions: the dinosaur has learnt one since."""
    bodies = []
    for body in FrameReader().feed(data):
        session, message = unpack(body, "robot")
        if isinstance(message, m.Welcome):
            body = pack(replace(message, catalogue=0, motions=0), session, 2)
        bodies.append(body)
    return bodies


def with_version(data: bytes, version: int) -> bytes:
    """Return frames with this version in every HELLO: all that may differ."""
    frames = b""
    for body in FrameReader().feed(data):
        session, message = unpack(body, "host")
        if isinstance(message, m.Hello):
            body = pack(m.Hello(version, message.host), session)
        frames += encode_frame(body)
    return frames
