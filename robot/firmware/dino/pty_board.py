"""A board on a pseudo-terminal: this computer's clock, and servos that only record.

For CPython and the tests; a microcontroller does not need this file.
"""

import os
import select
import sys
import time
import traceback

from .board import RobotBoard
from .robot import run
from .table import ServoTable


class PtyBoard(RobotBoard):
    """A board on a pseudo-terminal; `close`, from any thread, ends the running firmware.

    Clients can open and close the port at `url` at any time.
    """

    def __init__(self) -> None:
        import termios  # not on Windows
        import tty

        self._master, self._slave = os.openpty()
        # The far end stays open here too, so the line survives the end of a client.
        tty.setraw(self._slave, termios.TCSANOW)
        os.set_blocking(self._master, False)
        self._wake_reader, self._wake_writer = os.pipe()
        self.url = os.ttyname(self._slave)
        """The port to open with pySerial."""
        self.pulses: dict[int, int] = {}
        """Pulse width of every servo used so far, by pin [µs]; 0 for no pulses."""
        self.hertz = 0
        """Frequency of the buzzer; 0 for silence."""
        self.errors: list[BaseException] = []
        """Errors of the firmware that it recovered from."""
        self._last = int(1000 * time.monotonic())
        self._closing = False

    def elapsed(self) -> int:
        """Return the time since the last call [whole ms]."""
        now = int(1000 * time.monotonic())
        elapsed, self._last = now - self._last, now
        return elapsed

    def wait(self, ms: int) -> None:
        """Wait for bytes; raise SystemExit after `close`."""
        select.select([self._master, self._wake_reader], [], [], ms / 1000)
        if self._closing:
            raise SystemExit

    def read(self, data: bytearray) -> int:
        """Read received bytes into `data`; return how many."""
        try:
            received = os.read(self._master, len(data))
        except BlockingIOError:
            return 0
        data[: len(received)] = received
        return len(received)

    def write(self, data: memoryview) -> int:
        """Write as many bytes as possible without blocking; return how many."""
        try:
            return os.write(self._master, data)
        except BlockingIOError:
            return 0

    def pulse(self, pin: int, us: int) -> None:
        """Record the pulse width."""
        self.pulses[pin] = us

    def tone(self, hertz: int) -> None:
        """Record the frequency of the buzzer [Hz]; 0 is silence."""
        self.hertz = hertz

    def log_error(self, error: BaseException) -> None:
        """Keep an error, and print it."""
        self.errors.append(error)
        traceback.print_exception(error, file=sys.stderr)

    def close(self) -> None:
        """End the firmware; call `release` when its thread has ended."""
        self._closing = True
        os.write(self._wake_writer, b"!")

    def release(self) -> None:
        """Close both ends of the pseudo-terminal and the pipe that wakes it."""
        for descriptor in (self._master, self._slave, self._wake_reader, self._wake_writer):
            os.close(descriptor)


def run_on_pty(table: ServoTable) -> None:
    """Run the firmware on a pseudo-terminal until Ctrl-C, and print the name of its port."""
    try:
        board = PtyBoard()
    except (ImportError, AttributeError):
        sys.exit("this system has no pseudo-terminals: use a board, or sim:cubeling")
    sys.stdout.write(f"{board.url}\n")
    sys.stdout.flush()
    try:
        run(board, table)
    except KeyboardInterrupt:
        board.release()
