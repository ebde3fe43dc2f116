"""The fault mixes of a campaign: single faults, several, and too many."""

from dataclasses import dataclass

from cubeling.robot.simulators.faults import Faults, faults_of


@dataclass(frozen=True)
class FaultMix:
    """A mix of faults."""

    name: str
    """Name on the command line and in the table."""

    options: str
    """The faults, as in a simulator's URL."""

    share: float
    """Weight of its share of the exchanges."""

    within: float = 3.0
    """Longest time from the last request until the robot does and acknowledges it [s]."""

    host_lives: float | None = None
    """Mean time until the host's program ends or is killed, and restarts [s]."""

    @property
    def faults(self) -> Faults:
        """The faults, parsed."""
        options = dict(option.split("=") for option in self.options.split("&"))
        return faults_of(self.name, options)


FAULT_MIXES = (
    FaultMix("clean", "delay=1ms", 12),
    FaultMix("drop", "drop=0.05&delay=1ms", 14),
    FaultMix("drop hard", "drop=0.2&delay=1ms", 6),
    FaultMix("flip", "flip=0.001&delay=1ms", 12),
    FaultMix("flip hard", "flip=0.01&delay=1ms", 5),
    FaultMix("dup", "dup=0.1&delay=1ms", 8),
    FaultMix("split", "split=0.3&delay=1ms", 6),
    FaultMix("babble", "babble=500&delay=1ms", 6),
    FaultMix("babble hard", "babble=5000&delay=1ms", 3),
    FaultMix("slow", "delay=20ms~10ms", 4),
    FaultMix("very slow", "delay=80ms~20ms", 1, 5.0),
    FaultMix("stall", "stall=1s/1s&delay=1ms", 6, 5.0),
    FaultMix("unplug", "unplug=1s/700ms&delay=1ms", 6, 8.0),
    FaultMix("reboot", "reboot=700ms&delay=1ms", 6),
    FaultMix("restart", "delay=1ms", 6, 3.0, 0.7),
    FaultMix(
        "all",
        "drop=0.05&flip=0.001&dup=0.02&delay=20ms&stall=1s&unplug=30s",
        3,
        15.0,
        host_lives=60.0,
    ),
    FaultMix(
        "harsh",
        "drop=0.2&flip=0.004&dup=0.1&split=0.3&babble=1000&delay=20ms~15ms"
        "&stall=700ms/5s&unplug=10s/1s&reboot=10s",
        1,
        60.0,
        host_lives=20.0,
    ),
)
"""All mixes. Every channel has a delay, as virtual time would not pass otherwise."""
