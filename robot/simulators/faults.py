"""The faults of a simulated robot, and how its URL names them.

The line of `sim:cubeling?drop=0.05&delay=20ms~5ms&stall=1s/10s&seed=7` loses every twentieth frame
and delays the others, and the robot stalls for a second about every ten. docs/faults.md explains
every option.
"""

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Final, NamedTuple

from cubeling.robot.errors import RobotError

DEFAULT_STALL_INTERVAL_S: Final = 20.0
"""Default mean time between stalls [s]."""

DEFAULT_UNPLUGGED_S: Final = 1.0
"""Default time for which the plug is out [s]."""

MAX_DELAY_S: Final = 10.0
"""Longest delay of a line [s]."""

MAX_NOISE_BYTES_PER_S: Final = 1e6
"""Most noise on a line [bytes/s]."""

LENGTH_RANGE_S: Final = (0.001, 3600.0)
"""Shortest and longest stall or unplugging [s]."""

INTERVAL_RANGE_S: Final = (0.1, 86400.0)
"""Shortest and longest mean time between two events [s]."""

Option = tuple[Callable[[str], dict[str, object]], str]
"""Reads the text of an option into fields of `Faults`, or raises ValueError; the allowed values."""


class Outage(NamedTuple):
    """A stall or an unplugging that recurs at random times (a Poisson process)."""

    length: float
    """Its length [s]."""

    every: float
    """Mean time from the end of one to the start of the next [s]; drawn exponentially."""


@dataclass(frozen=True)
class Faults:
    """The faults of a line and of the robot at its end.

    Probabilities and rates hold for each direction of the line separately.
    """

    drop: float = 0.0
    """Probability that a frame, or a line of text, is lost."""

    flip: float = 0.0
    """Probability per byte that one of its bits is flipped."""

    dup: float = 0.0
    """Probability that a frame arrives twice in succession."""

    split: float = 0.0
    """Probability that a frame arrives in two pieces, some milliseconds apart."""

    babble: float = 0.0
    """Noise between the frames, in bursts [bytes/s]."""

    delay: float = 0.0
    """Delay of every byte [s]."""

    jitter: float = 0.0
    """Largest deviation from the delay [s]; frames never overtake each other."""

    stall: Outage | None = None
    """The robot neither reads nor writes nor advances its clock."""

    unplug: Outage | None = None
    """The plug is pulled, and put in again."""

    reboot: float | None = None
    """Mean time between two reboots [s]."""


def faults_of(url: str, options: Mapping[str, str]) -> Faults:
    """Return the faults in the options of a simulator's URL.

    Raises RobotError for an unknown option, or a value that is not allowed.
    """
    fields: dict[str, object] = {}
    for name, text in options.items():
        if name not in OPTIONS:
            known = ", ".join(["seed", *OPTIONS])
            raise RobotError(f"{url!r}: {name!r} is no option of a simulator; there are {known}")
        read, allowed = OPTIONS[name]
        try:
            fields |= read(text)
        except ValueError:
            raise RobotError(f"{url!r}: {name} must be {allowed}, not {text!r}") from None
    return Faults(**fields)  # type: ignore[arg-type] # the readers below return its fields


def _number(text: str, low: float, high: float) -> float:
    if not re.fullmatch(r"(\d+\.?\d*|\.\d+)(e-?\d+)?", text, re.ASCII):
        raise ValueError
    value = float(text)
    if not low <= value <= high:
        raise ValueError
    return value


def _seconds(text: str, low: float, high: float) -> float:
    unit = {"ms": 1e-3}.get(text[-2:], 1.0)
    number = text.removesuffix("ms") if text.endswith("ms") else text.removesuffix("s")
    if number == text:
        raise ValueError
    return round(_number(number, low / unit, high / unit) * unit, 9)


def _probability(name: str) -> Option:
    return lambda text: {name: _number(text, 0.0, 1.0)}, "a probability from 0 to 1"


def _read_delay(text: str) -> dict[str, object]:
    mean, tilde, jitter = text.partition("~")
    delay = _seconds(mean, 0.0, MAX_DELAY_S)
    return {"delay": delay, "jitter": _seconds(jitter, 0.0, delay) if tilde else 0.0}


def _read_stall(text: str) -> dict[str, object]:
    length, slash, every = text.partition("/")
    mean = _seconds(every, *INTERVAL_RANGE_S) if slash else DEFAULT_STALL_INTERVAL_S
    return {"stall": Outage(_seconds(length, *LENGTH_RANGE_S), mean)}


def _read_unplug(text: str) -> dict[str, object]:
    every, slash, length = text.partition("/")
    out = _seconds(length, *LENGTH_RANGE_S) if slash else DEFAULT_UNPLUGGED_S
    return {"unplug": Outage(out, _seconds(every, *INTERVAL_RANGE_S))}


OPTIONS: Final[dict[str, Option]] = {
    "drop": _probability("drop"),
    "flip": _probability("flip"),
    "dup": _probability("dup"),
    "split": _probability("split"),
    "babble": (
        lambda text: {"babble": _number(text, 0.0, MAX_NOISE_BYTES_PER_S)},
        "bytes a second from 0 to 1000000, as in 200",
    ),
    "delay": (_read_delay, "a time up to 10s, as in 20ms, or 20ms~5ms with jitter within it"),
    "stall": (_read_stall, "how long, 1ms to 3600s, as in 1s, or 1s/10s with how often"),
    "unplug": (_read_unplug, "how often, 100ms to 86400s, as in 30s, or 30s/2s for how long"),
    "reboot": (
        lambda text: {"reboot": _seconds(text, *INTERVAL_RANGE_S)},
        "how often, 100ms to 86400s, as in 60s",
    ),
}
"""Every option except the seed."""
