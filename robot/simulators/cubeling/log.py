"""The lines of a robot's log that wait to be sent."""

from collections import deque

from cubeling.robot.protocol import messages as m
from cubeling.robot.protocol.schema import spec_of

MAX_WAITING = 8
"""Lines that wait; when there are more, the new ones are dropped and counted."""

_TEXT_BYTES = spec_of(m.Log).fields[-1].size


class SimulatedLogQueue:
    """The first lines that were written and not yet sent."""

    def __init__(self) -> None:
        self._waiting: deque[m.Log] = deque()
        self._count = 0

    def write(self, severity: int, text: str, time: int) -> None:
        """Write a line at `time` of the robot's clock [ms]; a long one is shortened."""
        self._count = (self._count + 1) & 0xFFFF
        if len(self._waiting) < MAX_WAITING:
            text = text.encode()[:_TEXT_BYTES].decode(errors="ignore")
            self._waiting.append(m.Log(self._count, time, severity, text))

    def pop(self) -> m.Log | None:
        """Return the next line, once; None if none waits."""
        return self._waiting.popleft() if self._waiting else None
