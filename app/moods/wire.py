"""What a robot confirmed and what it showed, from the bytes that a session recorded."""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.errors import AppError
from app.session import messages
from robot.protocol import messages as m
from robot.protocol import timing
from robot.protocol.fields import MessageError
from robot.protocol.schema import Sender, unpack
from robot.protocol.wire import FrameReader

Array = NDArray[np.float64]

NOWHERE = (float("nan"), float("nan"))
"""Where the feeling is that nobody knows."""


@dataclass(frozen=True)
class Trace:
    """A feeling that holds from each time until the next."""

    times: Array
    """When it changed or was told again, (n,) [s]."""

    emotion: Array
    """Valence and arousal, (n, 2); NaN where it was not known."""

    words: tuple[str, ...]
    """The robot's own word for it, n of them; "" where it gave none."""

    def at(self, times: Array) -> tuple[Array, list[str]]:
        """Return emotion (k, 2) and words at k times; NaN and "" before the first."""
        found = np.searchsorted(self.times, times, side="right") - 1
        emotion = np.full((len(times), 2), np.nan)
        emotion[found >= 0] = self.emotion[found[found >= 0]]
        return emotion, [self.words[index] if index >= 0 else "" for index in found]


@dataclass(frozen=True)
class Wire:
    """What went to and fro between a session and its robot."""

    acknowledged: Trace
    """What the robot confirmed to have taken."""

    observed: Trace
    """What the robot said that it shows."""

    delays: Array
    """How long each emotion was on its way until it was acknowledged, (k,) [s]."""

    def __bool__(self) -> bool:
        return len(self.observed.times) > 0


def read_wire(path: Path) -> Wire:
    """Decode the bytes of a session; all is empty where no robot spoke our protocol.

    Raises
    ------
    AppError
        The channel does not hold what a recorder writes.
    """
    listener = _Listener()
    for _, time, data in messages(path, "/robot/wire"):
        try:
            line = json.loads(data)
            direction, heard = line["direction"], bytes.fromhex(line["hex"])
        except (ValueError, KeyError, TypeError) as error:
            raise AppError(f"cannot read the session '{path}': /robot/wire: {error}") from error
        listener.hear(direction, heard, time)
    delays = np.array(listener.delays)
    return Wire(_trace(listener.acknowledged), _trace(listener.observed), delays)


Row = tuple[float, tuple[float, float], str]


class _Listener:
    """Follows both ends of the line."""

    def __init__(self) -> None:
        self.acknowledged: list[Row] = []
        self.observed: list[Row] = []
        self.delays: list[float] = []
        self._readers = {"tx": FrameReader(), "rx": FrameReader()}
        self._asked: dict[int, tuple[float, tuple[float, float]]] = {}
        self._landed: set[int] = set()
        self._moods: dict[int, str] = {}
        self._heard: float | None = None

    def hear(self, direction: str, data: bytes, time: float) -> None:
        """Take bytes of one direction."""
        sender: Sender = "host" if direction == "tx" else "robot"
        for body in self._readers[direction].feed(data):
            try:
                _, content = unpack(body, sender)
            except MessageError:
                continue
            if sender == "robot":
                self._notice_silence(time)
            self._take(content, time)

    def _notice_silence(self, time: float) -> None:
        """End both traces where the robot was not heard for so long that the link was lost."""
        last, self._heard = self._heard, time
        if last is not None and time - last > timing.LOST_AFTER:
            for trace in (self.acknowledged, self.observed):
                trace.append((last + timing.LOST_AFTER, NOWHERE, ""))

    def _take(self, content: Any, time: float) -> None:
        match content:
            case m.Express():
                self._asked.setdefault(content.number, (time, (content.valence, content.arousal)))
            case m.Stop():
                self._asked.setdefault(content.number, (time, NOWHERE))
            case m.Ack() if content.result == m.TAKEN and content.number in self._asked:
                self._confirm(content.number, time)
            case m.Welcome():  # a robot that was away may still have the last command in force
                place = self._asked.get(content.taken, (time, NOWHERE))[1]
                self.acknowledged.append((time, place, ""))
            case m.Gone() | m.Bye():
                self.acknowledged.append((time, NOWHERE, ""))
            case m.Name() if content.item == m.ITEM_MOOD:
                self._moods[content.index] = content.name
            case m.State():
                place = content.valence, content.arousal
                self.observed.append((time, place, self._moods.get(content.mood, "")))

    def _confirm(self, number: int, time: float) -> None:
        asked, place = self._asked[number]
        self.acknowledged.append((time, place, ""))
        if number not in self._landed:  # a repeat may be acknowledged twice
            self._landed.add(number)
            self.delays.append(time - asked)


def _trace(rows: list[Row]) -> Trace:
    return Trace(
        np.array([time for time, _, _ in rows]),
        np.array([place for _, place, _ in rows]).reshape(-1, 2),
        tuple(word for _, _, word in rows),
    )
