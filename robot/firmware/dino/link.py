"""The robot's end of the protocol, PROTOCOL.md sections 5 to 7. Times are in ms."""

from . import messages as m
from .board import Board
from .body import Body
from .codec import pack, unpack
from .frames import FrameReader, Outbox, crc16

FIRMWARE = "dino 1"
"""What runs on the robot, and which version."""


class Link:
    """One robot's end of the protocol. It has no clock: it is told the time.

    Parameters
    ----------
    body
        What the commands move.
    outbox
        Takes what is to be sent.
    name
        What the robot is called.
    board
        Knows how full the battery is.
    """

    def __init__(self, body: Body, outbox: Outbox, name: str, board: Board) -> None:
        self.session = 0
        """The open session; 0 when none is."""
        self._body = body
        self._outbox = outbox
        self._name = name
        self._board = board
        self._reader = FrameReader()
        self._answer = bytearray(m.MAX_BODY)
        self._host = 0
        self._taken = 0  # number of the last command, kept over sessions of the same host
        self._result = m.TAKEN
        self._in_force = False
        self._beat = 0
        self._version = m.VERSION
        self._heard = 0
        self._stated = 0
        self._last_gone = -m.GONE_EVERY
        joints, sounds = body.joints.names(), body.voice.names()
        self._names = (joints, body.motions, sounds, body.moods)
        self._catalogue = self._fingerprint()

    def receive(self, data: bytearray, count: int, now: int) -> None:
        """Take `count` bytes from the line at `now`."""
        # First the clock: bytes that waited while this robot hung belong to a session that is over.
        self.tick(now)
        reader = self._reader
        for index in range(count):
            size = reader.feed(data[index])
            if size:
                values = unpack(reader.body, size)
                if values is not None:
                    self._take(values, now)

    def tick(self, now: int) -> None:
        """Do what is due at `now`: the failsafe, and STATE in time."""
        if self.session and now - self._heard >= m.FAILSAFE_AFTER:
            self._end_session()
        if self.session and now - self._stated >= m.STATE_EVERY:
            self._send_state(now)

    def _take(self, values: tuple[int, ...], now: int) -> None:
        number, session = values[0], values[1]
        if number == m.HELLO:
            if session:
                self._greet(session, values[2], values[3], now)
            return
        if not self.session or session != self.session:
            if now - self._last_gone >= m.GONE_EVERY:
                self._last_gone = now
                self._outbox.put(self._answer, pack(self._answer, m.VERSION, m.GONE, session))
            return
        self._heard = now
        if number == m.BEAT:
            self._beat = values[2]
            self._send_state(now)
        elif number == m.ASK:
            size = self._describe(values[2], values[3], self.session)
            if size:
                self._outbox.put(self._answer, size)
        elif number == m.BYE:
            self._end_session()
        else:
            self._obey(number, values)

    def _greet(self, session: int, version: int, host: int, now: int) -> None:
        if host != self._host:
            if self._in_force:
                self._body.neutral()
            self._host, self._taken, self._in_force = host, 0, False
        if session != self.session:
            self.session, self._beat, self._stated = session, 0, now
        self._heard = now
        self._version = min(version, m.VERSION)
        counts = [len(names) for names in self._names]
        self._send(
            m.WELCOME,
            self._version,
            self._taken if self._in_force else 0,
            self._catalogue,
            *counts,
            self._name.encode(),
            FIRMWARE.encode(),
        )

    def _describe(self, item: int, index: int, session: int) -> int:
        """Write an entry of the catalogue into `_answer`; return its size, 0 if there is none."""
        if item >= len(self._names) or index >= len(self._names[item]):
            return 0
        name = self._names[item][index].encode()
        if item == m.ITEM_JOINT:
            low, high, speed = self._body.joints.limits(index)
            return pack(
                self._answer, self._version, m.JOINT, session, index, low, high, speed, name
            )
        return pack(self._answer, self._version, m.NAME, session, item, index, name)

    def _fingerprint(self) -> int:
        """Return the check of the whole catalogue: it changes when an entry does."""
        register = 0xFFFF
        for item, names in enumerate(self._names):
            for index in range(len(names)):
                register = crc16(self._answer, 0, self._describe(item, index, 0), register)
        return register

    def _obey(self, kind: int, values: tuple[int, ...]) -> None:
        """Take a command once, and acknowledge it as often as it comes."""
        number = values[2]
        if number > self._taken:
            self._taken, self._in_force = number, True
            self._result = self._carry_out(kind, values)
        self._send(m.ACK, number, self._result)

    def _carry_out(self, kind: int, values: tuple[int, ...]) -> int:
        if kind == m.STOP:
            self._body.stop()
        elif kind == m.EXPRESS:
            valence, arousal, mood = values[3], values[4], values[5]
            if mood != m.NOTHING and mood >= len(self._body.moods):
                return m.UNKNOWN
            self._body.express(valence, arousal, mood)
        else:
            item, index = values[3], values[4]
            if index >= len(self._names[item]):
                return m.UNKNOWN
            if item == m.ITEM_MOTION:
                self._body.play_motion(index)
            else:
                self._body.play_sound(index)
        return m.TAKEN

    def _send_state(self, now: int) -> None:
        self._stated = now
        body = self._body
        joints = body.joints
        angles = [joints.mrad(index) for index in range(len(joints.angles))]
        flags = m.STILL if body.still else 0
        if self._version >= 2:
            flags |= m.RECKONED | (m.LIMP if joints.limp else 0)
        self._send(
            m.STATE,
            self._beat,
            self._taken,
            flags,
            body.valence,
            body.arousal,
            self._board.battery(),
            body.mood,
            body.motion,
            body.sound,
            *angles,
            *(0,) * (m.JOINTS_MAX - len(angles)),
        )

    def _end_session(self) -> None:
        self.session = 0
        self._in_force = False
        self._body.neutral()

    def _send(self, number: int, *fields: int | bytes) -> None:
        size = pack(self._answer, self._version, number, self.session, *fields)
        self._outbox.put(self._answer, size)
