"""What can be said of a line on which no robot answers, by the bytes on it."""

from typing import Literal

MAX_SAMPLE_BYTES = 4096
"""Bytes of each direction that are kept; more say nothing new."""


class LineSample:
    """The first bytes of both directions of a line."""

    def __init__(self) -> None:
        self._sent = bytearray()
        self._received = bytearray()
        self._received_count = 0

    def add(self, direction: Literal["tx", "rx"], data: bytes) -> None:
        """Add bytes that were sent or received."""
        kept = self._sent if direction == "tx" else self._received
        kept += data[: MAX_SAMPLE_BYTES - len(kept)]
        if direction == "rx":
            self._received_count += len(data)

    def diagnosis(self) -> str:
        """Return what was received instead of a robot's answer, and what to look at.

        >>> sample = LineSample()
        >>> sample.diagnosis()
        'nothing was received: is the robot switched on, and is this its port?'
        >>> sample.add("tx", b"hello")
        >>> sample.add("rx", b"hell")
        >>> sample.diagnosis()
        'only an echo of what was sent: is a robot at the other end, and is its echo off?'
        """
        count = self._received_count
        if not count:
            return "nothing was received: is the robot switched on, and is this its port?"
        received = "1 byte was received" if count == 1 else f"{count} bytes were received"
        if not any(self._received):
            return f"{received}, nothing but zeros: is the plug in, and is the speed right?"
        if self._received in self._sent:
            return (
                "only an echo of what was sent: is a robot at the other end, and is its echo off?"
            )
        return (
            f"{received}, but no answer: "
            "is the speed right, and does the robot speak this protocol?"
        )
