"""OSC: every channel of a session out, and what characters are to do in; docs/instruments.md."""

import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace

import numpy as np

from cubeling.affect import WORD_PLACES, Emotion
from cubeling.app.bridges.addresses import UdpAddress
from cubeling.app.bridges.channels import samples_of
from cubeling.app.bridges.osc_socket import OscMessage, OscReceiver, OscSender, Value
from cubeling.app.counted import quantity
from cubeling.app.pipeline.scenario import Inputs
from cubeling.app.pipeline.step import Step
from cubeling.app.pipeline.table.acts import Act
from cubeling.app.running.instrument import Instrument
from cubeling.characters import Character

OUT, IN = "/cubeling", "/cubeling/in"
"""How the addresses begin of what is sent, and of what is taken."""

MAX_ACTS_AT_ONCE = 16
"""So many acts and marks are carried out in a frame; more are dropped."""

_NOT_IN_ADDRESSES = re.compile(r"[^\x21-\x7e]|[#*,?\[\]{}]")


class OscOut(Instrument):
    """Sends every channel of a session."""

    def __init__(self, address: UdpAddress) -> None:
        self._sender = OscSender(address)
        self._first: float | None = None

    def follow(self, step: Step, cast: Sequence[Character], taken: float) -> Inputs:
        """Send every channel of a step."""
        self._first = step.frame.timestamp if self._first is None else self._first
        self._sender.send(messages_of(step, self._first))
        return Inputs()

    def happen(self, event: str, taken: float) -> None:
        """Send what has happened."""
        self._sender.send([OscMessage(f"{OUT}/event", (event,))])

    def close(self) -> None:
        """Close the socket; a second call does nothing."""
        self._sender.close()


def messages_of(step: Step, first: float) -> Iterator[OscMessage]:
    """Yield the time since the `first` frame [s], then each column of each channel with a value."""
    yield OscMessage(f"{OUT}/time", (step.frame.timestamp - first,))
    for sample in samples_of(step):
        folder = f"{OUT}{_NOT_IN_ADDRESSES.sub('_', sample.topic)}"
        for column, cell in sample.cells:
            if cell is not None:
                yield OscMessage(f"{folder}/{column.name}", tuple(_flat(cell)))


def _flat(cell: object) -> Iterable[Value]:
    """Return a cell as arguments: lists in lists one after the other."""
    if isinstance(cell, np.ndarray | np.generic):
        return list(np.asarray(cell).ravel().tolist())
    if isinstance(cell, list | tuple):
        return [value for each in cell for value in _flat(each)]
    return [cell if isinstance(cell, bool | int | float | str) else str(cell)]


class OscIn(Instrument):
    """Takes what characters are to do.

    `on_problem` is called with one line when something is not taken, for each reason once.
    """

    speaks = True

    def __init__(self, address: UdpAddress, on_problem: Callable[[str], None]) -> None:
        self._receiver = OscReceiver(address)
        self._on_problem = on_problem
        self._told: set[str] = set()
        self.unknown = 0
        """Messages that ask for nothing that there is."""
        self.dropped = 0
        """Messages beyond `MAX_ACTS_AT_ONCE`."""

    @property
    def port(self) -> int:
        """The port at which it listens."""
        return self._receiver.port

    @property
    def counts(self) -> dict[str, int]:
        """What was not taken, by the reason."""
        return {
            "came faster than frames": self._receiver.dropped + self.dropped,
            "could not be read": self._receiver.malformed,
            "asked for nothing that there is": self.unknown,
        }

    def follow(self, step: Step, cast: Sequence[Character], taken: float) -> Inputs:
        """Return what was asked for since the last frame."""
        inputs = Inputs()
        for message in self._receiver.receive():
            asked = _asked(message, inputs)
            if asked is None:
                self.unknown += 1
            elif len(asked.acts) + len(asked.marks) > MAX_ACTS_AT_ONCE:
                self.dropped += 1
            else:
                inputs = asked
        for reason, count in self.counts.items():
            if count and reason not in self._told:
                self._told.add(reason)
                self._on_problem(f"OSC drops messages that {reason}")
        return inputs

    def close(self) -> None:
        """Close the socket, and say how much was not taken; a second call does nothing."""
        self._receiver.close()
        for reason in sorted(self._told):
            count = quantity(self.counts[reason], "message")
            self._on_problem(f"OSC dropped {count} that {reason}")
        self._told.clear()


Arguments = tuple[Value, ...]


def _act(kind: str) -> Callable[[Inputs, str, Arguments], Inputs]:
    """Return what adds an act of a kind with a name or text and, of an action, its weight."""

    def add(inputs: Inputs, who: str, given: Arguments) -> Inputs:
        text, *more = given
        weight = _number(more[0]) if more else 1.0
        if not isinstance(text, str) or not text or len(more) > (kind == "action"):
            raise ValueError
        return replace(inputs, acts=(*inputs.acts, Act(kind, text, weight, who=who)))  # type: ignore[arg-type]

    return add


def _feel(inputs: Inputs, who: str, given: Arguments) -> Inputs:
    """Add an emotion: valence and arousal, a word, or nothing to leave it to the scenario."""
    emotion = None
    if len(given) == 2:
        emotion = Emotion(_number(given[0]), _number(given[1]))
    elif given:
        (word,) = given
        emotion = Emotion(*WORD_PLACES[str(word)], str(word))
    return replace(inputs, acts=(*inputs.acts, Act("emotion", emotion=emotion, who=who)))


def _mark(inputs: Inputs, who: str, given: Arguments) -> Inputs:
    name = " ".join(map(str, given))
    if who or len(name) > MAX_MARK_CHARS or not name.isprintable():
        raise ValueError
    return replace(inputs, marks=(*inputs.marks, name))


def _type(inputs: Inputs, who: str, given: Arguments) -> Inputs:
    (text,) = given
    if who or not isinstance(text, str):
        raise ValueError
    return replace(inputs, typed=" ".join(filter(None, (inputs.typed, text[:MAX_TYPED_CHARS]))))


def _press(pressed: Callable[[Inputs], Inputs]) -> Callable[[Inputs, str, Arguments], Inputs]:
    """Return what does as a key of the player; a button that sends 0 is let go."""

    def press(inputs: Inputs, who: str, given: Arguments) -> Inputs:
        if who or len(given) > 1:
            raise ValueError
        down = not given or bool(_number(given[0]))
        return pressed(inputs) if down else inputs

    return press


def _number(value: Value) -> float:
    if isinstance(value, str) or not -1.0 <= value <= 1.0:
        raise ValueError
    return float(value)


MAX_MARK_CHARS = 200
"""Longest name of a mark."""

MAX_TYPED_CHARS = 500
"""Longest line that is typed."""

TAKEN: dict[str, Callable[[Inputs, str, Arguments], Inputs]] = {
    "action": _act("action"),
    "gesture": _act("gesture"),
    "say": _act("say"),
    "emotion": _feel,
    "mark": _mark,
    "type": _type,
    "hush": _press(lambda inputs: replace(inputs, hush=True)),
    "clear": _press(lambda inputs: replace(inputs, clear=True)),
    "inside": _press(lambda inputs: replace(inputs, inside=True)),
}
"""What is taken, by the part of the address after `IN`: a new one is registered here."""


def _asked(message: OscMessage, inputs: Inputs) -> Inputs | None:
    """Return inputs with what a message asks for; None if it asks for nothing that there is."""
    if not message.address.startswith(f"{IN}/"):
        return None
    name, _, who = message.address.removeprefix(f"{IN}/").partition("/")
    try:
        return TAKEN[name](inputs, who, message.arguments)
    except (KeyError, ValueError, TypeError, IndexError):
        return None
