"""A good robot conforms over any line that loses nothing: slow, late, or with long pauses."""

from dataclasses import dataclass, field

import pytest

from cubeling.robot.conformance import all_checks, run_checks
from cubeling.robot.conformance.suite import MAX_DURATION_S
from cubeling.robot.protocol.timing import BAUD
from cubeling.robot.simulators.cubeling.simulator import Simulator
from tests.examples import some

STEP_S = 0.001


@dataclass
class Way:
    """One direction of a serial line."""

    late: float
    free: float = 0.0
    waiting: list[tuple[float, bytes]] = field(default_factory=list)

    def send(self, data: bytes, now: float) -> None:
        for start in range(0, len(data), 16):
            part = data[start : start + 16]
            self.free = max(self.free, now) + 10 * len(part) / BAUD
            self.waiting.append((self.free + self.late, part))

    def take(self, now: float) -> bytes:
        data = b""
        while self.waiting and self.waiting[0][0] <= now:
            data += self.waiting.pop(0)[1]
        return data


class SlowLine:
    """A real line in virtual time: 115200 baud, a late adapter, a robot that looks rarely."""

    def __init__(self, late: float, looks_every: float) -> None:
        self.robot = Simulator(5)
        self.there, self.back = Way(late / 4), Way(late)
        self.looks_every, self.looked = looks_every, 0.0
        self.time = 100.0

    def now(self) -> float:
        return self.time

    def write(self, data: bytes) -> None:
        self.there.send(data, self.time)

    def read(self, until: float) -> bytes:
        while True:
            self.time += STEP_S
            if self.time - self.looked >= self.looks_every:
                self.looked = self.time
                self.robot.receive(self.there.take(self.time), self.time)
                self.back.send(self.robot.bytes_to_send(), self.time)
            data = self.back.take(self.time)
            if data or self.time >= until:
                return data

    def hold_up(self, seconds: float) -> bool:
        return False


@pytest.mark.slow(reason="all checks are run over a line of 115 200 baud")
@pytest.mark.parametrize(
    ("late", "looks_every"),
    some([(0.016, 0.02), (0.0, 0.001), (0.016, 0.001), (0.002, 0.02)]),
    ids=["both", "plain", "late adapter", "robot looks every 20 ms"],
)
def test_a_good_robot_conforms_over_a_real_serial_line(late: float, looks_every: float):
    report = run_checks(SlowLine(late, looks_every), all_checks(), 1)
    failed = [(one.check.name, one.received) for one in report.results if one.verdict == "failed"]
    assert report.conforms, failed
    assert {name for name, _ in failed} <= {"round trip short"}
    assert report.seconds < MAX_DURATION_S


class BusyComputer(SlowLine):
    """Holds everybody up for 400 ms, now and then: a check of five seconds fits in between."""

    def read(self, until: float) -> bytes:
        if self.time % 7.3 < 0.02:
            self.time += 0.4
            self.robot.advance(self.time)
        return super().read(until)


@pytest.mark.full
@pytest.mark.slow(reason="all checks are run over a line of 115 200 baud")
def test_a_check_that_fails_on_a_busy_computer_is_retried():
    report = run_checks(BusyComputer(0.0, 0.001), all_checks(), 1)
    assert report.conforms
    assert any("busy for 4" in one.remark for one in report.results)
