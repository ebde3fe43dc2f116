"""Robots that violate one rule: the messages of a conforming simulator are altered."""

from collections.abc import Callable
from contextlib import suppress
from typing import Any

from cubeling.robot.protocol import messages as m
from cubeling.robot.protocol.fields import MessageError
from cubeling.robot.protocol.schema import pack, unpack
from cubeling.robot.protocol.wire import MAX_BODY, MAX_FRAME, FrameError, decode_frame, encode_frame
from cubeling.robot.simulators.cubeling.simulator import Simulator

MUTANTS: dict[str, list[type["Mutant"]]] = {}
"""The robots that fail each check, by the check's name."""


def breaks(*checks: str) -> Callable[[type["Mutant"]], type["Mutant"]]:
    """Register a robot that fails each of these checks."""

    def enter(mutant: type["Mutant"]) -> type["Mutant"]:
        for check in checks:
            MUTANTS.setdefault(check, []).append(mutant)
        return mutant

    return enter


class Mutant:
    """A conforming robot; its subclasses are not."""

    edge = b"\0"

    def __init__(self) -> None:
        self.robot = Simulator(1)
        self.body = self.robot.body
        self.now = 0.0
        self.pending = b""
        self.out = b""
        self.set_up()

    @property
    def session(self) -> int:
        return self.robot.link.session

    # --- Hooks for subclasses ------------------------------------------------------------------

    def set_up(self) -> None:
        """Alter the body."""

    def frames(self, data: bytes) -> list[bytes]:
        """Split the stream into frames."""
        *ended, rest = (self.pending + data).split(b"\0")
        self.pending = rest[: MAX_FRAME + 1]
        return [piece for piece in ended if piece]

    def decode(self, frame: bytes) -> bytes | None:
        """Return the body of a frame; None if it is not valid."""
        try:
            return decode_frame(frame)
        except FrameError:
            return None

    def on_body(self, number: int, session: int, body: bytes) -> None:
        """Process a body; `forward` passes it to the simulator."""
        self.forward(body)

    def on_advance(self) -> None:
        """Do something after each step of the simulator."""

    def send_message(self, session: int, message: Any) -> None:
        """Send a message of the simulator."""
        self.send(session, message)

    def write(self, data: bytes) -> None:
        """Send bytes."""
        self.out += data

    # --- Helpers for subclasses ----------------------------------------------------------------

    def forward(self, body: bytes) -> None:
        self.robot.receive(encode_frame(body[:MAX_BODY]), self.now)
        self.collect()

    def inject(self, message: Any, session: int | None = None) -> None:
        """Send a message to the simulator as the host."""
        self.forward(pack(message, self.session if session is None else session))

    def keep_alive(self) -> None:
        """Keep the session open by a question without an answer."""
        self.inject(m.Ask(9, 0))

    def send(self, session: int, message: Any) -> None:
        self.write(encode_frame(pack(message, session, self.robot.link.version)))

    def collect(self) -> None:
        for frame in self.robot.bytes_to_send().split(b"\0"):
            if frame:
                self.send_message(*unpack(decode_frame(frame), "robot"))

    # --- A simulated robot ---------------------------------------------------------------------

    def receive(self, data: bytes, now: float) -> None:
        self.advance(now)
        for frame in self.frames(data):
            body = self.decode(frame)
            if body is not None and len(body) >= 3:
                with suppress(
                    MessageError, IndexError
                ):  # a subclass parsed a body that is to be skipped
                    self.on_body(body[0], int.from_bytes(body[1:3], "little"), body)
            elif body:
                self.on_short_body(body)

    def on_short_body(self, body: bytes) -> None:
        """Process a body that is shorter than a header."""
        self.forward(body)

    def advance(self, now: float) -> None:
        self.now = now
        self.robot.advance(now)
        self.collect()
        self.on_advance()

    def bytes_to_send(self) -> bytes:
        out, self.out = self.out, b""
        return out

    def reboot(self) -> None:
        raise NotImplementedError

    def portrait(self) -> tuple[float, str]:
        return self.robot.portrait()
