"""Frames to and from the robot under test, over a channel: sent, received, waited for."""

from collections import deque
from collections.abc import Callable
from typing import Any, TypeVar

from cubeling.robot.conformance.channel import Channel
from cubeling.robot.conformance.errors import CheckFailed
from cubeling.robot.conformance.received import (
    FrameLog,
    FrameSplitter,
    ReceivedFrame,
    describe_frames,
)
from cubeling.robot.conformance.requests import OpenRequests
from cubeling.robot.contract.port import READ_TIMEOUT_S
from cubeling.robot.link.line_sample import LineSample
from cubeling.robot.protocol import timing
from cubeling.robot.protocol.schema import HEADER, pack, spec_of
from cubeling.robot.protocol.wire import encode_frame

REPLY_WITHIN_S = 0.100
"""Longest time to an answer "at once" [s] (PROTOCOL.md, section 5)."""

MAX_QUEUED_FRAMES = 10_000
"""Most received frames in the queue; older ones are dropped."""

Kind = TypeVar("Kind")


class FrameExchange:
    """Frames in any session, valid or not; a `Probe` knows which ones a host sends."""

    def __init__(self, channel: Channel) -> None:
        self.log = FrameLog()
        """Everything that the robot sent."""
        self.sample = LineSample()
        """The first bytes of both directions."""
        self.session = 0x2120
        """The session opened last."""
        self.version = timing.VERSION
        """The protocol version agreed in it."""
        self.max_overrun = 0.0
        """Longest overrun of a wait, because this computer was busy [s]."""
        self._channel = channel
        self._splitter = FrameSplitter()
        self._requests = OpenRequests()
        self._queue: deque[ReceivedFrame] = deque(maxlen=MAX_QUEUED_FRAMES)

    @property
    def now(self) -> float:
        """Time of the channel's clock [s], which is virtual for a simulated robot."""
        return self._channel.now()

    def hold_up(self, seconds: float) -> bool:
        """Let time pass in which the robot does not run; return whether that is possible."""
        return self._channel.hold_up(seconds)

    def write(self, data: bytes, *, keep: bool = False) -> None:
        """Send raw bytes; frames received before are dropped, unless `keep` is set."""
        if not keep:
            self.receive(0)
        self.sample.add("tx", data)
        self._requests.add(data)
        self._channel.write(data)

    def send(self, *messages: Any, session: int | None = None, version: int | None = None) -> None:
        """Send messages in one write, in the open session or in another."""
        self.write(b"".join(self.frame(one, session, version) for one in messages))

    def frame(self, message: Any, session: int | None = None, version: int | None = None) -> bytes:
        """Return the frame of a message, edges included."""
        session = self.session if session is None else session
        return encode_frame(pack(message, session, version or self.version))

    def raw_frame(self, number: int, fields: bytes, session: int | None = None) -> bytes:
        """Return the frame of a body with arbitrary bytes after its header, edges included."""
        session = self.session if session is None else session
        return encode_frame(HEADER.pack(number, session) + fields)

    def receive(self, seconds: float) -> list[ReceivedFrame]:
        """Return all frames in the queue, and all that arrive within a time [s]."""
        end = self.now + seconds
        while True:
            self._read(end)
            if self.now >= end:
                break
        received = list(self._queue)
        self._queue.clear()
        return received

    def receive_until(self, time: float) -> list[ReceivedFrame]:
        """Return all frames until a time [s], exactly: a read of a port may overrun."""
        received = self.receive(max(time - READ_TIMEOUT_S - self.now, 0))
        while self.now < time:
            received += self.receive(0)
        return received

    def wait_for(
        self, wanted: Callable[[ReceivedFrame], bool], within: float
    ) -> tuple[ReceivedFrame | None, list[ReceivedFrame]]:
        """Return the first wanted frame, or None after a time [s], and the frames before it."""
        end = self.now + within
        before: list[ReceivedFrame] = []
        while True:
            while self._queue:
                received = self._queue.popleft()
                if wanted(received):
                    return received, before
                before.append(received)
                del before[:-MAX_QUEUED_FRAMES]
            if self.now >= end:
                return None, before
            self._read(end)

    def expect(
        self,
        kind: type[Kind],
        after: str,
        within: float = REPLY_WITHIN_S,
        session: int | None = None,
        **content: Any,
    ) -> Kind:
        """Return the next message of a kind in a session, by default ours, with some field values.

        Raises CheckFailed if there is none within a time [s].
        """
        session = self.session if session is None else session

        def wanted(received: ReceivedFrame) -> bool:
            return (
                type(received.message) is kind
                and received.session == session
                and all(getattr(received.message, key) == value for key, value in content.items())
            )

        found, before = self.wait_for(wanted, within)
        if found is None:
            words = ", ".join(f"{key}={value}" for key, value in content.items())
            name = spec_of(kind).name + (f"({words})" if words else "")
            expected = f"{name} in session {session} within {1000 * within:.0f} ms"
            raise CheckFailed(f"{expected} after {after}", describe_frames(before))
        answer: Kind = found.message
        return answer

    def _read(self, until: float) -> None:
        until = max(until, self.now)
        data = self._channel.read(until)
        self.max_overrun = max(self.max_overrun, self.now - until)
        self.sample.add("rx", data)
        for received in self._splitter.feed(data, self.now):
            self.log.add(received, asked=self._requests.take(received))
            self._queue.append(received)
