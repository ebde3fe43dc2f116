"""What the robot's tests share: virtual time, a line that does harm, and bounded waiting."""

import time
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
import pytest
from hypothesis import settings

from robot.drivers.cubeling.host import HostLink
from robot.emotion import Emotion
from robot.protocol import messages as m
from robot.simulators.cubeling.simulator import Simulator

# A busy machine is no reason for a property to fail.
settings.register_profile("no deadline", deadline=None)
settings.load_profile("no deadline")


@dataclass
class Harm:
    """What a line does to the bytes; chances are per chunk written."""

    drop: float = 0.0
    flip: float = 0.0
    duplicate: float = 0.0
    split: float = 0.0
    garbage: float = 0.0
    delay: float = 0.0


@dataclass
class Line:
    """One direction of a serial line in virtual time. It never reorders, as no wire does."""

    random: np.random.Generator
    harm: Harm
    cut: bool = False
    harmed: int = 0
    _waiting: list[tuple[float, bytes]] = field(default_factory=list)

    def send(self, data: bytes, now: float) -> None:
        # The frames of one write meet their fates one by one.
        for frame in data.split(b"\0\0"):
            if frame:
                self._send_one(b"\0" + frame.strip(b"\0") + b"\0", now)

    def _send_one(self, data: bytes, now: float) -> None:
        happens = self.random.random(5) < (
            self.harm.drop, self.harm.flip, self.harm.duplicate, self.harm.split, self.harm.garbage,
        )  # fmt: skip
        drop, flip, duplicate, split, garbage = happens.tolist()
        self.harmed += int(happens.any())
        if drop or self.cut:
            return
        if flip:
            wrong = bytearray(data)
            wrong[self.random.integers(len(data))] ^= 1 << self.random.integers(8)
            data = bytes(wrong)
        if garbage:
            data = self.random.bytes(int(self.random.integers(1, 40))) + data
        late = now + self.harm.delay
        if split:
            middle = int(self.random.integers(1, len(data)))
            self._waiting += [(late, data[:middle]), (late + 0.004, data[middle:])]
        else:
            self._waiting.append((late, data))
        if duplicate:
            self._waiting.append((late + 0.030, data))

    def receive(self, now: float) -> bytes:
        arrived = b""
        while self._waiting and self._waiting[0][0] <= now:
            arrived += self._waiting.pop(0)[1]
        return arrived


class World:
    """A host and a simulated robot on one virtual clock, with a line of each direction between."""

    def __init__(self, seed: int = 0, step: float = 0.005, **harm: float) -> None:
        random = np.random.default_rng(seed)
        self.now = 100.0
        self.step = step
        self.host = HostLink(host=7)
        self.robot = Simulator(seed)
        self.there = Line(random, Harm(**harm))
        self.back = Line(random, Harm(**harm))
        self.applied: list[tuple[float, Emotion]] = []
        self.neutral_at: list[float] = []
        self.reboots: list[float] = []
        self.stalled_until = 0.0
        self._watch()
        self.host.port_opened(self.now)

    def run(self, seconds: float, each: Callable[[], None] = lambda: None) -> None:
        for _ in range(round(seconds / self.step)):
            self.now += self.step
            each()
            self._turn()

    def run_until(self, condition: Callable[[], bool], within: float) -> float:
        start = self.now
        while not condition():
            assert self.now - start < within, f"not within {within} s of virtual time"
            self.now += self.step
            self._turn()
        return self.now - start

    def reboot(self) -> None:
        self.robot.reboot()
        self.reboots.append(self.now)
        self._watch()

    @property
    def telemetry(self):
        return self.host.telemetry(self.now)

    def _turn(self) -> None:
        self.host.receive(self.back.receive(self.now), self.now)
        self.host.tick(self.now)
        self.there.send(self.host.bytes_to_send(), self.now)
        if self.now < self.stalled_until:
            return
        self.robot.receive(self.there.receive(self.now), self.now)
        self.back.send(self.robot.bytes_to_send(), self.now)

    def _watch(self) -> None:
        """Write down when the robot's body is told what."""
        body = self.robot.body
        express, neutral = body.express, body.neutral

        def seen_express(emotion: Emotion, mood: int = m.NOTHING) -> None:
            self.applied.append((self.now, emotion))
            express(emotion, mood)

        def seen_neutral() -> None:
            self.neutral_at.append(self.now)
            neutral()

        body.express = seen_express  # type: ignore[method-assign] # a spy on this one body
        body.neutral = seen_neutral  # type: ignore[method-assign]


@pytest.fixture
def world() -> Callable[..., World]:
    """Make a world: `world(seed=1, drop=0.05)`."""
    return World


@pytest.fixture
def soon() -> Callable[[Callable[[], bool]], None]:
    """Wait for something real to become true, for at most five seconds."""

    def wait(condition: Callable[[], bool], within: float = 5.0) -> None:
        end = time.monotonic() + within
        while not condition():
            assert time.monotonic() < end, f"not within {within} s"
            time.sleep(0.002)

    return wait
