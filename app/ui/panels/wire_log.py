"""What goes over the robot's line, for the panel that shows it."""

from collections import deque
from dataclasses import dataclass
from typing import TYPE_CHECKING

from cubeling.robot import Catalogue, Direction

if TYPE_CHECKING:
    from cubeling.app.ui.panels.wire_words import WireDecoder, Words

BOTH_DIRECTIONS: tuple[Direction, ...] = ("tx", "rx")
"""To the robot, and from it."""

MAX_CHUNKS = 512
"""Transfers that wait to be read: some seconds of them, while the panel is closed."""

RATE_SPAN_S = 2.0
"""Time over which rates are counted."""

MAX_MESSAGES = 6
"""Messages that are kept, besides the newest routine message of each direction."""


@dataclass(frozen=True)
class WireMessage:
    """A message on the line."""

    time: float
    """When, by the robot's clock [s]."""

    direction: Direction

    text: str
    """What it says, in words."""


@dataclass(frozen=True)
class Traffic:
    """What went over the line lately."""

    messages: tuple[WireMessage, ...]
    """The last messages, newest last."""

    routine: tuple[WireMessage, ...]
    """The newest message of those that are sent all the time, to the robot and from it."""

    rates: dict[Direction, tuple[float, float]]
    """Messages and bytes per second in each direction."""


class WireLog:
    """Takes the bytes of both directions, and tells them in words when it is asked.

    The link's thread calls it; another one calls `read`. Nothing is decoded before.
    """

    def __init__(self) -> None:
        self._chunks: deque[tuple[Direction, bytes, float]] = deque(maxlen=MAX_CHUNKS)
        self._protocol = ""
        self._decoders: dict[Direction, WireDecoder] = {}
        self._messages: deque[WireMessage] = deque(maxlen=MAX_MESSAGES)
        self._routine: dict[Direction, WireMessage] = {}
        self._counted: deque[tuple[float, Direction, int, int]] = deque()

    def __call__(self, direction: Direction, data: bytes, time: float) -> None:
        """Add bytes of one direction at a time of the robot's clock [s]."""
        self._chunks.append((direction, data, time))

    def read(self, protocol: str, catalogue: Catalogue | None, now: float) -> Traffic:
        """Return what went over the line until `now`, a time of the robot's clock [s].

        `protocol` is one of `robot.contract.driver.DRIVERS`; `catalogue` names the robot's moods.
        """
        if protocol != self._protocol:
            from cubeling.app.ui.panels.wire_words import DECODERS, LineDecoder

            kind = DECODERS.get(protocol, LineDecoder)
            self._protocol, self._decoders = protocol, {"tx": kind("host"), "rx": kind("robot")}
        while self._chunks:
            direction, data, time = self._chunks.popleft()
            messages = list(self._decoders[direction].feed(data, catalogue))
            self._counted.append((time, direction, len(messages), len(data)))
            for words in messages:
                self._keep(words, WireMessage(time, direction, words.text))
        while self._counted and now - self._counted[0][0] > RATE_SPAN_S:
            self._counted.popleft()
        routine = tuple(self._routine[way] for way in BOTH_DIRECTIONS if way in self._routine)
        rates = {way: self._rate(way) for way in BOTH_DIRECTIONS}
        return Traffic(tuple(self._messages), routine, rates)

    def _keep(self, words: "Words", message: WireMessage) -> None:
        if words.routine:
            self._routine[message.direction] = message
        else:
            self._messages.append(message)

    def _rate(self, direction: Direction) -> tuple[float, float]:
        counts = [(count, size) for _, way, count, size in self._counted if way == direction]
        messages, size = (sum(column) for column in zip((0, 0), *counts, strict=True))
        return messages / RATE_SPAN_S, size / RATE_SPAN_S
