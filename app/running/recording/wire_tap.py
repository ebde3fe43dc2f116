"""The bytes on the robot's wire, for whatever recording there is."""

import threading
from typing import TYPE_CHECKING

from cubeling.app.session.encoding import WIRE_TOPIC
from cubeling.app.ui.panels.wire_log import WireLog
from cubeling.robot import Direction

if TYPE_CHECKING:
    from cubeling.app.session import Recorder


class WireTap:
    """Passes the robot's bytes to a recording, with the timestamps of the frames.

    The link's thread calls it. The difference between the clock of the robot and the timestamps of
    the frames is known from the first frame on. The bytes before it, such as the handshake, are
    kept: every recording begins with them, so that it can be decoded.

    Parameters
    ----------
    topic
        The channel of a recording for them.
    """

    def __init__(self, topic: str = WIRE_TOPIC) -> None:
        self._topic = topic
        self.log = WireLog()
        """The last bytes, for the panel that shows them."""
        self._lock = threading.Lock()
        self._handshake: list[tuple[str, bytes, float]] = []
        self._aligned = False
        self._offset: float | None = None
        self._held = self._since = 0.0
        self._recorder: Recorder | None = None

    def __call__(self, direction: Direction, data: bytes, time: float) -> None:
        """Take bytes of one direction ("tx", "rx") at a time of the robot's clock [s]."""
        self.log(direction, data, time)
        with self._lock:
            if not self._aligned:
                self._handshake.append((direction, data, time))
            else:
                self._write(direction, data, time)

    def align(self, offset: float) -> None:
        """Set what to add to the clock's time to get that of the frames.

        Only the first call counts, and the first one after `hold`.
        """
        with self._lock:
            if self._offset is not None:
                return
            self._offset = offset
            if not self._aligned:
                self._aligned = True
                self._write_handshake()

    def hold(self, timestamp: float) -> None:
        """Let bytes until the next `align` have this timestamp of a frame: a pause [s]."""
        with self._lock:
            if self._aligned:
                self._held, self._offset = timestamp, None

    def record_to(self, recorder: "Recorder | None", since: float = 0.0) -> None:
        """Pass the bytes to a recording that begins at a timestamp [s], or to none."""
        with self._lock:
            self._recorder, self._since = recorder, since
            if self._aligned:
                self._write_handshake()

    def _write_handshake(self) -> None:
        for direction, data, time in self._handshake:
            self._write(direction, data, time)

    def _write(self, direction: str, data: bytes, time: float) -> None:
        if self._recorder is not None:
            self._recorder.wire(direction, data, self._timestamp(time), self._topic)

    def _timestamp(self, time: float) -> float:
        """Return the timestamp of a time of the robot's clock [s]."""
        return max(self._since, self._held if self._offset is None else time + self._offset)
