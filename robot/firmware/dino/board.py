"""The interface of the boards that the firmware runs on; `hardware` has the real one."""


class RobotBoard:
    """A serial line, a clock, servos and a buzzer. Only `wait` blocks.

    MicroPython has no `abc`: a board without one of the first six methods fails when it is used.
    """

    def elapsed(self) -> int:
        """Return the time since the last call [whole ms]; 0 at the first."""
        raise NotImplementedError

    def wait(self, ms: int) -> None:
        """Wait for bytes, at most `ms` ms."""
        raise NotImplementedError

    def read(self, data: bytearray) -> int:
        """Read received bytes into `data`; return how many, 0 if there are none."""
        raise NotImplementedError

    def write(self, data: memoryview) -> int:
        """Write as many bytes as possible without blocking; return how many."""
        raise NotImplementedError

    def pulse(self, pin: int, us: int) -> None:
        """Set the pulse width of a servo [µs], 0 for no pulses; OSError if that fails."""
        raise NotImplementedError

    def tone(self, hertz: int) -> None:
        """Set the frequency of the buzzer; 0 for silence."""
        raise NotImplementedError

    def battery(self) -> int:
        """Return the charge of the battery in 1/10000; 10000 on mains."""
        return 10000

    def begin(self, program: bool) -> None:
        """Use the line for the program, or return it to the developer's prompt."""

    def exit_requested(self) -> bool:
        """Whether the program should end; called only while there is no session."""
        return False

    def start_watchdog(self) -> None:
        """Reboot from now on if `feed_watchdog` is not called for some seconds."""

    def feed_watchdog(self) -> None:
        """Restart the watchdog's time."""

    def log_error(self, error: BaseException) -> None:
        """Keep an error for the developer."""
