"""A robot that keeps every rule but one: what comes and goes is altered around a good simulator."""

from collections.abc import Callable
from contextlib import suppress
from typing import Any

from robot.protocol import messages as m
from robot.protocol.fields import MessageError
from robot.protocol.schema import pack, unpack
from robot.protocol.wire import MAX_BODY, MAX_FRAME, FrameError, decode_frame, encode_frame
from robot.simulators.cubeling.simulator import Simulator

MUTANTS: dict[str, list[type["Mutant"]]] = {}
"""The robots that break the rule of a check, by the check's name."""


def breaks(*checks: str) -> Callable[[type["Mutant"]], type["Mutant"]]:
    """Enter a robot as one that fails each of these checks."""

    def enter(mutant: type["Mutant"]) -> type["Mutant"]:
        for check in checks:
            MUTANTS.setdefault(check, []).append(mutant)
        return mutant

    return enter


class Mutant:
    """A good robot; its children are not."""

    edge = b"\0"

    def __init__(self) -> None:
        self.robot = Simulator(1)
        self.body = self.robot.body
        self.now = 0.0
        self.pending = b""
        self.out = b""
        self.prepare()

    @property
    def session(self) -> int:
        return self.robot.link.session

    # --- The points at which a child goes wrong ------------------------------------------------

    def prepare(self) -> None:
        """Spoil the body."""

    def frames(self, data: bytes) -> list[bytes]:
        """Cut the stream."""
        *ended, rest = (self.pending + data).split(b"\0")
        self.pending = rest[: MAX_FRAME + 1]
        return [piece for piece in ended if piece]

    def decode(self, frame: bytes) -> bytes | None:
        """Check a frame."""
        try:
            return decode_frame(frame)
        except FrameError:
            return None

    def hear(self, number: int, session: int, body: bytes) -> None:
        """Take a body; `give` hands it to the good robot."""
        self.give(body)

    def live(self) -> None:
        """Do what is due, after the good robot has."""

    def say(self, session: int, message: Any) -> None:
        """Send a message of the good robot; `send` does."""
        self.send(session, message)

    def write(self, data: bytes) -> None:
        """Send bytes."""
        self.out += data

    # --- What they can use ---------------------------------------------------------------------

    def give(self, body: bytes) -> None:
        self.robot.receive(encode_frame(body[:MAX_BODY]), self.now)
        self.collect()

    def tell(self, message: Any, session: int | None = None) -> None:
        """Say something to the good robot as if the host had."""
        self.give(pack(message, self.session if session is None else session))

    def keep_alive(self) -> None:
        """Feed the failsafe by a question that has no answer."""
        self.tell(m.Ask(9, 0))

    def send(self, session: int, message: Any) -> None:
        self.write(encode_frame(pack(message, session)))

    def collect(self) -> None:
        for frame in self.robot.bytes_to_send().split(b"\0"):
            if frame:
                self.say(*unpack(decode_frame(frame), "robot"))

    # --- A simulated robot ---------------------------------------------------------------------

    def receive(self, data: bytes, now: float) -> None:
        self.advance(now)
        for frame in self.frames(data):
            body = self.decode(frame)
            if body is not None and len(body) >= 3:
                with suppress(MessageError, IndexError):  # a child looked at what is to be skipped
                    self.hear(body[0], int.from_bytes(body[1:3], "little"), body)
            elif body:
                self.hear_stub(body)

    def hear_stub(self, body: bytes) -> None:
        """Take a body that is shorter than a header."""
        self.give(body)

    def advance(self, now: float) -> None:
        self.now = now
        self.robot.advance(now)
        self.collect()
        self.live()

    def bytes_to_send(self) -> bytes:
        out, self.out = self.out, b""
        return out

    def reboot(self) -> None:
        raise NotImplementedError

    def portrait(self) -> tuple[float, str]:
        return self.robot.portrait()
