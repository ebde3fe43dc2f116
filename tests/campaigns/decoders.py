"""Fuzz targets: every decoder of external input, as a function of bytes.

A target raises only if it found a bug: an undocumented exception, or an object that has grown
beyond its limit. Drivers and simulators come from their registries, so new ones are fuzzed too.
"""

import contextlib
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from cubeling.affect import AffectError, Emotion, Personality
from cubeling.robot.contract.driver import Driver
from cubeling.robot.drivers import DRIVERS
from cubeling.robot.drivers.cubeling.host import HostLink
from cubeling.robot.errors import RobotError
from cubeling.robot.network.messages import MESSAGE_TYPES, MalformedError, decode, encode
from cubeling.robot.protocol.fields import MessageError
from cubeling.robot.protocol.schema import Sender, pack, unpack
from cubeling.robot.protocol.wire import (
    MAX_BODY,
    MAX_FRAME,
    FrameError,
    FrameReader,
    cobs_decode,
    cobs_encode,
    decode_frame,
    encode_frame,
)
from cubeling.robot.simulators import SIMULATORS, Simulated
from cubeling.robot.simulators.cubeling.simulator import Simulator
from cubeling.robot.simulators.memory import simulator_of

MAX_HELD_BYTES = 2_000_000
"""Most memory of a driver or a simulator, whatever it received [bytes]."""

MAX_GROWTH_BYTES = 65_536
"""Most growth when it receives the same again [bytes]."""

MAX_OUTPUT_BYTES = 262_144
"""Most bytes waiting to be written."""

Target = Callable[[bytes], None]


def pieces(data: bytes) -> Iterator[tuple[bytes, float]]:
    """Split data by lengths in its own bytes; yield the pieces, and the delay of each [s]."""
    start, size = 0, len(data)
    while start < size:
        head = data[start]
        end = start + 1 + (head & 63)
        yield data[start + 1 : end], (0.0, 0.005, 0.06, 0.7)[head >> 6]
        start = end


# --- Frames and messages ----------------------------------------------------------------------


def reader(data: bytes) -> None:
    """Feed the stream in pieces; a whole frame after it must arrive."""
    frames = FrameReader()
    for piece, _ in pieces(data):
        for body in frames.feed(piece):
            assert 1 <= len(body) <= MAX_BODY
        assert frames.buffered <= MAX_FRAME + 1
    assert frames.feed(encode_frame(b"whole"))[-1] == b"whole"


def frame(data: bytes) -> None:
    """Decode one frame; a valid one is the only encoding of its body."""
    with contextlib.suppress(FrameError):
        body = decode_frame(data)
        assert encode_frame(body)[1:-1] == data


def cobs(data: bytes) -> None:
    """Decode COBS, whose encoding is unique."""
    with contextlib.suppress(FrameError):
        body = cobs_decode(data)
        if 0 not in data and len(body) <= MAX_BODY:
            assert cobs_encode(body) == data


def message_from(sender: Sender) -> Target:
    """Return the target that decodes bodies of one side."""

    def read(data: bytes) -> None:
        with contextlib.suppress(MessageError):
            session, message = unpack(data, sender)
            if message is not None:
                assert unpack(pack(message, session), sender) == (session, message)

    return read


# --- Drivers and simulated robots ----------------------------------------------------------------


def run_driver(driver: Driver, data: bytes, whole: Callable[[bytes], bytes] = bytes) -> None:
    """Feed the pieces to a driver, with commands in between."""
    now = 1.0
    driver.port_opened(now)
    for piece, later in pieces(data):
        now += later
        driver.receive(whole(piece), now)
        driver.tick(now)
        if len(piece) % 16 == 3:
            driver.express(Emotion(len(piece) / 100, -0.5, "happy"))
        elif len(piece) == 9:
            driver.play(1, piece[0])
        elif len(piece) == 17:
            driver.stop()
        elif len(piece) == 33:
            driver.port_lost()
            driver.port_opened(now)
        assert len(driver.bytes_to_send()) <= MAX_OUTPUT_BYTES
        driver.telemetry(now)
    driver.close()
    driver.receive(data[:64], now)


def driver_of(name: str) -> Target:
    """Return the target that feeds a driver."""
    return lambda data: run_driver(DRIVERS[name].make(7, None), data)


def host_bodies(data: bytes) -> None:
    """Feed our host bodies in whole frames of its own session."""
    run_driver(HostLink(7), data, _framed)


def run_robot(robot: Simulated, data: bytes, whole: Callable[[bytes], bytes] = bytes) -> None:
    """Feed the pieces to a simulated robot."""
    now = 1.0
    for piece, later in pieces(data):
        now += later
        robot.receive(whole(piece), now)
        robot.advance(now)
        assert len(robot.bytes_to_send()) <= MAX_OUTPUT_BYTES
        robot.portrait()
    robot.reboot()
    robot.receive(data[:64], now)


def simulator_named(name: str) -> Target:
    """Return the target that feeds a simulated robot."""
    return lambda data: run_robot(SIMULATORS[name](1), data)


def robot_bodies(data: bytes) -> None:
    """Feed our robot bodies in whole frames, after HELLO opened session 1."""
    robot = Simulator(1)
    robot.receive(encode_frame(bytes([1, 1, 0, 2, 7, 0, 0, 0])), 1.0)
    run_robot(robot, data, _framed)


def _framed(piece: bytes) -> bytes:
    """Return a frame of session 1 from a piece; its first byte is the message's number."""
    return encode_frame(piece[:1] + b"\1\0" + piece[1:]) if piece else b""


# --- Texts ------------------------------------------------------------------------------------


def settings_of(name: str) -> Target:
    """Return the target that reads a driver's settings file."""

    def read(data: bytes) -> None:
        with tempfile.NamedTemporaryFile(suffix=".toml") as file:
            file.write(data)
            file.flush()
            with contextlib.suppress(RobotError):
                DRIVERS[name].make(7, Path(file.name))

    return read


def personality(data: bytes) -> None:
    """Read a personality's file."""
    with contextlib.suppress(AffectError):
        Personality.parse(data.decode("utf-8", "replace"), "fuzz.toml")


def payload_of(kind: type[Any]) -> Target:
    """Return the target that decodes one kind of message from a broker."""

    def read(data: bytes) -> None:
        with contextlib.suppress(MalformedError):
            message = decode(kind, data)
            assert decode(kind, encode(message)) == message

    return read


def fault_url(data: bytes) -> None:
    """Read a simulator's URL."""
    with contextlib.suppress(RobotError):
        simulator_of("sim:cubeling?" + data.decode("utf-8", "replace"))


TARGETS: dict[str, Target] = {
    "reader": reader,
    "frame": frame,
    "cobs": cobs,
    "message:host": message_from("host"),
    "message:robot": message_from("robot"),
    "bodies:host": host_bodies,
    "bodies:robot": robot_bodies,
    **{f"driver:{name}": driver_of(name) for name in DRIVERS},
    **{f"simulator:{name}": simulator_named(name) for name in SIMULATORS},
    **{f"settings:{name}": settings_of(name) for name in DRIVERS},
    **{f"payload:{'-'.join(key)}": payload_of(kind) for key, kind in MESSAGE_TYPES.items()},
    "personality": personality,
    "url": fault_url,
}
"""All targets, by name."""
