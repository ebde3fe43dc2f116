"""What comes from the robot under test, cut into frames and remembered."""

from collections.abc import Iterator
from dataclasses import dataclass, fields
from typing import Any

from robot.protocol import messages as m
from robot.protocol.fields import MessageError
from robot.protocol.schema import HEADER, MESSAGES, spec_of, unpack
from robot.protocol.wire import MAX_FRAME, FrameError, decode_frame

STATES_KEPT = 20_000
"""Most STATEs remembered: over ten minutes of them."""

FAULTS_KEPT = 3
"""Faults of each kind that are remembered with their bytes; more are only counted."""

BYTES_SHOWN = 40
"""Most bytes of a frame that are shown to a person."""


@dataclass(frozen=True)
class Heard:
    """A frame from the robot, or what should have been one."""

    at: float
    """When its last byte came [s]."""

    frame: bytes
    """Its bytes between the edges."""

    session: int = 0
    """The session in its header."""

    message: Any = None
    """What it says; None where it says nothing valid."""

    wrong: str = ""
    """Why it says nothing valid."""

    @property
    def name(self) -> str:
        """The message's name in the document."""
        return "a wrong frame" if self.message is None else spec_of(type(self.message)).name

    def __str__(self) -> str:
        if self.message is None:
            return f"[{shown_bytes(self.frame)}], {self.wrong}"
        words = [
            f"{field.name}={getattr(self.message, field.name)}"
            for field in fields(self.message)
            if field.name not in ("joints", "firmware", "flags", "battery")
        ]
        told = f"{self.name}({', '.join(words)}) in session {self.session}"
        return f"{told} [{shown_bytes(self.frame)}]"


class Splitter:
    """Cuts what comes from the line into frames; keeps at most one frame's bytes."""

    def __init__(self) -> None:
        self._pending = bytearray()
        self._edge_seen = False  # what comes before the first edge may be half a frame

    def feed(self, data: bytes, now: float) -> Iterator[Heard]:
        """Take bytes that came at time `now` [s]; give what they complete."""
        *ended, rest = data.split(b"\0")
        for piece in ended:
            self._keep(piece)
            frame = bytes(self._pending)
            self._pending.clear()
            if frame and self._edge_seen:
                yield understood(frame, now)
            self._edge_seen = True
        self._keep(rest)

    def _keep(self, piece: bytes) -> None:
        self._pending += piece[: MAX_FRAME + 1 - len(self._pending)]


def understood(frame: bytes, now: float) -> Heard:
    """Say what a frame from the robot means, or what is wrong with it."""
    try:
        body = decode_frame(frame)
        session, message = unpack(body, "robot")
    except (FrameError, MessageError) as error:
        return Heard(now, frame, wrong=str(error))
    if message is None:
        form = MESSAGES.get(body[0])
        wrong = f"{body[0]:02X} is no message" if form is None else f"{form.name} is the host's"
        return Heard(now, frame, session, wrong=wrong)
    size = spec_of(type(message)).size
    if len(body) != size:  # no version up to ours has added to what a robot says
        name = spec_of(type(message)).name
        return Heard(now, frame, session, wrong=f"{name} has {size} bytes, not {len(body)}")
    return Heard(now, frame, session, message)


class Log:
    """What is remembered of everything that a robot said, for the checks of all of it."""

    def __init__(self) -> None:
        self.bytes = 0
        """Bytes heard."""
        self.frames = 0
        """Valid frames heard."""
        self.states: list[tuple[float, m.State]] = []
        """When [s] and what, for the STATEs of our sessions."""
        self.faults: dict[str, list[Heard]] = {}
        """The first frames that broke each passive rule."""
        self.counts: dict[str, int] = {}
        """How many broke it."""
        self._open = 0
        self._greeted = False

    def enter(self, heard: Heard) -> None:
        """Remember a frame, and hold it against the rules for all of them."""
        if heard.message is None:
            # Before the first WELCOME it may be the text of a boot loader.
            if self._greeted:
                self._fault("frame", heard)
            return
        self.frames += 1
        if isinstance(heard.message, m.Welcome):
            self._open, self._greeted = heard.session, True
        elif self._greeted and not isinstance(heard.message, m.Gone):
            if heard.session != self._open:
                self._fault("session", heard)
            elif isinstance(heard.message, m.State) and len(self.states) < STATES_KEPT:
                self.states.append((heard.at, heard.message))

    def _fault(self, rule: str, heard: Heard) -> None:
        self.counts[rule] = self.counts.get(rule, 0) + 1
        examples = self.faults.setdefault(rule, [])
        if len(examples) < FAULTS_KEPT:
            examples.append(heard)


def shown_bytes(data: bytes) -> str:
    """Write bytes for a person.

    >>> shown_bytes(bytes([0, 255]))
    '00 ff'
    """
    more = f" … {len(data)} bytes" if len(data) > BYTES_SHOWN else ""
    return data[:BYTES_SHOWN].hex(" ") + more


def header(number: int, session: int) -> bytes:
    """Return the beginning of a body."""
    return HEADER.pack(number, session)
