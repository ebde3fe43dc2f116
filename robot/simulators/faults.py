"""What may go wrong with a simulated robot, and how it is written in a URL.

`sim:cubeling?drop=0.05&delay=20ms~5ms&stall=1s/10s&seed=7` is a robot whose line loses every
twentieth frame and delays the others, and that hangs for a second about every ten. docs/faults.md
explains every option.
"""

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Final, NamedTuple

from robot.errors import RobotError

STALL_EVERY: Final = 20.0
"""How often a robot hangs if its URL does not say [s]."""

UNPLUGGED_FOR: Final = 1.0
"""How long the plug is out if the URL does not say [s]."""

DELAY_MAX: Final = 10.0
"""Longest delay of a line [s]."""

BABBLE_MAX: Final = 1e6
"""Most noise on a line [bytes/s]."""

LENGTH_RANGE: Final = (0.001, 3600.0)
"""How long a robot may hang, or its plug be out [s]."""

EVERY_RANGE: Final = (0.1, 86400.0)
"""How often something may befall it [s]."""


class Spell(NamedTuple):
    """Something that befalls a robot again and again, at moments that nobody foresees."""

    length: float
    """How long it lasts [s]."""

    every: float
    """Mean time from the end of one to the begin of the next [s]; drawn exponentially."""


@dataclass(frozen=True)
class Faults:
    """What goes wrong on the way to a simulated robot and back, and with the robot itself.

    Chances and rates hold for each direction of the line by itself.
    """

    drop: float = 0.0
    """Chance that a frame, or line of text, is lost."""

    flip: float = 0.0
    """Chance of each byte that one of its bits is wrong."""

    dup: float = 0.0
    """Chance that a frame comes twice, one straight behind the other."""

    split: float = 0.0
    """Chance that a frame comes in two pieces, some milliseconds apart."""

    babble: float = 0.0
    """Noise between the frames, in bursts of some bytes [bytes/s]."""

    delay: float = 0.0
    """How late every byte arrives [s]."""

    jitter: float = 0.0
    """How much earlier or later than that a frame arrives at most [s]; none overtakes another."""

    stall: Spell | None = None
    """The robot hangs: it neither reads nor writes nor looks at its clock."""

    unplug: Spell | None = None
    """The plug is pulled, and put in again."""

    reboot: float | None = None
    """Mean time between two reboots of the robot [s]."""


class Option(NamedTuple):
    """One option of a simulator's URL."""

    read: Callable[[str], dict[str, object]]
    """Turns its text into fields of `Faults`; raises ValueError if it is not allowed."""

    allowed: str
    """What may stand there, in words."""


def faults_of(url: str, options: Mapping[str, str]) -> Faults:
    """Read the faults from the options of a simulator's URL.

    Raises
    ------
    RobotError
        In one line, for an option that there is not, or a value that is not allowed.
    """
    fields: dict[str, object] = {}
    for name, text in options.items():
        option = OPTIONS.get(name)
        if option is None:
            known = ", ".join(["seed", *OPTIONS])
            raise RobotError(f"{url!r}: {name!r} is no option of a simulator; there are {known}")
        try:
            fields |= option.read(text)
        except ValueError:
            raise RobotError(f"{url!r}: {name} must be {option.allowed}, not {text!r}") from None
    return Faults(**fields)  # type: ignore[arg-type] # the readers below give what it takes


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


def _chance(name: str) -> Option:
    return Option(lambda text: {name: _number(text, 0.0, 1.0)}, "a chance from 0 to 1")


def _read_delay(text: str) -> dict[str, object]:
    middle, tilde, width = text.partition("~")
    delay = _seconds(middle, 0.0, DELAY_MAX)
    return {"delay": delay, "jitter": _seconds(width, 0.0, delay) if tilde else 0.0}


def _read_stall(text: str) -> dict[str, object]:
    length, slash, every = text.partition("/")
    mean = _seconds(every, *EVERY_RANGE) if slash else STALL_EVERY
    return {"stall": Spell(_seconds(length, *LENGTH_RANGE), mean)}


def _read_unplug(text: str) -> dict[str, object]:
    every, slash, length = text.partition("/")
    out = _seconds(length, *LENGTH_RANGE) if slash else UNPLUGGED_FOR
    return {"unplug": Spell(out, _seconds(every, *EVERY_RANGE))}


OPTIONS: Final[dict[str, Option]] = {
    "drop": _chance("drop"),
    "flip": _chance("flip"),
    "dup": _chance("dup"),
    "split": _chance("split"),
    "babble": Option(
        lambda text: {"babble": _number(text, 0.0, BABBLE_MAX)},
        "bytes a second from 0 to 1000000, as in 200",
    ),
    "delay": Option(_read_delay, "a time up to 10s, as in 20ms, or 20ms~5ms with jitter within it"),
    "stall": Option(_read_stall, "how long, 1ms to 3600s, as in 1s, or 1s/10s with how often"),
    "unplug": Option(_read_unplug, "how often, 100ms to 86400s, as in 30s, or 30s/2s for how long"),
    "reboot": Option(
        lambda text: {"reboot": _seconds(text, *EVERY_RANGE)},
        "how often, 100ms to 86400s, as in 60s",
    ),
}
"""Every option but the seed."""
