"""What is known of a robot: what was requested, what it confirmed, and what it does."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Literal

from cubeling.affect import Emotion

MAX_COMPLAINT_CHARS = 80
"""Longest error message of a robot that is kept [characters]."""

MAX_LOG_LINES = 16
"""Lines of a robot's log that are kept: the latest."""

Severity = Literal["information", "warning", "error"]

LinkState = Literal["connecting", "ready", "degraded", "lost", "closed"]
"""connecting: the port is open and the robot has not answered yet. ready: it answers.
degraded: it has been silent for 150 ms, or a command needed three sends. lost: it has been silent
for 500 ms, or the port is gone; the link keeps trying. closed: `close()` was called."""


@dataclass(frozen=True)
class LinkCounts:
    """Counts of one link since it was made."""

    frames_sent: int = 0
    """Frames sent, retries included."""

    frames_received: int = 0
    """Frames of the open session with a right checksum."""

    retries: int = 0
    """Commands sent again because no acknowledgement arrived in time."""

    crc_errors: int = 0
    """Stretches of bytes that were no valid frame: noise, or a frame with wrong bits."""

    skipped: int = 0
    """Valid frames that were ignored: unknown, malformed, echoed, late, or of another session."""

    refused: int = 0
    """Commands that the robot acknowledged but refused."""

    dropped: int = 0
    """Motions and sounds given up, by a stop or a lost link, before they were acknowledged."""

    discarded: int = 0
    """Bytes discarded unread, because the robot exceeded the rate limit."""

    sessions: int = 0
    """Sessions opened; each after the first is a reconnection."""


@dataclass(frozen=True)
class LogLine:
    """A line of a robot's log."""

    number: int
    """Counts the lines that arrived over this link, from 1."""

    severity: Severity
    """How bad it is."""

    text: str
    """What happened, in the robot's own words: any characters, so show it as `literal_text`."""

    timestamp: float
    """When the robot wrote it, on the link's clock [s]."""

    lost: int = 0
    """Lines before this one that did not arrive."""


@dataclass(frozen=True)
class ClockEstimate:
    """What is known of a robot's clock."""

    drift: float
    """How much faster it runs than the link's clock, as a ratio; 0 in the first seconds."""

    error: float
    """Bound of the error of `Telemetry.measured_at` [s]."""


@dataclass(frozen=True)
class Telemetry:
    """What is known of the robot now."""

    state: LinkState
    """State of the link."""

    commanded: Emotion | None = None
    """The emotion requested last; None before the first, and after a stop."""

    acknowledged: Emotion | None = None
    """The emotion that the robot confirmed last; it stays while the next one is on its way. None
    before the first, after a confirmed stop, and when the robot may have lost it: after a lost
    link, a restart, or an error that it reports.

    A robot that knows only words has taken every emotion that is requested while its word plays."""

    observed: Emotion | None = None
    """The emotion that the robot last reported to show, with its own word; None before its first
    report."""

    battery: float | None = None
    """Charge from 0, empty, to 1, full."""

    charging: bool = False
    """Whether the battery is being charged."""

    stopped: bool = False
    """Whether the robot holds its neutral pose after `stop()`."""

    limp: bool = False
    """Whether its motors have no power: it accepts every command, and nothing moves."""

    joints: Mapping[str, float] = field(default_factory=lambda: MappingProxyType({}))
    """Joint angles by name [rad]."""

    reckoned: bool = False
    """Whether `joints` are calculated from the commands because the robot cannot measure them."""

    held: frozenset[str] = frozenset()
    """Joints that `Robot.move` holds."""

    measured_at: float | None = None
    """When all that the robot reports was so, on the link's clock [s]; None if it has no clock."""

    clock: ClockEstimate | None = None
    """The robot's clock, or None."""

    log: tuple[LogLine, ...] = ()
    """The last lines of its log, the oldest first; at most `MAX_LOG_LINES`."""

    complaint: str | None = None
    """The last error message of the robot in its own words, "file not found", "low power", or the
    command that it refused and why, "nod: refused, its battery is low"; at most
    `MAX_COMPLAINT_CHARS` printable characters. None before the first, and after it has taken
    another mood or a stop. None for a robot without error messages."""

    motion: str | None = None
    """The motion that is playing, or None."""

    sound: str | None = None
    """The sound that is playing, or None."""

    round_trip: float | None = None
    """Smoothed time from BEAT to STATE [s]."""

    silence: float | None = None
    """Time since the last valid data from the robot [s], the age of everything above; None before
    the first."""

    counts: LinkCounts = field(default_factory=LinkCounts)
    """Counts of the link."""

    @property
    def label(self) -> str | None:
        """The robot's own word for what it shows: "neutral", "happy", "angry" and so on."""
        return None if self.observed is None else self.observed.word


def complaint_of(line: str) -> str:
    r"""Return a robot's error message as `Telemetry.complaint` holds it.

    >>> complaint_of("MC_GetMotorStatus Failed:\tjoint 14\r")
    'MC_GetMotorStatus Failed: joint 14'
    """
    words = "".join(char if char.isprintable() else " " for char in line).split()
    return " ".join(words)[:MAX_COMPLAINT_CHARS]
