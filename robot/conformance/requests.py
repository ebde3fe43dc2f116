"""The host's messages that a robot may still answer."""

from collections import deque
from typing import Any

from cubeling.robot.conformance.received import ReceivedFrame
from cubeling.robot.protocol import messages as m
from cubeling.robot.protocol.fields import MessageError
from cubeling.robot.protocol.schema import unpack
from cubeling.robot.protocol.wire import FrameReader

MAX_OPEN = 10_000
"""Most messages that wait for an answer; older ones are forgotten."""

_UNASKED_KINDS = m.State | m.Log


class OpenRequests:
    """What the host has sent, as a robot receives it, and what of it is not answered yet."""

    def __init__(self) -> None:
        self._reader = FrameReader()
        self._open: deque[tuple[int, Any]] = deque(maxlen=MAX_OPEN)

    def add(self, data: bytes) -> None:
        """Take bytes for the robot, which may be damaged, or no frames at all."""
        for body in self._reader.feed(data):
            try:
                session, message = unpack(body, "host")
            except MessageError:
                continue
            if message is not None and (session or not isinstance(message, m.Hello)):
                self._open.append((session, message))

    def take(self, answer: ReceivedFrame) -> bool:
        """Return whether a message asked for this answer, and count that as answered.

        Bytes are answered in the order in which they arrive, so all messages before it have had
        their answer, or will not get one. STATE and LOG come unasked.
        """
        if isinstance(answer.message, _UNASKED_KINDS) or answer.message is None:
            return True
        for index, (session, message) in enumerate(self._open):
            if session == answer.session and _answers(answer.message, message):
                for _ in range(index + 1):
                    self._open.popleft()
                return True
        return False


def _answers(answer: Any, message: Any) -> bool:
    """Return whether a robot may answer a message of the same session in this way."""
    match answer:
        case m.Welcome():
            return isinstance(message, m.Hello)
        case m.Gone():
            return not isinstance(message, m.Hello)
        case m.Ack():
            return isinstance(message, m.Command) and message.number == answer.number
        case m.Joint():
            asked = (m.ITEM_JOINT, answer.index)
        case _:
            asked = (answer.item, answer.index)
    return isinstance(message, m.Ask) and (message.item, message.index) == asked
