"""The host side of the protocol, without clock, thread or port.

A link sends HELLO, asks for the catalogue, and is open then. Silence, a GONE, or a command that is
never acknowledged starts a new session with the next number, for as long as the link exists.
"""

from collections.abc import Sized
from dataclasses import replace
from pathlib import Path
from typing import Any, Literal

from cubeling.affect import Emotion
from cubeling.robot.contract.catalogue import Catalogue, JointLimits
from cubeling.robot.contract.driver import Driver, DriverKind
from cubeling.robot.contract.moves import JointMove, JointMover
from cubeling.robot.contract.port import SendBuffer
from cubeling.robot.contract.telemetry import LinkCounts, LinkState, Telemetry
from cubeling.robot.drivers.cubeling.reports import RobotReports
from cubeling.robot.drivers.cubeling.scheduler import Action, CommandScheduler, RoundTrip
from cubeling.robot.errors import RobotError
from cubeling.robot.protocol import messages as m, timing
from cubeling.robot.protocol.fields import MessageError
from cubeling.robot.protocol.schema import pack, unpack
from cubeling.robot.protocol.wire import FrameReader, encode_frame

Phase = Literal["port", "greeting", "asking", "open", "closed"]
"""port: there is none. greeting: HELLO was sent. asking: the catalogue is incomplete."""


class HostLink(SendBuffer):
    """The host side of one link; a `Driver`.

    `host` is a number for the life of this program, not 0: a robot that knows it from an earlier
    session does not take a command twice. `session` is the number of the first session, not 0.
    """

    def __init__(self, host: int, session: int = 1) -> None:
        super().__init__()
        self.catalogue: Catalogue | None = None
        """What the robot has; None until it is known."""
        self.scheduler = CommandScheduler()
        """The commands."""
        self.round_trip = RoundTrip()
        """Measures the round trip."""
        self.reader = FrameReader()
        """Decodes the received frames."""
        self._host = host
        # `_greet` counts on before it sends, so the first session is `session`.
        self._session = session - 1
        self._phase: Phase = "port"
        self._query: CapabilityQuery | None = None
        self._reports = RobotReports()
        self._last_received: float | None = None
        self._last_asked = 0.0  # when the last HELLO or ASK was sent
        self._beat_due = 0.0
        self._version = timing.VERSION
        self._frames_sent = self._skipped = self._sessions = 0

    def express(self, emotion: Emotion) -> None:
        """Request an emotion; only the latest counts, and it is kept over all sessions."""
        self.scheduler.express(emotion)

    def play(self, item: int, index: int) -> bool:
        """Request a motion or a sound once; return False if too many wait already."""
        return self._request(m.Play(0, item, index))

    @property
    def joint_mover(self) -> JointMover | None:
        """The link itself, if the robot takes MOVE."""
        able = self._query is not None and self._query.welcome.abilities & m.ABILITY_MOVE
        return self if able else None

    def move(self, move: JointMove) -> bool:
        """Request a move once; return False if too many wait already."""
        moved, released = (sum(1 << one for one in some) for some in (move.angles, move.released))
        angles = tuple(move.angles.get(index, 0.0) for index in range(m.JOINTS_MAX))
        return self._request(m.Move(0, move.duration, released, moved, angles))

    def stop(self) -> None:
        """Request the neutral pose, before and instead of everything that waits."""
        self.scheduler.stop()

    def port_opened(self, now: float) -> None:
        """Greet the robot with HELLO: a new session begins."""
        self._greet(now)

    def port_lost(self) -> None:
        """Send nothing until `port_opened`."""
        self.scheduler.end_session()
        self._phase = "port"
        # What waits belongs to the session that ended with the port; the next one begins with
        # HELLO.
        self._out.clear()

    def close(self) -> None:
        """Send BYE if a session is open, and nothing afterwards."""
        if self._phase in ("asking", "open"):
            self._send(m.Bye())
        self.scheduler.end_session()
        self._phase = "closed"

    def receive(self, data: bytes, now: float) -> None:
        """Process received bytes at time `now` [s]."""
        for body in self.reader.feed(data):
            try:
                session, message = unpack(body, "robot")
            except MessageError:
                session, message = 0, None
            # An answer to an earlier session may come late; taken for this one, it would
            # acknowledge a
            # command that was never received.
            if message is None or session != self._session or self._phase in ("port", "closed"):
                self._skipped += 1
            else:
                self._last_received = now
                self._process(message, now)

    def tick(self, now: float) -> None:
        """Do what is due at time `now` [s]: HELLO, ASK, BEAT, commands and retries."""
        if self._phase in ("asking", "open") and (
            # A robot that answers BEATs but never acknowledges is as lost as one that is silent.
            self._silence(now) >= timing.LOST_AFTER or self.scheduler.exhausted
        ):
            self._greet(now)
        if self._phase == "greeting" and now - self._last_asked >= timing.HELLO_EVERY:
            self._hello(now)
        if self._phase == "asking" and now - self._last_asked >= self.round_trip.retry_after:
            self._ask(now)
        if self._phase == "open":
            self._send_command(now)
        if self._phase in ("asking", "open") and now >= self._beat_due:
            # From the time when it was due, so that a late BEAT does not delay those after it.
            self._beat_due += timing.BEAT_EVERY
            if self._beat_due <= now:  # after a hang: no burst
                self._beat_due = now + timing.BEAT_EVERY
            self._send(m.Beat(self.round_trip.start(now)))

    def state(self, now: float) -> LinkState:
        """Return the state of the link at time `now` [s]; see `LinkState`."""
        if self._phase == "closed":
            return "closed"
        if self._phase != "open":
            return "connecting" if self.catalogue is None else "lost"
        silence = self._silence(now)
        if silence >= timing.LOST_AFTER:
            return "lost"
        shaky = silence >= timing.DEGRADED_AFTER or self.scheduler.tries >= timing.DEGRADED_TRIES
        return "degraded" if shaky else "ready"

    def telemetry(self, now: float) -> Telemetry:
        """Return everything that is known at time `now` [s]."""
        scheduler = self.scheduler
        link = Telemetry(
            state=self.state(now),
            commanded=scheduler.state.commanded,
            acknowledged=scheduler.state.acknowledged,
            round_trip=self.round_trip.smoothed,
            silence=None if self._last_received is None else self._silence(now),
            counts=LinkCounts(
                frames_sent=self._frames_sent,
                frames_received=self.reader.frames,
                retries=scheduler.retries,
                crc_errors=self.reader.errors,
                skipped=self._skipped,
                refused=scheduler.refused,
                dropped=scheduler.actions.dropped,
                sessions=self._sessions,
            ),
        )
        return self._reports.describe(link, self.catalogue, scheduler.refusal)

    def _request(self, action: Action) -> bool:
        if self._phase != "open":
            self.scheduler.actions.dropped += 1
            return True
        return self.scheduler.add(action)

    def _greet(self, now: float) -> None:
        self.scheduler.end_session()
        self._phase = "greeting"
        # 1…65535, again and again: 0 is no session on the wire.
        self._session = self._session % 0xFFFF + 1
        self._hello(now)

    def _hello(self, now: float) -> None:
        self._last_asked = now
        self._send(m.Hello(timing.VERSION, self._host))

    def _process(self, message: Any, now: float) -> None:
        match message:
            case m.Welcome() if self._phase == "greeting" and message.version <= timing.VERSION:
                self._begin(message, now)
            case m.Joint() | m.Name() if self._phase == "asking":
                if self._query is not None and self._query.answer(message):
                    self._ask(now)
            # While greeting it answers an older frame; a second HELLO would only restart the first.
            case m.Gone() if self._phase != "greeting":
                self._greet(now)
            case m.State():
                sent = self.round_trip.stop(message.beat, now)
                self._reports.take_state(message, self._version, sent, now)
                # It replaces an ACK that was lost.
                self.scheduler.acknowledge(message.taken, message.result)
            case m.Log():
                self._reports.take_log(message, now)
            case m.Ack():
                self.scheduler.acknowledge(message.number, message.result)
        if self._phase == "open":
            self._send_command(now)

    def _begin(self, welcome: m.Welcome, now: float) -> None:
        """Open the session; ask for the catalogue unless it is known already."""
        last = self._query
        self._sessions += 1
        self._version = welcome.version
        self._beat_due = now
        self._reports.start_session()
        # Before the catalogue: commands that the robot took in the last session are not sent twice.
        self.scheduler.start_session(welcome.taken)
        if self.catalogue is not None and last is not None and (
            # The same robot as before but for the last command taken: its catalogue need not be
            # read again.
            replace(last.welcome, taken=0) == replace(welcome, taken=0)
        ):  # fmt: skip
            self._phase = "open"
            return
        self.catalogue = None
        self._reports.forget_state()
        self._query = CapabilityQuery(welcome)
        self._phase = "asking"
        self._ask(now)

    def _ask(self, now: float) -> None:
        """Ask the next question; open the session after the last answer."""
        assert self._query is not None
        question = self._query.question()
        if question is None:
            self.catalogue = self._query.catalogue()
            self.scheduler.moods = self.catalogue.moods
            self._phase = "open"
            return
        self._last_asked = now
        self._send(question)

    def _send_command(self, now: float) -> None:
        command = self.scheduler.next(now, self.round_trip.retry_after)
        if command is not None:
            self._send(command)

    def _silence(self, now: float) -> float:
        return now - self._last_received if self._last_received is not None else 0.0

    def _send(self, message: Any) -> None:
        self._out += encode_frame(pack(message, self._session, self._version))
        self._frames_sent += 1


def _make(host: int, settings: Path | None) -> Driver:
    if settings is not None:
        raise RobotError(f"{settings}: the protocol 'cubeling' has no settings; leave them out")
    # Not from session 1: an answer to an earlier program may still arrive, and a robot that missed
    # our HELLO is in that program's session.
    return HostLink(host, session=host % 0xFFFF + 1)


CUBELING = DriverKind(_make, timing.BAUD, timing.ANSWER_WITHIN)
"""Drivers of robots that speak the protocol of `robot/PROTOCOL.md`."""


class CapabilityQuery:
    """The questions for a catalogue after one WELCOME, one at a time."""

    def __init__(self, welcome: m.Welcome) -> None:
        self.welcome = welcome
        """The message with the number of entries."""
        self._counts = (welcome.joints, welcome.motions, welcome.sounds, welcome.moods)
        self._joints: list[JointLimits] = []
        self._names: tuple[list[str], list[str], list[str]] = ([], [], [])

    def question(self) -> m.Ask | None:
        """Return the next question; None when everything was answered."""
        known: tuple[Sized, ...] = (self._joints, *self._names)
        for item, (entries, count) in enumerate(zip(known, self._counts, strict=True)):
            if len(entries) < count:
                return m.Ask(item, len(entries))
        return None

    def answer(self, entry: m.Joint | m.Name) -> bool:
        """Process an answer; return False unless it answers the current question."""
        item = m.ITEM_JOINT if isinstance(entry, m.Joint) else entry.item
        if self.question() != m.Ask(item, entry.index):
            return False
        if isinstance(entry, m.Joint):
            self._joints.append(JointLimits(entry.name, entry.low, entry.high, entry.speed))
        else:
            self._names[entry.item - m.ITEM_MOTION].append(entry.name)
        return True

    def catalogue(self) -> Catalogue:
        """Return the catalogue of all answers."""
        motions, sounds, moods = (tuple(names) for names in self._names)
        return Catalogue(
            self.welcome.name, self.welcome.firmware, tuple(self._joints), motions, sounds, moods
        )
