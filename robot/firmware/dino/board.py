"""What the robot needs of the board that it runs on; `hardware` is a real one."""


class Board:
    """A line, a clock, servos and a buzzer. Nothing but `wait` waits."""

    def elapsed(self) -> int:
        """Return the time since this was last asked [whole ms]; 0 the first time."""
        raise NotImplementedError

    def wait(self, ms: int) -> None:
        """Wait for bytes, at most `ms` ms."""
        raise NotImplementedError

    def read(self, data: bytearray) -> int:
        """Put the bytes that have come into `data`; return how many, 0 if none have."""
        raise NotImplementedError

    def write(self, data: memoryview) -> int:
        """Give bytes to the line; return how many it has taken at once."""
        raise NotImplementedError

    def pulse(self, pin: int, us: int) -> None:
        """Give a servo pulses of this length [µs] from now on, 0 for none; OSError if it fails."""
        raise NotImplementedError

    def tone(self, hertz: int) -> None:
        """Let the buzzer sound; 0 for silence."""
        raise NotImplementedError

    def battery(self) -> int:
        """Return how full the battery is, in 1/10000; 10000 on mains."""
        return 10000

    def begin(self, program: bool) -> None:
        """Take the line for the program, or give it back to the developer's prompt."""

    def left(self) -> bool:
        """Whether somebody wants the program to end; asked only while no host is there."""
        return False

    def watch(self) -> None:
        """From now on, reboot if `feed` is not called for some seconds."""

    def feed(self) -> None:
        """Say that the program lives."""

    def note(self, error: BaseException) -> None:
        """Keep an error for the developer."""
