"""The robot's side of the protocol: PROTOCOL.md, sections 5 to 7. Times are in ms."""

from . import messages as m
from .board import RobotBoard
from .body import DinoBody
from .codec import pack, unpack
from .frames import FrameDecoder, TransmitBuffer, crc16
from .log import LogQueue

FIRMWARE = "dino 1"
"""Name and version of the firmware."""

LOW_BATTERY = 500
"""Charge below which it plays no motion and moves no joint [1/10000]: a servo that starts then
would reboot the board."""


class HostSession:
    """The robot's side of the protocol: one session, its commands and its failsafe."""

    def __init__(
        self,
        body: DinoBody,
        send_buffer: TransmitBuffer,
        name: str,
        board: RobotBoard,
        log: LogQueue,
    ) -> None:
        self.number = 0
        """Number of the open session; 0 if none is."""
        self._body = body
        self._send_buffer = send_buffer
        self._name = name
        self._board = board
        self._log = log
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
        self._last_log = -m.LOG_EVERY
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
        """Do what is due at `now`: the failsafe, STATE and LOG."""
        # No LOG while others wait: a slow line is for STATE and ACK.
        idle = not self._send_buffer.end
        if self.number and now - self._last_received >= m.FAILSAFE_AFTER:
            self._close()
        if self.number and now - self._last_state >= m.STATE_EVERY:
            self._send_state(now)
        if self.number and self._version >= 3 and idle and now - self._last_log >= m.LOG_EVERY:
            self._send_log(now)

    def _send_log(self, now: int) -> None:
        line = self._log.pop()
        if line:
            self._last_log = now
            self._send(m.LOG, *line)

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
            self._execute(kind, values, now)

    def _open(self, session: int, version: int, host: int, now: int) -> None:
        if host != self._host:
            if self._in_force:
                self._body.neutral()
            self._host, self._taken, self._in_force = host, 0, False
            self._result = m.RESULT_TAKEN
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
            m.ABILITY_MOVE,
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

    def _execute(self, kind: int, values: tuple[int, ...], now: int) -> None:
        """Execute a command once, and acknowledge each of its repeats."""
        number = values[2]
        if number > self._taken:
            self._taken, self._in_force = number, True
            self._result = self._apply(kind, values, now)
        result = self._result
        if self._version < 3:
            result = min(result, m.RESULT_REFUSED)  # there are no other reasons
        self._send(m.ACK, number, result)

    def _apply(self, kind: int, values: tuple[int, ...], now: int) -> int:
        """Obey a command, or return why not."""
        body, number = self._body, values[2]
        if kind == m.STOP:
            body.stop()
        elif kind == m.EXPRESS:
            valence, arousal, mood = values[3], values[4], values[5]
            if mood != m.NOTHING and mood >= len(body.moods):
                return self._refuse(m.RESULT_REFUSED, f"EXPRESS {number}: no mood {mood}", now)
            body.express(valence, arousal, mood)
        elif kind == m.MOVE:
            return self._move(values, now)
        else:
            item, index = values[3], values[4]
            if index >= len(self._names[item]):
                what = "motion" if item == m.ITEM_MOTION else "sound"
                return self._refuse(m.RESULT_REFUSED, f"PLAY {number}: no {what} {index}", now)
            if item == m.ITEM_SOUND:
                body.play_sound(index)
                return m.RESULT_TAKEN
            unable = self._unable()
            if unable == m.RESULT_TAKEN:
                body.play_motion(index)
            return unable
        return m.RESULT_TAKEN

    def _move(self, values: tuple[int, ...], now: int) -> int:
        number, duration, released, moved = values[2:6]
        joints = self._body.joints
        count, bits = len(joints.angles), released | moved
        if bits >> count:
            beyond = 15
            while not bits >> beyond & 1:
                beyond -= 1
            return self._refuse(m.RESULT_REFUSED, f"MOVE {number}: no joint {beyond}", now)
        for index in range(count):
            low, high, _ = joints.limits(index)
            angle = values[6 + index]
            if moved >> index & 1 and not low <= angle <= high:
                text = f"MOVE {number}: joint {index} not to {angle} mrad"
                return self._refuse(m.RESULT_OUT_OF_RANGE, text, now)
        unable = self._unable()
        if unable == m.RESULT_TAKEN:
            self._body.move(released, moved, values[6 : 6 + count], duration)
        return unable

    def _unable(self) -> int:
        """Return why nothing can be moved now; `RESULT_TAKEN` if it can."""
        if self._body.joints.failed:
            return m.RESULT_MOTORS_OFF
        if self._board.battery() < LOW_BATTERY:
            return m.RESULT_LOW_BATTERY
        return m.RESULT_TAKEN

    def _refuse(self, result: int, text: str, now: int) -> int:
        """Log what is wrong with a command, and return its result."""
        self._log.write(m.SEVERITY_WARNING, text, now)
        return result

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
            now & 0xFFFFFFFF,
            self._result,
            body.held,
        )

    def _close(self) -> None:
        self.number = 0
        self._in_force = False
        self._body.neutral()

    def _send(self, number: int, *fields: int | bytes) -> None:
        size = pack(self._reply, self._version, number, self.number, *fields)
        self._send_buffer.put(self._reply, size)
