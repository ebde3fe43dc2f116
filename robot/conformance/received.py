"""The bytes from the robot under test: split into frames, parsed and logged."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, fields, replace
from typing import Any, Literal

from cubeling.robot.protocol import messages as m, timing
from cubeling.robot.protocol.fields import MessageError
from cubeling.robot.protocol.schema import MESSAGES, pack, spec_of, unpack
from cubeling.robot.protocol.wire import MAX_FRAME, FrameError, decode_frame

MAX_STATES = 20_000
"""Most STATEs in a log: over ten minutes of them; and most LOGs."""

MAX_EXAMPLES = 3
"""Violations of each rule that are logged with their bytes; more are only counted."""

MAX_SHOWN_BYTES = 40
"""Most bytes of a frame in a report."""

Rule = Literal["frame", "session", "unasked", "edges", "padding"]
"""What a frame violates: it is not valid, of another session, sent unasked or out of order, without
an edge of its own, or has a text that is not padded with zero bytes."""

_WITH_TEXT = m.Welcome | m.Joint | m.Name | m.Log


@dataclass(frozen=True)
class ReceivedFrame:
    """A frame from the robot, valid or not."""

    timestamp: float
    """Arrival of its last byte [s]."""

    frame: bytes
    """Its bytes between the edges."""

    session: int = 0
    """The session in its header."""

    message: Any = None
    """Its message; None if it is not valid."""

    size: int = 0
    """Bytes of its body."""

    error: str = ""
    """Why it is not valid."""

    own_edges: bool = True
    """Whether it has an edge before it that does not also end the frame before."""

    padded: bool = True
    """Whether its texts are padded with zero bytes."""

    @property
    def name(self) -> str:
        """The message's name in PROTOCOL.md."""
        if self.message is None:
            return "an invalid frame"
        return spec_of(type(self.message)).name

    def __str__(self) -> str:
        if self.message is None:
            return f"[{format_bytes(self.frame)}], {self.error}"
        words = [
            f"{field.name}={getattr(self.message, field.name)}"
            for field in fields(self.message)
            if field.name not in ("joints", "firmware", "flags", "battery", "held")
        ]
        content = f"{self.name}({', '.join(words)}) in session {self.session}"
        return f"{content} [{format_bytes(self.frame)}]"


class FrameSplitter:
    """Splits a byte stream into frames; buffers at most one frame."""

    def __init__(self) -> None:
        self._buffer = bytearray()
        self._edge_seen = False  # bytes before the first edge may be half a frame
        self._own_edge = True

    def feed(self, data: bytes, now: float) -> Iterator[ReceivedFrame]:
        """Take bytes received at time `now` [s]; yield the frames that they complete."""
        *ended, rest = data.split(b"\0")
        for piece in ended:
            self._append(piece)
            frame = bytes(self._buffer)
            self._buffer.clear()
            if frame and self._edge_seen:
                yield replace(parse_frame(frame, now), own_edges=self._own_edge)
            self._own_edge = not (frame and self._edge_seen)
            self._edge_seen = True
        self._append(rest)

    def _append(self, piece: bytes) -> None:
        self._buffer += piece[: MAX_FRAME + 1 - len(self._buffer)]


def parse_frame(frame: bytes, now: float) -> ReceivedFrame:
    """Return a frame with its message, or with the reason why it has none."""
    try:
        body = decode_frame(frame)
        session, message = unpack(body, "robot")
    except (FrameError, MessageError) as error:
        return ReceivedFrame(now, frame, error=str(error))
    if message is None:
        spec = MESSAGES.get(body[0])
        reason = f"{body[0]:02X} is no message" if spec is None else f"{spec.name} is the host's"
        return ReceivedFrame(now, frame, session, error=reason)
    padded = not isinstance(message, _WITH_TEXT) or pack(message, session)[: len(body)] == body
    return ReceivedFrame(now, frame, session, message, len(body), padded=padded)


class FrameLog:
    """A record of everything that the robot sent, for the checks of all of it."""

    def __init__(self) -> None:
        self.states: list[tuple[float, m.State]] = []
        """Timestamp [s] and content of the STATEs of our sessions."""
        self.violations: dict[Rule, list[ReceivedFrame]] = {}
        """The first frames that violated each rule."""
        self.violation_counts: dict[Rule, int] = {}
        """How many violated it."""
        self.readings: list[tuple[float, int]] = []
        """Timestamp [s] and the robot's clock [ms] of the STATEs that have one."""
        self.logs: list[tuple[float, m.Log]] = []
        """Timestamp [s] and content of the LOGs."""
        self._session = 0
        self._version = timing.VERSION
        self._welcomed = False

    def add(self, received: ReceivedFrame, asked: bool = True) -> None:
        """Record a frame, and test it against the rules for all frames.

        `asked` says whether a message of the host asked for it.
        """
        if received.message is None:
            # Before the first WELCOME it may be the text of a boot loader.
            if self._welcomed:
                self._add_violation("frame", received)
            return
        if isinstance(received.message, m.Welcome):
            self._session, self._welcomed = received.session, True
            self._version = min(received.message.version, timing.VERSION)
        if not self._welcomed:
            return
        self._test_sending(received, asked)
        spec = spec_of(type(received.message))
        size = spec.size_in(self._version)
        if received.size != size:
            what = f"{size} bytes" if size else "nothing"
            reason = f"{spec.name} has {what} in version {self._version}, not {received.size} bytes"
            self._add_violation("frame", replace(received, message=None, error=reason))
        elif isinstance(received.message, m.Gone):
            return
        elif received.session != self._session:
            self._add_violation("session", received)
        else:
            self._keep(received.timestamp, received.message)

    def _test_sending(self, received: ReceivedFrame, asked: bool) -> None:
        if not asked:
            self._add_violation("unasked", received)
        if not received.own_edges:
            self._add_violation("edges", received)
        if not received.padded:
            self._add_violation("padding", received)

    def _keep(self, time: float, message: Any) -> None:
        if isinstance(message, m.Log) and len(self.logs) < MAX_STATES:
            self.logs.append((time, message))
        if isinstance(message, m.State) and len(self.states) < MAX_STATES:
            self.states.append((time, message))
            if self._version >= 3:
                self.readings.append((time, message.time))

    def _add_violation(self, rule: Rule, received: ReceivedFrame) -> None:
        self.violation_counts[rule] = self.violation_counts.get(rule, 0) + 1
        examples = self.violations.setdefault(rule, [])
        if len(examples) < MAX_EXAMPLES:
            examples.append(received)


def format_bytes(data: bytes) -> str:
    """Return bytes in hexadecimal, shortened if there are many.

    >>> format_bytes(bytes([0, 255]))
    '00 ff'
    """
    more = f" … {len(data)} bytes" if len(data) > MAX_SHOWN_BYTES else ""
    return data[:MAX_SHOWN_BYTES].hex(" ") + more


def describe_frames(received: Iterable[ReceivedFrame]) -> str:
    """Return a description of frames for a person: the last one in full, the others counted."""
    frames = list(received)
    if not frames:
        return "nothing"
    *others, last = frames
    counts: dict[str, int] = {}
    for frame in others:
        counts[frame.name] = counts.get(frame.name, 0) + 1
    before = ", ".join(f"{count} × {name}" for name, count in counts.items())
    return f"{before}, then {last}" if before else str(last)
