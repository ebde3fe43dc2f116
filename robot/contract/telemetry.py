"""What is known of a robot now: what was asked, what it confirmed, and what it does."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Literal

from affect.emotion import Emotion

COMPLAINT_MAX = 80
"""Longest complaint that is passed on [characters]."""

LinkState = Literal["connecting", "ready", "degraded", "lost", "closed"]
"""connecting: the port is open, and the robot has not answered yet. ready: it answers.
degraded: it has been silent for 150 ms, or a command needed three sends. lost: it has been silent
for 500 ms, or the port is gone; the link keeps trying. closed: `close()` was called."""


@dataclass(frozen=True)
class LinkCounts:
    """What went over the wire since the link was made."""

    frames_sent: int = 0
    """Frames sent, repeats included."""

    frames_received: int = 0
    """Frames received whole."""

    retries: int = 0
    """Commands sent again because no acknowledgement came in time."""

    crc_errors: int = 0
    """Stretches of bytes that were no frame: noise, or a frame with wrong bits."""

    skipped: int = 0
    """Whole frames not understood or not of this session: unknown, malformed, echoed or late."""

    refused: int = 0
    """Commands that the robot acknowledged but refused."""

    dropped: int = 0
    """Motions and sounds given up, by a stop or a lost link, before they were acknowledged."""

    discarded: int = 0
    """Bytes thrown away unread, because the robot sent more than any robot has to say."""

    sessions: int = 0
    """Sessions opened; every one after the first is a reconnection."""


@dataclass(frozen=True)
class Telemetry:
    """What is known of the robot now."""

    state: LinkState
    """State of the link."""

    commanded: Emotion | None = None
    """What `express` last asked for; None before."""

    acknowledged: Emotion | None = None
    """What the robot last confirmed to have taken; it stays while the next is on its way. None
    before, after a stop was confirmed, and once the robot may have lost it: with the link, by a
    restart, or because it said that it has not done what it was asked.

    A robot that knows only words has taken every emotion that is asked for while its word plays."""

    observed: Emotion | None = None
    """What the robot last said that it shows; None before it said anything."""

    label: str | None = None
    """The robot's own word for what it shows, "neutral", "happy", "angry" …"""

    battery: float | None = None
    """From empty, 0, to full, 1."""

    charging: bool = False
    """Whether the battery is being charged."""

    stopped: bool = False
    """Whether the robot holds its neutral pose after `stop()`."""

    limp: bool = False
    """Whether its motors have no power: it takes every command, and nothing moves."""

    joints: Mapping[str, float] = field(default_factory=lambda: MappingProxyType({}))
    """Angles by name [rad]."""

    reckoned: bool = False
    """Whether `joints` are where they should be by now, because the robot cannot measure them."""

    complaint: str | None = None
    """What the robot last complained of, in its own words: "file not found", "low power"; at most
    `COMPLAINT_MAX` characters, all of which can be printed. None before, and once it has taken
    another mood or a stop since. None for a robot that has no words for it."""

    motion: str | None = None
    """The motion being played; None when it stands still."""

    sound: str | None = None
    """The sound being played; None when it is quiet."""

    round_trip: float | None = None
    """Time from BEAT to STATE, smoothed [s]."""

    silence: float | None = None
    """Time since the robot was last heard [s]; None before it was. Everything above is so old."""

    counts: LinkCounts = field(default_factory=LinkCounts)
    """What went over the wire."""


def complaint_of(line: str) -> str:
    r"""Return what a robot's line complains of, as `Telemetry.complaint` has it.

    >>> complaint_of("MC_GetMotorStatus Failed:\tjoint 14\r")
    'MC_GetMotorStatus Failed: joint 14'
    """
    words = "".join(one if one.isprintable() else " " for one in line).split()
    return " ".join(words)[:COMPLAINT_MAX]
