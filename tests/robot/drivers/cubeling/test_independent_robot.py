"""A robot written from PROTOCOL.md alone, with nothing of ours, works with our host.

It is what independent firmware would be: bitwise CRC, byte-wise COBS, offsets from the tables; and
it conforms.
"""

import struct

import pytest

from cubeling.affect import Emotion
from cubeling.robot.conformance import SimulatedChannel, all_checks, run_checks
from cubeling.robot.protocol.messages import ITEM_MOTION


def crc(data: bytes) -> int:
    register = 0xFFFF
    for byte in data:
        register ^= byte << 8
        for _ in range(8):
            register = register << 1 ^ (0x1021 if register & 0x8000 else 0)
            register &= 0xFFFF
    return register


MOTION_LENGTH_S = 1.0
"""How long its motions take [s]."""

MAX_EMOTION_SPEED = 8000
"""Fastest change of the emotion that it shows [1/10000 of valence and of arousal, per second]."""


class IndependentRobot:
    """One joint, two motions, no sound, one mood, version 1; sections are those of the document."""

    edge = b"\0"

    def __init__(self) -> None:
        self.session = self.host = self.taken = self.result = self.in_force = self.beat = 0
        self.now = self.heard = self.stated = self.refused = 0.0
        self.emotion = (0, 0)
        self.shown = [0.0, 0.0]
        self.stopped = False
        self.motion, self.motion_ends = 255, 0.0
        self.told: list[tuple[int, int]] = []
        self.played: list[int] = []
        self.line = b""
        self.out = b""

    # Section 2

    def receive(self, data: bytes, now: float) -> None:
        self.advance(now)
        for byte in data:
            if byte:
                self.line = (self.line + bytes([byte]))[:125]
                continue
            frame, self.line = self.line, b""
            if 5 <= len(frame) <= 124:
                self.check(frame, now)

    def check(self, frame: bytes, now: float) -> None:
        encoded, (high, middle, low) = frame[:-3], frame[-3:]
        if high >> 4 != 0b1110 or middle >> 6 != 0b10 or low >> 6 != 0b10:
            return
        if crc(encoded) != (high & 15) << 12 | (middle & 63) << 6 | low & 63:
            return
        body, rest = b"", encoded
        while rest:
            run = rest[0]
            if run > len(rest):
                return
            body += rest[1:run] + (b"\0" if run < len(rest) else b"")
            rest = rest[run:]
        self.message(body, now)

    def send(self, number: int, fields: bytes, session: int) -> None:
        body = struct.pack("<BH", number, session) + fields
        encoded, run = b"", b""
        for byte in [*body, 0]:
            if byte:
                run += bytes([byte])
            else:
                encoded, run = encoded + bytes([len(run) + 1]) + run, b""
        c = crc(encoded)
        check = bytes([0xE0 | c >> 12, 0x80 | c >> 6 & 63, 0x80 | c & 63])
        self.out += b"\0" + encoded + check + b"\0"

    def bytes_to_send(self) -> bytes:
        out, self.out = self.out, b""
        return out

    def reboot(self) -> None:
        self.__init__()  # type: ignore[misc] # it forgets all that it knew

    def portrait(self) -> tuple[float, str]:
        return self.shown[0] / 10_000, "plain"

    # Sections 4 to 7

    def message(self, body: bytes, now: float) -> None:
        if len(body) < 3:
            return
        number, session = struct.unpack_from("<BH", body)
        sizes = {1: 8, 2: 5, 3: 5, 0x10: 11, 0x11: 9, 0x12: 7, 0x1F: 3}
        if len(body) < sizes.get(number, 1000) or self.out_of_range(number, body):
            return
        if number == 1:
            if session:
                self.hello(session, *struct.unpack_from("<BI", body, 3))
            return
        if session != self.session or not session:
            if now - self.refused >= 0.020:
                self.refused = now
                self.send(0x9F, b"", session)
            return
        self.heard = now
        if number == 2:
            self.describe(body[3], body[4])
        elif number == 3:
            (self.beat,) = struct.unpack_from("<H", body, 3)
            self.state()
        elif number == 0x1F:
            self.end_session()
        else:
            self.command(number, body)

    def out_of_range(self, number: int, body: bytes) -> bool:
        if number == 1:
            version, host = struct.unpack_from("<BI", body, 3)
            return not (version and host)
        if number not in (0x10, 0x11, 0x12):
            return False
        emotion = struct.unpack_from("<hh", body, 7) if number == 0x10 else (0, 0)
        item = body[7] if number == 0x11 else 1
        return body[3:7] == bytes(4) or max(map(abs, emotion)) > 10_000 or item not in (1, 2)

    def hello(self, session: int, version: int, host: int) -> None:
        if host != self.host:
            self.neutral()
            self.host, self.taken = host, 0
        if session != self.session:
            self.session, self.beat, self.stated = session, 0, self.now
        self.heard = self.now
        names = b"Stranger".ljust(16, b"\0") + b"own 1".ljust(16, b"\0")
        in_force = self.taken if self.in_force else 0
        self.send(0x81, struct.pack("<BIHBBBB", 1, in_force, 77, 1, 2, 0, 1) + names, session)

    def describe(self, item: int, index: int) -> None:
        names = {(0, 0): b"head", (1, 0): b"rest", (1, 1): b"hop", (3, 0): b"plain"}
        if (item, index) not in names:
            return
        name = names[item, index].ljust(16, b"\0")
        if item == 0:
            self.send(0x82, struct.pack("<BhhH", index, -1000, 1000, 2000) + name, self.session)
        else:
            self.send(0x83, bytes([item, index]) + name, self.session)

    def command(self, kind: int, body: bytes) -> None:
        (number,) = struct.unpack_from("<I", body, 3)
        if number > self.taken:
            self.taken, self.in_force, self.result = number, True, 0
            if kind == 0x10:
                self.emotion, self.stopped = struct.unpack_from("<hh", body, 7), False
                self.told.append(self.emotion)
            elif kind == 0x12:
                self.neutral()
                self.in_force, self.stopped = True, True
            elif body[7:9] in (b"\1\0", b"\1\1"):
                self.motion, self.motion_ends, self.stopped = (
                    body[8],
                    self.now + MOTION_LENGTH_S,
                    False,
                )
                self.played.append(body[8])
            else:
                self.result = 1
        self.send(0x90, struct.pack("<IB", number, self.result), self.session)

    def state(self) -> None:
        self.stated = self.now
        flags, shown = 2 * self.stopped, map(round, self.shown)
        played = (0, self.motion, 255)
        fields = struct.pack("<HIBhhHBBB", self.beat, self.taken, flags, *shown, 5000, *played)
        self.send(0x84, fields + struct.pack("<16h", 123, *[0] * 15), self.session)

    def neutral(self) -> None:
        self.in_force, self.emotion, self.motion = False, (0, 0), 255

    def end_session(self) -> None:
        self.session = 0
        self.neutral()

    def advance(self, now: float) -> None:
        step, self.now = MAX_EMOTION_SPEED * min(now - self.now, 0.05), now
        for axis, wanted in enumerate(self.emotion):
            self.shown[axis] += min(max(wanted - self.shown[axis], -step), step)
        if now >= self.motion_ends:
            self.motion = 255
        if self.session and now - self.heard >= 0.450:
            self.end_session()
        if self.session and now - self.stated >= 0.100:
            self.state()


@pytest.fixture
def independent_world(world):
    def make(**harm: float):
        made = world(seed=4, **harm)
        made.robot = IndependentRobot()
        return made

    return make


def test_an_independent_robot_conforms():
    report = run_checks(SimulatedChannel(IndependentRobot()), all_checks(), host=1)
    failed = [(one.check.name, one.received) for one in report.results if one.verdict == "failed"]
    assert failed == []
    assert report.conforms


def test_an_independent_robot_introduces_itself_and_obeys(independent_world):
    w = independent_world()
    w.run_until(lambda: w.telemetry.state == "ready", within=0.5)
    assert w.host.catalogue.motions == ("rest", "hop")
    w.host.express(Emotion(0.5, -0.25))
    w.host.play(ITEM_MOTION, 1)
    w.run(0.3)
    assert (w.robot.told, w.robot.played) == ([(5000, -2500)], [1])
    assert (w.telemetry.label, w.telemetry.motion, w.telemetry.sound) == ("plain", "hop", None)
    w.run(1.0)
    telemetry = w.telemetry
    assert telemetry.acknowledged == Emotion(0.5, -0.25)
    assert telemetry.observed == Emotion(0.5, -0.25, telemetry.label)
    assert telemetry.motion is None
    assert (telemetry.battery, dict(telemetry.joints)) == (0.5, {"head": 0.123})


def test_an_independent_robot_is_neutral_in_time_and_brought_back(independent_world):
    w = independent_world()
    w.host.express(Emotion(0.5, 0.5))
    w.run(0.5)
    w.to_robot.cut = True
    w.run(0.5)
    assert w.robot.emotion == (0, 0)
    w.to_robot.cut = False
    w.run(0.5)
    assert w.robot.emotion == (5000, 5000)


def test_an_independent_robot_survives_a_bad_line(independent_world):
    w = independent_world(drop=0.1, flip=0.005, dup=0.1, babble=300, split=0.3)
    for index in range(1, 60):
        w.host.express(Emotion(index / 10_000, 0.0))
        w.run(0.1)
    w.run_until(lambda: w.robot.emotion == (59, 0), within=3)
    seen = [valence for valence, _ in w.robot.told]
    assert seen == sorted(seen)
