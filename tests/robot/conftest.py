"""What the robot's tests share: virtual time, a world, and bounded waiting."""

import time
from collections.abc import Callable

import pytest

from cubeling.affect import Emotion
from cubeling.robot.drivers.cubeling.host import HostLink
from cubeling.robot.protocol import messages as m
from cubeling.robot.simulators.channel import FaultyChannel
from cubeling.robot.simulators.cubeling.simulator import Simulator
from cubeling.robot.simulators.faults import Faults


class World:
    """A host and a simulated robot on one virtual clock, with a line of each direction between.

    `harm` sets the faults of both lines, as fields of `Faults`.
    """

    def __init__(self, seed: int = 0, step: float = 0.005, **harm: float) -> None:
        faults = Faults(**harm)  # type: ignore[arg-type] # those of its fields that are numbers
        self.now = 100.0
        self.step = step
        self.host = HostLink(host=7)
        self.robot = Simulator(seed)
        self.to_robot = FaultyChannel(faults, Simulator.edge, (seed, 0))
        self.from_robot = FaultyChannel(faults, Simulator.edge, (seed, 1))
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
        self.host.receive(self.from_robot.receive(self.now), self.now)
        self.host.tick(self.now)
        self.to_robot.send(self.host.bytes_to_send(), self.now)
        if self.now < self.stalled_until:
            return
        self.robot.receive(self.to_robot.receive(self.now), self.now)
        self.from_robot.send(self.robot.bytes_to_send(), self.now)

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
