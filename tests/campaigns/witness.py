"""Who watches both ends of the wire during a campaign, and knows every promise.

The two ends are the product's own; a few of their methods tell the witness what they do.
"""

from collections import Counter
from typing import Any

from robot.catalogue import Catalogue, JointLimits
from robot.drivers.cubeling.commands import Command, CommandLane
from robot.drivers.cubeling.host import HostLink
from robot.drivers.cubeling.roundtrip import RoundTrip
from robot.emotion import Emotion
from robot.protocol import messages as m
from robot.protocol import timing
from robot.protocol.wire import FrameReader
from robot.simulators.cubeling.device import BodyState, DeviceLink
from robot.simulators.faulty import FaultyRobot

BIN = 0.0005
"""Width of a bin of the histogram of latencies [s]."""

BINS = 40_000
"""Bins of that histogram; the last one holds all that took longer."""

REMEMBERED = 4096
"""Frames and commands that are remembered, at least, to recognise them when they arrive."""

NEUTRAL = Emotion(0.0, 0.0)


class BrokenPromiseError(AssertionError):
    """A promise that was not kept."""


def emotion_of(serial: int) -> Emotion:
    """Return an emotion that can be told from all others, and put in order, when it is seen."""
    return Emotion((serial % 20001 - 10000) / 10000, (serial // 20001 - 10000) / 10000)


def serial_of(emotion: Emotion) -> int:
    """Undo `emotion_of`."""
    valence, arousal = round(emotion.valence * 10000), round(emotion.arousal * 10000)
    return valence + 10000 + 20001 * (arousal + 10000)


class Recent:
    """The last few thousand things, and perhaps twice as many."""

    def __init__(self) -> None:
        self._new: dict[Any, Any] = {}
        self._old: dict[Any, Any] = {}

    def put(self, key: Any, value: Any = None) -> None:
        """Remember it."""
        self._new[key] = value
        if len(self._new) >= REMEMBERED:
            self._old, self._new = self._new, {}

    def __contains__(self, key: Any) -> bool:
        return key in self._new or key in self._old

    def __getitem__(self, key: Any) -> Any:
        return self._new[key] if key in self._new else self._old[key]


class Witness:
    """Counts what happens, and raises BrokenPromiseError when a promise is broken."""

    def __init__(self) -> None:
        self.now = 0.0
        self.counts: Counter[str] = Counter()
        self.worst_failsafe = 0.0
        self.latencies = [0] * BINS
        self.asked = 0  # serial of the last emotion
        self.faulty: FaultyRobot | None = None
        self.frames = {"there": Recent(), "back": Recent()}
        self._asked_at: dict[int, float] = {}
        self._sent = Recent()  # (host, number) -> command
        self._taken: dict[int, int] = {}  # host -> its last number in this life of the robot
        self._played = (0, 0)  # host and number of the last action, in all lives of the robot
        self._shown = 0  # serial of the last emotion that took effect
        self._displaced = False  # whether the robot may have lost it since

    # --- The host's side -----------------------------------------------------------------------

    def asks(self) -> Emotion:
        """Return the next wish."""
        self.asked += 1
        self._asked_at[self.asked] = self.now
        if len(self._asked_at) > REMEMBERED:
            del self._asked_at[next(iter(self._asked_at))]
        return emotion_of(self.asked)

    def sends(self, host: int, command: Command) -> None:
        """See a command leave the host."""
        known = command.number if (host, command.number) in self._sent else None
        if known is not None and self._sent[host, command.number] != command:
            raise BrokenPromiseError(f"number {command.number} was given to two commands")
        self._sent.put((host, command.number), command)

    def sends_bytes(self, way: str, data: bytes) -> None:
        """See frames leave either end, to recognise them when they arrive."""
        recent = self.frames[way]
        for frame in data.split(b"\0"):
            if frame:
                recent.put(frame)

    # --- The robot's side ----------------------------------------------------------------------

    def reboots(self) -> None:
        """See the robot lose its memory."""
        self._displaced = True
        self._taken.clear()

    def goes_neutral(self) -> None:
        """See the robot give up the emotion."""
        self._displaced = True

    def carries_out(self, host: int, command: Command) -> None:
        """See a command take effect."""
        if (host, command.number) not in self._sent:
            raise BrokenPromiseError(f"{command} of host {host} was never sent")
        if self._sent[host, command.number] != command:
            raise BrokenPromiseError(f"{command} was sent as {self._sent[host, command.number]}")
        last = self._taken.get(host, 0)
        if command.number <= last:
            raise BrokenPromiseError(f"{command} takes effect after number {last}")
        self._taken[host] = command.number
        self.counts["taken"] += 1
        if isinstance(command, m.Play):
            if (host, command.number) <= self._played:
                raise BrokenPromiseError(f"{command} is played a second time")
            self._played = (host, command.number)
        elif isinstance(command, m.Express):
            self._shows(Emotion(command.valence, command.arousal))

    def _shows(self, emotion: Emotion) -> None:
        serial = serial_of(emotion)
        if not 1 <= serial <= self.asked:
            raise BrokenPromiseError(f"nobody asked for {emotion}")
        if serial < self._shown:
            raise BrokenPromiseError(f"emotion {serial} takes effect after {self._shown}")
        if serial == self._shown and not self._displaced:
            raise BrokenPromiseError(f"emotion {serial} takes effect twice")
        self._shown, self._displaced = serial, False
        asked_at = self._asked_at.pop(serial, None)
        if asked_at is not None:
            self.counts["emotions"] += 1
            self.latencies[min(int((self.now - asked_at) / BIN), BINS - 1)] += 1

    def falls_silent(self, heard: float, now: float) -> None:
        """See the robot act on the silence of its host."""
        self.counts["failsafe"] += 1
        assert self.faulty is not None
        if self.faulty.stalled_until <= heard:  # a robot that hangs cannot act before it wakes
            self.worst_failsafe = max(self.worst_failsafe, now - heard)
            self._in_time(now - heard)

    def looks(self, link: "WatchedLink", now: float) -> None:
        """See that no session lives on in silence."""
        if link.session:
            self._in_time(now - link.heard)

    def _in_time(self, silence: float) -> None:
        if silence > timing.FAILSAFE_PROMISE + 1e-6:
            raise BrokenPromiseError(
                f"the failsafe comes {1000 * silence:.1f} ms after the last message"
            )


class WatchedReader(FrameReader):
    """Notices a frame that is taken for whole and was never sent."""

    def __init__(self, witness: Witness, way: str) -> None:
        super().__init__()
        self._witness, self._sent = witness, witness.frames[way]

    def _finish(self) -> bytes | None:
        frame = bytes(self._pending)
        body = super()._finish()
        if body is None:
            self._witness.counts["detected"] += 1
        elif frame not in self._sent:
            self._witness.counts["undetected"] += 1
        return body


class WatchedLane(CommandLane):
    """Tells which command is sent, and which has been acknowledged."""

    def __init__(self, witness: Witness, host: int) -> None:
        super().__init__()
        self.witness, self.host = witness, host
        self.idle = True

    def next(self, now: float, retry_after: float) -> Command | None:
        command = super().next(now, retry_after)
        if command is not None:
            self.idle = False
            self.witness.sends(self.host, command)
        return command

    def land(self, number: int, result: int = m.TAKEN) -> None:
        flying = self._flight is not None
        super().land(number, result)
        if flying and self._flight is None:
            self.idle = True
            self.witness.counts["exchanges"] += 1


class WatchedRoundTrip(RoundTrip):
    """Counts the heartbeats that were answered."""

    def __init__(self, witness: Witness) -> None:
        super().__init__()
        self.witness = witness

    def stop(self, count: int, now: float) -> None:
        waiting = len(self._sent)
        super().stop(count, now)
        self.witness.counts["heartbeats"] += waiting - len(self._sent)


def watched_host(witness: Witness, host: int) -> HostLink:
    """Make a host's end whose commands, heartbeats and frames are seen."""
    link = HostLink(host)
    link._lane = WatchedLane(witness, host)
    link._round_trip = WatchedRoundTrip(witness)
    link._reader = WatchedReader(witness, "back")
    return link


class LightBody:
    """A body without physics."""

    catalogue = Catalogue(
        "Light", "campaign 1", (JointLimits("neck", -1.0, 1.0, 1.0),), ("nod", "bow"), ("purr",),
        ("neutral", "happy", "angry"),
    )  # fmt: skip

    def __init__(self, witness: Witness) -> None:
        self.witness = witness
        self.target = NEUTRAL

    def express(self, emotion: Emotion, mood: int) -> None:
        self.target = emotion

    def play(self, item: int, index: int) -> None:
        pass

    def stop(self) -> None:
        self.neutral()

    def neutral(self) -> None:
        self.target = NEUTRAL
        self.witness.goes_neutral()

    def state(self) -> BodyState:
        return BodyState(self.target, 0, 1.0, (0.0,))


class WatchedLink(DeviceLink):
    """A robot's end that tells what takes effect, and when it last heard of its host."""

    def __init__(self, witness: Witness) -> None:
        self.light = LightBody(witness)
        super().__init__(self.light)
        self.witness = witness
        self.heard = witness.now
        self._reader = WatchedReader(witness, "there")

    def tick(self, now: float) -> None:
        session = self.session
        super().tick(now)
        if session and not self.session:
            self.witness.falls_silent(self.heard, now)
            if self.light.target != NEUTRAL:
                raise BrokenPromiseError("the failsafe does not lead to neutral")

    def _take(self, session: int, message: Any, now: float) -> None:
        if isinstance(message, m.Hello) or (session and session == self.session):
            self.heard = now
        super()._take(session, message, now)

    def _carry_out(self, command: m.Express | m.Play | m.Stop) -> int:
        self.witness.carries_out(self._host, command)
        return super()._carry_out(command)


class LightRobot:
    """The campaign's robot: a `Simulated`."""

    edge = b"\0"

    def __init__(self, witness: Witness) -> None:
        self.witness = witness
        self.link = WatchedLink(witness)

    def receive(self, data: bytes, now: float) -> None:
        self.witness.now = now
        self.link.receive(data, now)
        self.witness.looks(self.link, now)

    def advance(self, now: float) -> None:
        self.witness.now = now
        self.link.tick(now)
        self.witness.looks(self.link, now)

    def bytes_to_send(self) -> bytes:
        data = self.link.bytes_to_send()
        if data:
            self.witness.sends_bytes("back", data)
        return data

    def reboot(self) -> None:
        self.witness.reboots()
        self.link = WatchedLink(self.witness)

    def portrait(self) -> tuple[float, str]:
        return self.link.light.target.valence, "light"
