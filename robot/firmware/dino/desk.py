"""A board that is none: a pseudo-terminal, this computer's clock, and servos that only remember.

For CPython, on a desk and in the tests; a microcontroller needs no copy of this file.
"""

import os
import select
import sys
import time
import traceback

from .board import Board


class Desk(Board):
    """A board on a desk. A client may come and go at `url`; `close` ends the program that runs.

    `run` belongs to one thread; `close` may be called from any other.
    """

    def __init__(self) -> None:
        import termios  # there is none on Windows
        import tty

        self._near, self._far = os.openpty()
        # The far end stays open here too, so that the line lives on when a client leaves.
        tty.setraw(self._far, termios.TCSANOW)
        os.set_blocking(self._near, False)
        self._alarm, self._bell = os.pipe()
        self.url = os.ttyname(self._far)
        """What pySerial opens to reach the robot."""
        self.pulses: dict[int, int] = {}
        """Pulse of every servo that has had one, by pin [µs]; 0 for none now."""
        self.hertz = 0
        """Tone of the buzzer; 0 for silence."""
        self.errors: list[BaseException] = []
        """What went wrong in the program, and was survived."""
        self._last = self._now()
        self._closing = False

    def elapsed(self) -> int:
        """Return the time since this was last asked [whole ms]."""
        now = self._now()
        elapsed, self._last = now - self._last, now
        return elapsed

    def wait(self, ms: int) -> None:
        """Wait for bytes; end the program if the desk is closed."""
        select.select([self._near, self._alarm], [], [], ms / 1000)
        if self._closing:
            raise SystemExit

    def read(self, data: bytearray) -> int:
        """Put the bytes that have come into `data`; return how many."""
        try:
            received = os.read(self._near, len(data))
        except BlockingIOError:
            return 0
        data[: len(received)] = received
        return len(received)

    def write(self, data: memoryview) -> int:
        """Give bytes to the line; return how many it has taken at once."""
        try:
            return os.write(self._near, data)
        except BlockingIOError:
            return 0

    def pulse(self, pin: int, us: int) -> None:
        """Remember the pulse."""
        self.pulses[pin] = us

    def tone(self, hertz: int) -> None:
        """Remember the tone."""
        self.hertz = hertz

    def note(self, error: BaseException) -> None:
        """Keep an error, and print it."""
        self.errors.append(error)
        traceback.print_exception(error, file=sys.stderr)

    def close(self) -> None:
        """End the program; `give_back` when its thread has ended."""
        self._closing = True
        os.write(self._bell, b"!")

    def give_back(self) -> None:
        """Close the pseudo-terminal."""
        for descriptor in (self._near, self._far, self._alarm, self._bell):
            os.close(descriptor)

    def _now(self) -> int:
        return int(1000 * time.monotonic())
