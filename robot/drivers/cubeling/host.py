"""The host's end of the protocol: bytes in, bytes out, and what is known of the robot.

No clock, no thread, no port: whoever owns those calls `receive` and `tick` with the time.

A link greets (HELLO), asks for the catalogue, and then is open. Silence, a GONE, or a command that
is never acknowledged makes it greet again, under the next session number, for as long as it lives.
"""

from dataclasses import replace
from typing import Any, Literal

from affect import Emotion
from robot.contract.catalogue import Catalogue
from robot.contract.telemetry import LinkCounts, LinkState, Telemetry
from robot.drivers.cubeling.commands import CommandLane
from robot.drivers.cubeling.introduction import Introduction
from robot.drivers.cubeling.roundtrip import RoundTrip
from robot.drivers.cubeling.view import view_of
from robot.protocol import messages as m
from robot.protocol import timing
from robot.protocol.fields import MessageError
from robot.protocol.schema import pack, unpack
from robot.protocol.wire import FrameReader, encode_frame

Phase = Literal["port", "greeting", "asking", "open", "closed"]


class HostLink:
    """The host's end of the protocol.

    Parameters
    ----------
    host
        A number for the life of this program, not 0. A robot that knows it from an earlier session
        does not take a command twice.
    session
        Number of the first session, not 0; each later one is the next.
    """

    def __init__(self, host: int, session: int = 1) -> None:
        self.catalogue: Catalogue | None = None
        """What the robot has; None until it has said so."""
        self._host = host
        self._session = session - 1
        self._phase: Phase = "port"
        self._lane = CommandLane()
        self._round_trip = RoundTrip()
        self._reader = FrameReader()
        self._out = bytearray()
        self._introduction: Introduction | None = None
        self._state: m.State | None = None
        self._heard: float | None = None
        self._asked = 0.0  # when the last HELLO or ASK was sent
        self._beat_sent = 0.0
        self._version = timing.VERSION
        self._frames_sent = self._skipped = self._sessions = 0

    # --- What the owner asks for ---------------------------------------------------------------

    def express(self, emotion: Emotion) -> None:
        """Ask for an emotion; only the latest counts, and it is kept through every break."""
        self._lane.express(emotion)

    def play(self, item: int, index: int) -> bool:
        """Ask for a motion or a sound once; False if too many wait already.

        Without a session it is dropped at once: nobody wants a nod when the robot comes back.
        """
        if self._phase != "open":
            self._lane.dropped += 1
            return True
        return self._lane.play(item, index)

    def stop(self) -> None:
        """Ask for the neutral pose, before and instead of everything that waits."""
        self._lane.stop()

    def port_opened(self, now: float) -> None:
        """Begin, or begin again after `port_lost`."""
        self._greet(now)

    def port_lost(self) -> None:
        """Send nothing until `port_opened`."""
        self._lane.break_off()
        self._phase = "port"
        self._out.clear()

    def close(self) -> None:
        """Say goodbye if a session is open, and never send again."""
        if self._phase in ("asking", "open"):
            self._send(m.Bye())
        self._lane.break_off()
        self._phase = "closed"

    # --- What the line and the clock bring -----------------------------------------------------

    def receive(self, data: bytes, now: float) -> None:
        """Take bytes from the line at time `now` [s]."""
        for body in self._reader.feed(data):
            try:
                session, message = unpack(body, "robot")
            except MessageError:
                session, message = 0, None
            if message is None or session != self._session or self._phase in ("port", "closed"):
                self._skipped += 1
            else:
                self._heard = now
                self._take(message, now)

    def tick(self, now: float) -> None:
        """Do what is due at time `now` [s]: greet, ask, beat, send and send again."""
        if self._phase in ("asking", "open") and (
            self._silence(now) >= timing.LOST_AFTER or self._lane.exhausted
        ):
            self._greet(now)
        if self._phase == "greeting" and now - self._asked >= timing.HELLO_EVERY:
            self._hello(now)
        if self._phase == "asking" and now - self._asked >= self._round_trip.retry_after:
            self._ask(now)
        if self._phase == "open":
            self._command(now)
        if self._phase in ("asking", "open") and now - self._beat_sent >= timing.BEAT_EVERY:
            self._beat_sent = now
            self._send(m.Beat(self._round_trip.start(now)))

    def bytes_to_send(self) -> bytes:
        """Return what is to be written to the line, once."""
        data = bytes(self._out)
        self._out.clear()
        return data

    # --- What is known -------------------------------------------------------------------------

    def state(self, now: float) -> LinkState:
        """Return the state of the link at time `now` [s]; see `LinkState`."""
        if self._phase == "closed":
            return "closed"
        if self._phase != "open":
            return "connecting" if self.catalogue is None else "lost"
        silence = self._silence(now)
        if silence >= timing.LOST_AFTER:
            return "lost"
        shaky = silence >= timing.DEGRADED_AFTER or self._lane.tries >= timing.DEGRADED_TRIES
        return "degraded" if shaky else "ready"

    def telemetry(self, now: float) -> Telemetry:
        """Return all that is known at time `now` [s]."""
        link = Telemetry(
            state=self.state(now),
            commanded=self._lane.commanded,
            acknowledged=self._lane.acknowledged,
            round_trip=self._round_trip.smoothed,
            silence=None if self._heard is None else self._silence(now),
            counts=self._counts(),
        )
        return view_of(link, self._state, self.catalogue)

    def _counts(self) -> LinkCounts:
        return LinkCounts(
            frames_sent=self._frames_sent,
            frames_received=self._reader.frames,
            retries=self._lane.retries,
            crc_errors=self._reader.errors,
            skipped=self._skipped,
            refused=self._lane.refused,
            dropped=self._lane.dropped,
            sessions=self._sessions,
        )

    # --- Sessions ------------------------------------------------------------------------------

    def _greet(self, now: float) -> None:
        self._lane.break_off()
        self._phase = "greeting"
        self._session = self._session % 0xFFFF + 1
        self._hello(now)

    def _hello(self, now: float) -> None:
        self._asked = now
        self._send(m.Hello(timing.VERSION, self._host))

    def _take(self, message: Any, now: float) -> None:
        match message:
            case m.Welcome() if self._phase == "greeting" and message.version <= timing.VERSION:
                self._begin(message, now)
            case m.Joint() | m.Name() if self._phase == "asking":
                if self._introduction is not None and self._introduction.answer(message):
                    self._ask(now)
            case m.Gone() if self._phase != "greeting":
                self._greet(now)
            case m.State():
                self._state = message
                self._round_trip.stop(message.beat, now)
                self._lane.land(message.taken)  # as good as an ACK that was lost
            case m.Ack():
                self._lane.land(message.number, message.result)
        if self._phase == "open":
            self._command(now)

    def _begin(self, welcome: m.Welcome, now: float) -> None:
        """Open the session; ask for the catalogue unless this robot has told it before."""
        known = self._introduction
        self._sessions += 1
        self._version = welcome.version
        self._beat_sent = now - timing.BEAT_EVERY
        self._lane.resume(welcome.taken)
        if self.catalogue is not None and known is not None and (
            replace(known.welcome, taken=0) == replace(welcome, taken=0)
        ):  # fmt: skip
            self._phase = "open"
            return
        self.catalogue = self._state = None
        self._introduction = Introduction(welcome)
        self._phase = "asking"
        self._ask(now)

    def _ask(self, now: float) -> None:
        """Ask the next question of the introduction; open the session after the last answer."""
        assert self._introduction is not None
        question = self._introduction.question()
        if question is None:
            self.catalogue = self._introduction.catalogue()
            self._lane.moods = self.catalogue.moods
            self._phase = "open"
            return
        self._asked = now
        self._send(question)

    # --- Small things --------------------------------------------------------------------------

    def _command(self, now: float) -> None:
        command = self._lane.next(now, self._round_trip.retry_after)
        if command is not None:
            self._send(command)

    def _silence(self, now: float) -> float:
        return now - self._heard if self._heard is not None else 0.0

    def _send(self, message: Any) -> None:
        self._out += encode_frame(pack(message, self._session, self._version))
        self._frames_sent += 1
