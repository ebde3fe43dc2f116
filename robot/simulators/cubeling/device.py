"""The robot side of the protocol, without clock, thread or port: it commands a body."""

from collections import deque
from dataclasses import replace
from typing import Any, Protocol

from cubeling.affect import Emotion
from cubeling.robot.contract.catalogue import Catalogue
from cubeling.robot.contract.port import SendBuffer
from cubeling.robot.protocol import messages as m, timing
from cubeling.robot.protocol.fields import MessageError
from cubeling.robot.protocol.schema import pack, spec_of, unpack
from cubeling.robot.protocol.wire import FrameReader, crc16, encode_frame


class SimulatedBody(Protocol):
    """What the protocol commands."""

    catalogue: Catalogue
    """What the robot has."""

    def express(self, emotion: Emotion, mood: int) -> None:
        """Show an emotion; the mood is an index of the catalogue, or `NOTHING`: choose one."""

    def play(self, item: int, index: int) -> None:
        """Play a motion or a sound of the catalogue."""

    def move(self, command: m.Move) -> None:
        """Let go of some joints, then turn others and hold them; all are of the catalogue."""

    def stop(self) -> None:
        """End everything, let go of all joints, and hold the neutral pose."""

    def neutral(self) -> None:
        """Do so without the stop, and return to the neutral emotion: the host is gone."""

    def refusal(self) -> int:
        """Return why no motion and no joint can be moved now; `RESULT_TAKEN` if they can."""

    def state(self) -> m.State:
        """Return the current state; the link sets `beat`, `taken`, `time` and `result`."""


class DeviceLink(SendBuffer):
    """The robot side of one link. A reboot is a new `DeviceLink`."""

    def __init__(self, body: SimulatedBody) -> None:
        super().__init__()
        self.body = body
        self.session = 0
        """The open session; 0 when none is."""
        self.host = 0
        """Number of the host that was heard last; 0 before the first."""
        self.last_command = 0
        """Number of the last command; it survives the sessions of the same host."""
        self.last_received = 0.0
        """Time of the last message of the session [s]."""
        self._result = m.RESULT_TAKEN
        self._in_force = False
        self._beat = 0
        self.version = timing.VERSION
        """The version agreed at the last HELLO."""
        self._state_sent = 0.0
        self._gone_sent = float("-inf")
        self._log_sent = float("-inf")
        self._booted: float | None = None
        self.log = SimulatedLogQueue()
        """What it has to say to its owner."""
        self.log.write(m.SEVERITY_INFO, "started", 0)
        self.reader = FrameReader()
        """Decodes the received frames."""

    def receive(self, data: bytes, now: float) -> None:
        """Process received bytes at time `now` [s]."""
        # First the clock: bytes that waited during a stall belong to a session that is over.
        self.tick(now)
        for body in self.reader.feed(data):
            try:
                session, message = unpack(body, "host")
            except MessageError:
                continue
            if message is not None:
                self.process(session, message, now)

    def tick(self, now: float) -> None:
        """Do what is due at time `now` [s]: the failsafe, STATE and LOG."""
        if self._booted is None:
            self._booted = now
        if self.session and now - self.last_received >= timing.FAILSAFE_AFTER:
            self._end_session()
        if self.session and now - self._state_sent >= timing.STATE_EVERY:
            self._send_state(now)
        if self.session and self.version >= 3 and now - self._log_sent >= timing.LOG_EVERY:
            self._send_log(now)

    def process(self, session: int, message: Any, now: float) -> None:
        """Process one message of a session at time `now` [s]."""
        if isinstance(message, m.Hello):
            if session:
                self._greet(session, message, now)
            return
        if not self.session or session != self.session:
            self._refuse(session, now)
            return
        self.last_received = now
        match message:
            case m.Beat():
                self._beat = message.count
                self._send_state(now)
            case m.Ask():
                self._describe(message)
            case m.Bye():
                self._end_session()
            case m.Express() | m.Play() | m.Stop() | m.Move():
                self.obey(message)

    def _greet(self, session: int, hello: m.Hello, now: float) -> None:
        if hello.host != self.host:
            if self._in_force:
                self.body.neutral()
            self.host, self.last_command, self._in_force = hello.host, 0, False
            self._result = m.RESULT_TAKEN
        if session != self.session:
            self.session, self._beat, self._state_sent = session, 0, now
        self.last_received = now
        self.version = min(hello.version, timing.VERSION)
        catalogue = self.body.catalogue
        welcome = m.Welcome(
            version=self.version,
            taken=self.last_command if self._in_force else 0,
            catalogue=crc16(repr(catalogue).encode()),
            joints=len(catalogue.joints),
            motions=len(catalogue.motions),
            sounds=len(catalogue.sounds),
            moods=len(catalogue.moods),
            name=catalogue.name,
            firmware=catalogue.firmware,
            abilities=m.ABILITY_MOVE,
        )
        self._send(welcome)

    def _describe(self, ask: m.Ask) -> None:
        catalogue = self.body.catalogue
        if ask.item == m.ITEM_JOINT:
            if ask.index < len(catalogue.joints):
                joint = catalogue.joints[ask.index]
                self._send(m.Joint(ask.index, joint.low, joint.high, joint.speed, joint.name))
            return
        names = entry_names(catalogue, ask.item)
        if ask.index < len(names):
            self._send(m.Name(ask.item, ask.index, names[ask.index]))

    def obey(self, command: m.Command) -> None:
        """Execute a command once, and acknowledge it each time that it arrives."""
        if command.number > self.last_command:
            self.last_command, self._in_force = command.number, True
            self._result = self.execute(command)
        result = self._result if self.version >= 3 else min(self._result, m.RESULT_REFUSED)
        self._send(m.Ack(command.number, result))

    def execute(self, command: m.Command) -> int:
        """Command the body, and return the result for the acknowledgement."""
        result, detail = refusal(command, self.body.catalogue)
        if detail:
            self.log.write(m.SEVERITY_WARNING, detail, self._time(self.last_received))
        match command:
            case _ if result != m.RESULT_TAKEN:
                return result
            case m.Express():
                self.body.express(Emotion(command.valence, command.arousal), command.mood)
            case m.Play(item=m.ITEM_MOTION) | m.Move() if self.body.refusal() != m.RESULT_TAKEN:
                return self.body.refusal()
            case m.Play():
                self.body.play(command.item, command.index)
            case m.Move():
                self.body.move(command)
            case m.Stop():
                self.body.stop()
        return m.RESULT_TAKEN

    def _send_state(self, now: float) -> None:
        self._state_sent = now
        state = self.body.state()
        flags = state.flags
        if self.version < 2:
            flags &= m.FLAG_CHARGING | m.FLAG_STILL  # version 1 has no others
        known = replace(state, beat=self._beat, taken=self.last_command, result=self._result)
        self._send(replace(known, flags=flags, time=self._time(now)))

    def _time(self, now: float) -> int:
        """Return the robot's clock at time `now` [s]: whole milliseconds since it booted."""
        assert self._booted is not None
        return round(1000 * (now - self._booted)) & 0xFFFFFFFF

    def _send_log(self, now: float) -> None:
        line = self.log.pop()
        if line is not None:
            self._log_sent = now
            self._send(line)

    def _refuse(self, session: int, now: float) -> None:
        if now - self._gone_sent >= timing.GONE_EVERY:
            self._gone_sent = now
            self._out += encode_frame(pack(m.Gone(), session))

    def _end_session(self) -> None:
        self.session = 0
        self._in_force = False
        self.body.neutral()

    def _send(self, message: Any) -> None:
        self._out += encode_frame(pack(message, self.session, self.version))


MAX_WAITING_LINES = 8
"""Lines that wait; when there are more, the new ones are dropped and counted."""

_TEXT_BYTES = spec_of(m.Log).fields[-1].size


class SimulatedLogQueue:
    """The first lines that were written and not yet sent."""

    def __init__(self) -> None:
        self._waiting: deque[m.Log] = deque()
        self._count = 0

    def write(self, severity: int, text: str, time: int) -> None:
        """Write a line at `time` of the robot's clock [ms]; a long one is shortened."""
        self._count = (self._count + 1) & 0xFFFF
        if len(self._waiting) < MAX_WAITING_LINES:
            text = text.encode()[:_TEXT_BYTES].decode(errors="ignore")
            self._waiting.append(m.Log(self._count, time, severity, text))

    def pop(self) -> m.Log | None:
        """Return the next line, once; None if none waits."""
        return self._waiting.popleft() if self._waiting else None


TAKEN = (m.RESULT_TAKEN, "")


def entry_names(catalogue: Catalogue, item: int) -> tuple[str, ...]:
    """Return the names of the motions, sounds or moods; none for another item."""
    lists = {
        m.ITEM_MOTION: catalogue.motions,
        m.ITEM_SOUND: catalogue.sounds,
        m.ITEM_MOOD: catalogue.moods,
    }
    return lists.get(item, ())


def refusal(command: m.Command, catalogue: Catalogue) -> tuple[int, str]:
    """Return the result of a command, and for its owner what is wrong with it."""
    match command:
        case m.Express(mood=mood) if m.NOTHING > mood >= len(catalogue.moods):
            return m.RESULT_REFUSED, f"EXPRESS {command.number}: no mood {mood}"
        case m.Play(item=item, index=index) if index >= len(entry_names(catalogue, item)):
            what = "motion" if item == m.ITEM_MOTION else "sound"
            return m.RESULT_REFUSED, f"PLAY {command.number}: no {what} {index}"
        case m.Move():
            return _move_refusal(command, catalogue)
    return TAKEN


def _move_refusal(command: m.Move, catalogue: Catalogue) -> tuple[int, str]:
    bits = command.moved | command.released
    if bits >> len(catalogue.joints):
        return m.RESULT_REFUSED, f"MOVE {command.number}: no joint {bits.bit_length() - 1}"
    for index, joint in enumerate(catalogue.joints):
        # In counts of the wire, as a host knows the limits from JOINT alone.
        angle, low, high = (
            round(1000 * one) for one in (command.angles[index], joint.low, joint.high)
        )
        if command.moved >> index & 1 and not low <= angle <= high:
            what = f"MOVE {command.number}: joint {index} not to {angle} mrad"
            return m.RESULT_OUT_OF_RANGE, what
    return TAKEN
