"""The monitor of both ends of the wire in a campaign: it checks every guarantee."""

from collections import Counter
from typing import Any, Protocol

from cubeling.affect import Emotion
from cubeling.robot.protocol import messages as m, timing
from cubeling.robot.simulators.faulty import FaultyRobot

BIN_WIDTH_S = 0.0005
"""Bin width of the histogram of latencies [s]."""

BIN_COUNT = 40_000
"""Bins of that histogram; the last one counts all longer latencies."""

MAX_REMEMBERED = 4096
"""Frames and commands that are remembered, at least, to recognise them at their arrival."""


class InvariantViolationError(AssertionError):
    """A violated guarantee."""


def emotion_of(serial: int) -> Emotion:
    """Return a unique emotion whose serial number can be recovered from it."""
    return Emotion((serial % 20001 - 10000) / 10000, (serial // 20001 - 10000) / 10000)


def serial_of(emotion: Emotion) -> int:
    """Return the serial number of an emotion of `emotion_of`."""
    valence, arousal = round(emotion.valence * 10000), round(emotion.arousal * 10000)
    return valence + 10000 + 20001 * (arousal + 10000)


class RecentItems:
    """The last few thousand items, up to twice as many."""

    def __init__(self) -> None:
        self._new: dict[Any, Any] = {}
        self._old: dict[Any, Any] = {}

    def put(self, key: Any, value: Any = None) -> None:
        """Remember it."""
        self._new[key] = value
        if len(self._new) >= MAX_REMEMBERED:
            self._old, self._new = self._new, {}

    def __contains__(self, key: Any) -> bool:
        return key in self._new or key in self._old

    def __getitem__(self, key: Any) -> Any:
        return self._new[key] if key in self._new else self._old[key]


class _Link(Protocol):
    session: int
    heard: float


class InvariantMonitor:
    """Counts events, and raises InvariantViolationError when a guarantee is violated."""

    def __init__(self) -> None:
        self.now = 0.0
        self.counts: Counter[str] = Counter()
        self.worst_failsafe = 0.0
        self.latencies = [0] * BIN_COUNT
        self.asked = 0  # serial of the last emotion
        self.faulty: FaultyRobot | None = None
        self.frames = {"there": RecentItems(), "back": RecentItems()}
        self._asked_at: dict[int, float] = {}
        self._sent = RecentItems()  # (host, number) -> command
        self._taken: dict[int, int] = {}  # host -> its last number in this life of the robot
        self._played = (0, 0)  # host and number of the last action, in all lives of the robot
        self._shown = 0  # serial of the last emotion that took effect
        self._displaced = False  # whether the robot may have lost it since

    # --- The host's side -----------------------------------------------------------------------

    def asks(self) -> Emotion:
        """Return the next emotion to request."""
        self.asked += 1
        self._asked_at[self.asked] = self.now
        if len(self._asked_at) > MAX_REMEMBERED:
            del self._asked_at[next(iter(self._asked_at))]
        return emotion_of(self.asked)

    def sends(self, host: int, command: m.Command) -> None:
        """Note that the host sends a command."""
        known = command.number if (host, command.number) in self._sent else None
        if known is not None and self._sent[host, command.number] != command:
            raise InvariantViolationError(f"number {command.number} was given to two commands")
        self._sent.put((host, command.number), command)

    def sends_bytes(self, way: str, data: bytes) -> None:
        """Note the frames that one end sends."""
        recent = self.frames[way]
        for frame in data.split(b"\0"):
            if frame:
                recent.put(frame)

    # --- The robot's side ----------------------------------------------------------------------

    def reboots(self) -> None:
        """Note that the robot lost its memory."""
        self._displaced = True
        self._taken.clear()

    def goes_neutral(self) -> None:
        """Note that the robot goes to neutral."""
        self._displaced = True

    def carries_out(self, host: int, command: m.Command) -> None:
        """Check a command that takes effect."""
        if (host, command.number) not in self._sent:
            raise InvariantViolationError(f"{command} of host {host} was never sent")
        if self._sent[host, command.number] != command:
            raise InvariantViolationError(
                f"{command} was sent as {self._sent[host, command.number]}"
            )
        last = self._taken.get(host, 0)
        if command.number <= last:
            raise InvariantViolationError(f"{command} takes effect after number {last}")
        self._taken[host] = command.number
        self.counts["taken"] += 1
        if isinstance(command, m.Play):
            if (host, command.number) <= self._played:
                raise InvariantViolationError(f"{command} is played a second time")
            self._played = (host, command.number)
        elif isinstance(command, m.Express):
            self._shows(Emotion(command.valence, command.arousal))

    def _shows(self, emotion: Emotion) -> None:
        serial = serial_of(emotion)
        if not 1 <= serial <= self.asked:
            raise InvariantViolationError(f"nobody requested {emotion}")
        if serial < self._shown:
            raise InvariantViolationError(f"emotion {serial} takes effect after {self._shown}")
        if serial == self._shown and not self._displaced:
            raise InvariantViolationError(f"emotion {serial} takes effect twice")
        self._shown, self._displaced = serial, False
        asked_at = self._asked_at.pop(serial, None)
        if asked_at is not None:
            self.counts["emotions"] += 1
            self.latencies[min(int((self.now - asked_at) / BIN_WIDTH_S), BIN_COUNT - 1)] += 1

    def falls_silent(self, heard: float, now: float) -> None:
        """Check the failsafe's time."""
        self.counts["failsafe"] += 1
        assert self.faulty is not None
        if self.faulty.stalled_until <= heard:  # a robot that hangs cannot act before it wakes
            self.worst_failsafe = max(self.worst_failsafe, now - heard)
            self._in_time(now - heard)

    def looks(self, link: _Link, now: float) -> None:
        """Check that no session stays open in silence."""
        if link.session:
            self._in_time(now - link.heard)

    def _in_time(self, silence: float) -> None:
        if silence > timing.FAILSAFE_PROMISE + 1e-6:
            raise InvariantViolationError(
                f"the failsafe comes {1000 * silence:.1f} ms after the last message"
            )
