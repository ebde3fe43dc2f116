"""What the firmware reports to its owner: its log, and why it refuses a command."""

from typing import Any

import pytest
from hypothesis import given, strategies as st

from cubeling.robot.firmware.dino import log as firmware_log, servos
from cubeling.robot.firmware.dino.robot import run
from cubeling.robot.firmware.dino.table import ServoTable
from cubeling.robot.protocol import messages as m
from cubeling.robot.protocol.schema import pack, unpack
from cubeling.robot.protocol.wire import FrameReader, encode_frame
from cubeling.robot.simulators.cubeling import device
from tests.robot.firmware.conftest import Dino, FailingBoard

LEVEL = (0.0,) * m.JOINTS_MAX


def told(dino: Dino, kind: type[Any]) -> list[Any]:
    return [message for _, message in dino.sent() if isinstance(message, kind)]


@given(st.lists(st.text(max_size=90), max_size=12))
def test_lines_are_shortened_counted_and_dropped_as_by_the_simulated_robot(texts):
    ours, simulated = firmware_log.LogQueue(), device.SimulatedLogQueue()
    for index, text in enumerate(texts):
        text = text.encode(errors="ignore").decode()
        ours.write(m.SEVERITY_WARNING, text, index)
        simulated.write(m.SEVERITY_WARNING, text, index)
    while (line := ours.pop()) is not None:
        count, time, severity, data = line
        assert m.Log(count, time, severity, data.decode()) == simulated.pop()
    assert simulated.pop() is None


@pytest.mark.parametrize(
    "command", [m.Play(1, m.ITEM_MOTION, 3), m.Move(1, 0.0, 0, 1, LEVEL)], ids=["PLAY", "MOVE"]
)
def test_without_power_or_charge_nothing_is_moved_and_the_reason_told(dino, command):
    dino.send(m.Hello(3, 9))
    dino.run(300)
    dino.board.dead = True
    dino.run(60)
    dino.send(command)
    assert [ack.result for ack in told(dino, m.Ack)] == [m.RESULT_MOTORS_OFF]
    dino.board.dead = False
    dino.run(1000)
    dino.board.battery = lambda: 400
    dino.send(m.Hello(3, 10), session=2)
    dino.send(command, session=2)
    dino.send(m.Beat(1), session=2)
    assert [ack.result for ack in told(dino, m.Ack)] == [m.RESULT_LOW_BATTERY]


def test_an_unplugged_servo_driver_is_logged_once_and_again_when_it_is_back(dino):
    dino.send(m.Hello(3, 9))
    for dead in (True, False):
        dino.board.dead = dead
        for count in range(8):
            dino.send(m.Beat(count))
            dino.run(200)
    lines = [(line.severity, line.text) for line in told(dino, m.Log)]
    assert lines == [
        (m.SEVERITY_INFO, "started"),
        (m.SEVERITY_ERROR, "the servo driver does not answer"),
        (m.SEVERITY_INFO, "the servo driver answers again"),
    ]


class VisitedBoard(FailingBoard):
    """After the failure a host comes."""

    fails_at = 20

    def wait(self, ms: int) -> None:
        super().wait(ms)
        if self.turns == 200:
            self.incoming = encode_frame(pack(m.Hello(3, 9), 1))


def test_why_the_firmware_restarted_is_told_to_the_next_host():
    board = VisitedBoard()
    run(board, ServoTable(servos))
    received = [unpack(body, "robot")[1] for body in FrameReader().feed(board.outgoing)]
    assert [(one.severity, one.text) for one in received if isinstance(one, m.Log)] == [
        (m.SEVERITY_INFO, "started"),
        (m.SEVERITY_ERROR, "restarted after MemoryError('on purpose')"),
    ]
