"""The signals that end a command: Ctrl-C, SIGTERM, and SIGHUP of a closed terminal."""

import signal
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

CTRL_C_EXIT_CODE = 130
"""Exit code of a command that Ctrl-C ended before its work was done: 128 + SIGINT."""

TERMINATION_SIGNALS = [
    getattr(signal, name) for name in ("SIGTERM", "SIGHUP") if hasattr(signal, name)
]
"""What else ends a command; Windows has no SIGHUP."""

ENDING_S = 1.0
"""A further signal within this time is no new request [s]: a service manager or a closed terminal
sends several. Later ones interrupt what still closes."""


class Termination:
    """Ends a command in good order, as Ctrl-C does, and remembers by which signal.

    A robot without a failsafe keeps its servos on if its connection is not closed. Commands may
    take Ctrl-C for their usual end; whoever terminates one wants to see that in its exit code.
    """

    def __init__(self) -> None:
        self.number: int | None = None
        """The first signal that came; None if none did."""
        self._last = -ENDING_S

    def watch(self) -> None:
        """Handle the signals from now on, except for those that are ignored, as under nohup."""
        for number in TERMINATION_SIGNALS:
            if signal.getsignal(number) is signal.SIG_DFL:
                signal.signal(number, self)

    def __call__(self, number: int, frame: FrameType | None) -> None:
        """Handle a signal: raise KeyboardInterrupt."""
        self.number = self.number or number
        now = time.monotonic()
        last, self._last = self._last, now
        if now - last >= ENDING_S:
            raise KeyboardInterrupt

    def exit_code(self, code: int) -> int:
        """Return 128 + the signal that ended the command, or the command's own code."""
        return code if self.number is None else 128 + self.number


termination = Termination()
"""That of this process."""


@contextmanager
def defer_interrupts() -> Iterator[None]:
    """Let Ctrl-C and a termination signal wait for the end of the block.

    A frame that is half encoded or half recorded would spoil the file. Signals reach only the main
    thread.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    waiting: list[int] = []
    handlers = {
        number: handler
        for number in (signal.SIGINT, *TERMINATION_SIGNALS)
        if callable(handler := signal.getsignal(number))
    }
    for number in handlers:
        signal.signal(number, lambda number, frame: waiting.append(number))
    try:
        yield
    finally:
        for number, handler in handlers.items():
            signal.signal(number, handler)
    if waiting:
        signal.raise_signal(waiting[0])
