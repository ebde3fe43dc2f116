"""The main loop: line, protocol and body, and the recovery from errors."""

from .board import RobotBoard
from .body import DinoBody
from .frames import TransmitBuffer
from .joints import ServoJoints
from .log import LogQueue
from .messages import SEVERITY_ERROR, SEVERITY_INFO
from .session import HostSession
from .table import ServoTable

WAIT_MS = 5
"""Longest wait for bytes [ms]: the period of the main loop."""

ERROR_PAUSE_MS = 300
"""Pause after an error [ms]."""


class Firmware:
    """The firmware's state until the next error; the expected angles of the joints survive one."""

    def __init__(
        self, board: RobotBoard, table: ServoTable, joints: ServoJoints, log: LogQueue
    ) -> None:
        self._board = board
        self._log = log
        self._joints_failed = False
        self._send_buffer = TransmitBuffer()
        self._to_send = memoryview(self._send_buffer.data)
        self._input = bytearray(256)
        self._watchdog_started = False
        self.body = DinoBody(joints, board, table.buzzer is not None, 1000 * table.rest_after)
        """The body."""
        self.session = HostSession(self.body, self._send_buffer, table.name, board, log)
        """The session with the host."""

    def step(self, now: int) -> None:
        """Do everything that is due at `now` [ms], without blocking."""
        board = self._board
        # Also without bytes: the failsafe and STATE depend on the clock.
        self.session.receive(self._input, board.read(self._input), now)
        attended = self.session.number != 0
        self.body.advance(now, attended)
        self._report_servos(now)
        buffer = self._send_buffer
        if buffer.end:
            buffer.drop(board.write(self._to_send[buffer.start : buffer.end]))
        if attended and not self._watchdog_started:
            # Not earlier: before the first session a developer may interrupt the program.
            self._watchdog_started = True
            board.start_watchdog()
        board.feed_watchdog()

    def _report_servos(self, now: int) -> None:
        failed = self.body.joints.failed
        if failed != self._joints_failed:
            self._joints_failed = failed
            if failed:
                self._log.write(SEVERITY_ERROR, "the servo driver does not answer", now)
            else:
                self._log.write(SEVERITY_INFO, "the servo driver answers again", now)


def run_until_exit(
    board: RobotBoard, table: ServoTable, joints: ServoJoints, log: LogQueue
) -> None:
    """Run the main loop until an exit is requested."""
    firmware = Firmware(board, table, joints, log)
    now = 0
    while firmware.session.number or not board.exit_requested():
        # Not the board's own clock, which wraps around.
        now += board.elapsed()
        firmware.step(now)
        board.wait(WAIT_MS)


def run(board: RobotBoard, table: ServoTable) -> None:
    """Run the firmware, and restart it after every error, until an exit is requested."""
    joints = ServoJoints(table.servos, board)
    log = LogQueue()
    log.write(SEVERITY_INFO, "started", 0)
    board.begin(True)
    try:
        while True:
            try:
                run_until_exit(board, table, joints, log)
                return
            except Exception as error:
                log.write(SEVERITY_ERROR, f"restarted after {error!r}", 0)
                # Before the pause: whatever went wrong, the servos must not hold on to it.
                joints.release()
                board.tone(0)
                board.log_error(error)
                pause(board, ERROR_PAUSE_MS)
    finally:
        joints.release()
        board.begin(False)


def pause(board: RobotBoard, time: int) -> None:
    """Wait, and keep the watchdog fed."""
    board.elapsed()
    while time > 0 and not board.exit_requested():
        board.feed_watchdog()
        board.wait(WAIT_MS)
        time -= board.elapsed()
