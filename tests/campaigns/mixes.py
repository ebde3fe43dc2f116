"""What goes wrong in a campaign: one fault at a time, several, and too many."""

from dataclasses import dataclass

from robot.simulators.faults import Faults, faults_of


@dataclass(frozen=True)
class Mix:
    """One mixture of faults."""

    name: str
    """What it is called on the command line and in the table."""

    options: str
    """The faults, as in a simulator's URL."""

    share: float
    """Its part of the exchanges; the parts of all mixes are weighed against each other."""

    within: float = 3.0
    """Longest time from the last wish to the robot that does it, and is known to [s]."""

    host_lives: float | None = None
    """Mean time until the host's program is ended or killed, and started again [s]."""

    @property
    def faults(self) -> Faults:
        """The same, read."""
        options = dict(option.split("=") for option in self.options.split("&"))
        return faults_of(self.name, options)


MIXES = (
    Mix("clean", "delay=1ms", 12),
    Mix("drop", "drop=0.05&delay=1ms", 14),
    Mix("drop hard", "drop=0.2&delay=1ms", 6),
    Mix("flip", "flip=0.001&delay=1ms", 12),
    Mix("flip hard", "flip=0.01&delay=1ms", 5),
    Mix("dup", "dup=0.1&delay=1ms", 8),
    Mix("split", "split=0.3&delay=1ms", 6),
    Mix("babble", "babble=500&delay=1ms", 6),
    Mix("babble hard", "babble=5000&delay=1ms", 3),
    Mix("slow", "delay=20ms~10ms", 4),
    Mix("very slow", "delay=80ms~20ms", 1, 5.0),
    Mix("stall", "stall=1s/1s&delay=1ms", 6, 5.0),
    Mix("unplug", "unplug=1s/700ms&delay=1ms", 6, 8.0),
    Mix("reboot", "reboot=700ms&delay=1ms", 6),
    Mix("restart", "delay=1ms", 6, 3.0, 0.7),
    Mix(
        "all",
        "drop=0.05&flip=0.001&dup=0.02&delay=20ms&stall=1s&unplug=30s",
        3,
        15.0,
        host_lives=60.0,
    ),
    Mix(
        "harsh",
        "drop=0.2&flip=0.004&dup=0.1&split=0.3&babble=1000&delay=20ms~15ms"
        "&stall=700ms/5s&unplug=10s/1s&reboot=10s",
        1,
        60.0,
        host_lives=20.0,
    ),
)
"""All of them. Every line is at least a little slow, or virtual time would not pass."""
