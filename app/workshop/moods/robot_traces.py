"""What a robot acknowledged and what it showed, decoded from a session's recorded bytes."""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cubeling.app.errors import AppError
from cubeling.app.session import messages
from cubeling.robot import (
    FrameReader,
    MessageError,
    RobotClock,
    Sender,
    messages as m,
    timing,
    unpack,
)

Array = NDArray[np.float64]

UNKNOWN_EMOTION = (float("nan"), float("nan"))
"""Valence and arousal where nothing is known of the robot."""


@dataclass(frozen=True)
class EmotionSteps:
    """An emotion that holds from each time until the next."""

    times: Array
    """When it changed or was reported again, (n,) [s]."""

    emotion: Array
    """Valence and arousal, (n, 2); NaN while unknown."""

    labels: tuple[str, ...]
    """The robot's own label of each; "" if it gave none."""

    def at(self, times: Array) -> tuple[Array, list[str]]:
        """Return emotions (k, 2) and labels at k times; NaN and "" before the first."""
        found = np.searchsorted(self.times, times, side="right") - 1
        emotion = np.full((len(times), 2), np.nan)
        emotion[found >= 0] = self.emotion[found[found >= 0]]
        return emotion, [self.labels[index] if index >= 0 else "" for index in found]


@dataclass(frozen=True)
class RobotEvent:
    """Something that a robot was asked, answered or showed."""

    time: float
    """When [s]: for what it showed by its own clock, if it has one."""

    what: str
    """commanded, acknowledged or observed for an emotion; asked, taken or refused for an action."""

    emotion: tuple[float, float] = UNKNOWN_EMOTION
    """Valence and arousal; NaN for an action."""

    name: str = ""
    """The mood's or the action's name; "" if the robot gave none."""

    number: int | None = None
    """The command's number, which its answer repeats."""

    reason: str = ""
    """Why it was refused; "" if it was not."""


@dataclass(frozen=True)
class RobotTraces:
    """What a robot acknowledged and showed during a session."""

    acknowledged: EmotionSteps
    """Emotions that the robot acknowledged."""

    observed: EmotionSteps
    """Emotions that the robot reported to show, at the times by its own clock if it has one."""

    delays: Array
    """Time from each emotion's command to its acknowledgement, (k,) [s]."""

    events: tuple[RobotEvent, ...] = ()
    """All that it was asked, answered and showed, in the order of the wire."""

    def __bool__(self) -> bool:
        return len(self.observed.times) > 0


def read_robot_traces(path: Path) -> RobotTraces:
    """Decode the bytes of a session; all traces are empty if no robot used our protocol.

    Raises
    ------
    AppError
        The channel does not have the format that a recorder writes.
    """
    decoder = _WireDecoder()
    for _, time, data in messages(path, "/robot/wire"):
        try:
            line = json.loads(data)
            direction, received = line["direction"], bytes.fromhex(line["hex"])
        except (ValueError, KeyError, TypeError) as error:
            raise AppError(f"cannot read the session '{path}': /robot/wire: {error}") from error
        decoder.feed(direction, received, time)
    delays = np.array(decoder.delays)
    return RobotTraces(
        _steps(decoder.acknowledged), _steps(decoder.observed), delays, tuple(decoder.events)
    )


Row = tuple[float, tuple[float, float], str]


class _WireDecoder:
    """Decodes both directions of the line."""

    def __init__(self) -> None:
        self.acknowledged: list[Row] = []
        self.observed: list[Row] = []
        self.delays: list[float] = []
        self.events: list[RobotEvent] = []
        self._asked: dict[int, tuple[str, str]] = {}
        self._answered: set[int] = set()
        self._readers = {"tx": FrameReader(), "rx": FrameReader()}
        self._commands: dict[int, tuple[float, tuple[float, float]]] = {}
        self._acknowledged: set[int] = set()
        self._names: dict[tuple[int, int], str] = {}
        self._last_received: float | None = None
        self._version = 1
        self._clock = RobotClock()
        self._beats: dict[int, float] = {}

    def feed(self, direction: str, data: bytes, time: float) -> None:
        """Decode bytes of one direction."""
        sender: Sender = "host" if direction == "tx" else "robot"
        for body in self._readers[direction].feed(data):
            try:
                _, content = unpack(body, sender)
            except MessageError:
                continue
            if sender == "robot":
                self._check_silence(time)
            self._handle(content, time)

    def _check_silence(self, time: float) -> None:
        """End both traces if the robot was silent for so long that the link counts as lost."""
        last, self._last_received = self._last_received, time
        if last is not None and time - last > timing.LOST_AFTER:
            for trace in (self.acknowledged, self.observed):
                trace.append((last + timing.LOST_AFTER, UNKNOWN_EMOTION, ""))

    def _handle(self, content: Any, time: float) -> None:
        match content:
            case m.Express():
                mood = self._names.get((m.ITEM_MOOD, content.mood), "")
                self._ask(content, time, "commanded", mood, (content.valence, content.arousal))
                self._commands.setdefault(
                    content.number, (time, (content.valence, content.arousal))
                )
            case m.Play():
                name = self._names.get((content.item, content.index), f"{content.index}")
                self._ask(content, time, "asked", name)
            case m.Move():
                self._ask(content, time, "asked", "move")
            case m.Stop():
                self._ask(content, time, "asked", "stop")
                self._commands.setdefault(content.number, (time, UNKNOWN_EMOTION))
            case m.Ack():
                self._answer(content, time)
                if content.result == m.RESULT_TAKEN and content.number in self._commands:
                    self._acknowledge(content.number, time)
            case m.Beat():
                self._beats[content.count] = time
            case m.Welcome():  # after a reconnection, the last command may still be in force
                emotion = self._commands.get(content.taken, (time, UNKNOWN_EMOTION))[1]
                self.acknowledged.append((time, emotion, ""))
                self._version, self._clock = content.version, RobotClock()
            case m.Gone() | m.Bye():
                self.acknowledged.append((time, UNKNOWN_EMOTION, ""))
            case m.Name():
                self._names[content.item, content.index] = content.name
            case m.State():
                emotion = content.valence, content.arousal
                label = self._names.get((m.ITEM_MOOD, content.mood), "")
                made = self._time_of(content, time)
                self.observed.append((made, emotion, label))
                self.events.append(RobotEvent(made, "observed", emotion, label))

    def _ask(
        self,
        command: m.Express | m.Play | m.Move | m.Stop,
        time: float,
        what: str,
        name: str,
        emotion: tuple[float, float] = UNKNOWN_EMOTION,
    ) -> None:
        """Note a command, but not its repetitions."""
        if self._asked.get(command.number) != (what, name):
            self._asked[command.number] = what, name
            self._answered.discard(command.number)  # numbers begin again after a reconnection
            self.events.append(RobotEvent(time, what, emotion, name, command.number))

    def _answer(self, answer: m.Ack, time: float) -> None:
        """Note the answer to a command, but not to its repetitions."""
        asked, name = self._asked.get(answer.number, ("", ""))
        if asked and answer.number not in self._answered:
            self._answered.add(answer.number)
            taken = "acknowledged" if asked == "commanded" else "taken"
            reason = m.REFUSALS.get(answer.result, "")
            what = taken if answer.result == m.RESULT_TAKEN else "refused"
            emotion = self._commands.get(answer.number, (0.0, UNKNOWN_EMOTION))[1]
            self.events.append(RobotEvent(time, what, emotion, name, answer.number, reason))

    def _time_of(self, state: m.State, arrival: float) -> float:
        """Return when a STATE was made: by the robot's clock, or when it arrived if it has none."""
        sent = self._beats.pop(state.beat, None)
        if self._version < 3:
            return arrival
        if sent is not None:
            self._clock.add(state.time, sent, arrival)
        known = self._clock.host_time(state.time)
        made = arrival if known is None else min(known.host, arrival)
        return max(made, self.observed[-1][0]) if self.observed else made

    def _acknowledge(self, number: int, time: float) -> None:
        sent, emotion = self._commands[number]
        self.acknowledged.append((time, emotion, ""))
        if number not in self._acknowledged:  # a repetition is acknowledged again
            self._acknowledged.add(number)
            self.delays.append(time - sent)


def _steps(rows: list[Row]) -> EmotionSteps:
    return EmotionSteps(
        np.array([time for time, _, _ in rows]),
        np.array([emotion for _, emotion, _ in rows]).reshape(-1, 2),
        tuple(label for _, _, label in rows),
    )
