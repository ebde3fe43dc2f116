"""The robot's side of the protocol: PROTOCOL.md, sections 5 to 7. Times are in ms."""

from . import messages as m
from .board import RobotBoard
from .body import DinoBody
from .codec import pack, unpack
from .frames import FrameDecoder, TransmitBuffer, crc16

FIRMWARE = "dino 1"
"""Name and version of the firmware."""


class HostSession:
    """The robot's side of the protocol: one session, its commands and its failsafe."""

    def __init__(
        self, body: DinoBody, send_buffer: TransmitBuffer, name: str, board: RobotBoard
    ) -> None:
        self.number = 0
        """Number of the open session; 0 if none is."""
        self._body = body
        self._send_buffer = send_buffer
        self._name = name
        self._board = board
        self._decoder = FrameDecoder()
        self._reply = bytearray(m.MAX_BODY)
        self._host = 0
        self._taken = 0  # number of the last command, kept between sessions of the same host
        self._result = m.RESULT_TAKEN
        self._in_force = False
        self._beat = 0
        self._version = m.VERSION
        self._last_received = 0
        self._last_state = 0
        self._last_gone = -m.GONE_EVERY
        joints, sounds = body.joints.names(), body.sounds.names()
        self._names = (joints, body.motions, sounds, body.moods)
        self._catalogue = self._catalogue_crc()

    def receive(self, data: bytearray, count: int, now: int) -> None:
        """Process `count` received bytes at `now`."""
        # First the clock: after a hang, waiting bytes belong to a session that has ended.
        self.tick(now)
        decoder = self._decoder
        for index in range(count):
            size = decoder.feed(data[index])
            if size:
                values = unpack(decoder.body, size)
                if values is not None:
                    self._receive_message(values, now)

    def tick(self, now: int) -> None:
        """Do what is due at `now`: the failsafe and STATE."""
        if self.number and now - self._last_received >= m.FAILSAFE_AFTER:
            self._close()
        if self.number and now - self._last_state >= m.STATE_EVERY:
            self._send_state(now)

    def _receive_message(self, values: tuple[int, ...], now: int) -> None:
        kind, session = values[0], values[1]
        if kind == m.HELLO:
            if session:
                self._open(session, values[2], values[3], now)
            return
        if not self.number or session != self.number:
            if now - self._last_gone >= m.GONE_EVERY:
                self._last_gone = now
                self._send_buffer.put(self._reply, pack(self._reply, m.VERSION, m.GONE, session))
            return
        self._last_received = now
        if kind == m.BEAT:
            self._beat = values[2]
            self._send_state(now)
        elif kind == m.ASK:
            size = self._describe(values[2], values[3], self.number)
            if size:
                self._send_buffer.put(self._reply, size)
        elif kind == m.BYE:
            self._close()
        else:
            self._execute(kind, values)

    def _open(self, session: int, version: int, host: int, now: int) -> None:
        if host != self._host:
            if self._in_force:
                self._body.neutral()
            self._host, self._taken, self._in_force = host, 0, False
        if session != self.number:
            self.number, self._beat, self._last_state = session, 0, now
        self._last_received = now
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
        """Write an entry of the catalogue into `_reply`; return its size, 0 if there is none."""
        if item >= len(self._names) or index >= len(self._names[item]):
            return 0
        name = self._names[item][index].encode()
        if item == m.ITEM_JOINT:
            low, high, speed = self._body.joints.limits(index)
            return pack(self._reply, self._version, m.JOINT, session, index, low, high, speed, name)
        return pack(self._reply, self._version, m.NAME, session, item, index, name)

    def _catalogue_crc(self) -> int:
        """Return the CRC of the catalogue, which changes when an entry does."""
        register = 0xFFFF
        for item, names in enumerate(self._names):
            for index in range(len(names)):
                register = crc16(self._reply, 0, self._describe(item, index, 0), register)
        return register

    def _execute(self, kind: int, values: tuple[int, ...]) -> None:
        """Execute a command once, and acknowledge each of its repeats."""
        number = values[2]
        if number > self._taken:
            self._taken, self._in_force = number, True
            self._result = self._apply(kind, values)
        self._send(m.ACK, number, self._result)

    def _apply(self, kind: int, values: tuple[int, ...]) -> int:
        if kind == m.STOP:
            self._body.stop()
        elif kind == m.EXPRESS:
            valence, arousal, mood = values[3], values[4], values[5]
            if mood != m.NOTHING and mood >= len(self._body.moods):
                return m.RESULT_REFUSED
            self._body.express(valence, arousal, mood)
        else:
            item, index = values[3], values[4]
            if index >= len(self._names[item]):
                return m.RESULT_REFUSED
            if item == m.ITEM_MOTION:
                self._body.play_motion(index)
            else:
                self._body.play_sound(index)
        return m.RESULT_TAKEN

    def _send_state(self, now: int) -> None:
        self._last_state = now
        body = self._body
        joints = body.joints
        angles = [joints.mrad(index) for index in range(len(joints.angles))]
        flags = m.FLAG_STILL if body.stopped else 0
        if self._version >= 2:
            flags |= m.FLAG_RECKONED | (m.FLAG_LIMP if joints.limp else 0)
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

    def _close(self) -> None:
        self.number = 0
        self._in_force = False
        self._body.neutral()

    def _send(self, number: int, *fields: int | bytes) -> None:
        size = pack(self._reply, self._version, number, self.number, *fields)
        self._send_buffer.put(self._reply, size)
