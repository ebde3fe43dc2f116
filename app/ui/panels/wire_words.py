"""The messages on a robot's line, in words."""

from collections.abc import Callable, Iterator
from typing import Any, NamedTuple, Protocol

from cubeling.robot import Catalogue, FrameReader, MessageError, Sender, messages as m, unpack
from cubeling.robot.drivers import LineReader

MAX_LINE_CHARS = 56
"""Longest line of text that is shown."""


class Words(NamedTuple):
    """A message in words."""

    text: str
    """The message in a line of plain words."""

    routine: bool
    """Whether it is sent all the time, so that only the newest one matters."""


class WireDecoder(Protocol):
    """Turns the bytes of one direction into words."""

    def __init__(self, sender: Sender) -> None: ...

    def feed(self, data: bytes, catalogue: Catalogue | None) -> Iterator[Words]:
        """Return the messages that end in these bytes; `catalogue` names what they refer to."""
        ...


class CubelingDecoder:
    """Decodes the frames of the protocol "cubeling"."""

    def __init__(self, sender: Sender) -> None:
        self._sender: Sender = sender
        self._reader = FrameReader()

    def feed(self, data: bytes, catalogue: Catalogue | None) -> Iterator[Words]:
        """Return the messages that end in these bytes."""
        errors = self._reader.errors
        for body in self._reader.feed(data):
            try:
                _, message = unpack(body, self._sender)
            except MessageError as error:
                yield Words(str(error), False)
                continue
            if message is None:
                yield Words(f"an unknown message, {body[:1].hex()}", False)
            else:
                text = WORDS[type(message)](message, _names(catalogue))
                yield Words(printable(text), isinstance(message, ROUTINE))
        if self._reader.errors > errors:
            yield Words("bytes that are no message", False)


class LineDecoder:
    """Decodes protocols of lines of text, which speak for themselves."""

    def __init__(self, sender: Sender) -> None:
        self._reader = LineReader(1000)

    def feed(self, data: bytes, catalogue: Catalogue | None) -> Iterator[Words]:
        """Return the lines that end in these bytes."""
        for line in self._reader.feed(data):
            text = printable(line).strip()
            if text:
                more = "…" if len(text) > MAX_LINE_CHARS else ""
                yield Words(text[:MAX_LINE_CHARS] + more, False)


def printable(text: str) -> str:
    """Return a text of a robot with blanks for control codes."""
    return "".join(char if char.isprintable() else " " for char in text)


DECODERS: dict[str, type[WireDecoder]] = {"cubeling": CubelingDecoder}
"""The decoder of each protocol; all others are lines of text."""

Names = Callable[[int, int], str]
"""Returns the name of an item of the catalogue by its kind and index."""


def _names(catalogue: Catalogue | None) -> Names:
    joints = catalogue.joints if catalogue else ()

    def name(item: int, index: int) -> str:
        kinds: dict[int, tuple[str, tuple[str, ...]]] = {
            m.ITEM_JOINT: ("joint", tuple(each.name for each in joints)),
            m.ITEM_MOTION: ("motion", catalogue.motions if catalogue else ()),
            m.ITEM_SOUND: ("sound", catalogue.sounds if catalogue else ()),
            m.ITEM_MOOD: ("mood", catalogue.moods if catalogue else ()),
        }
        kind, names = kinds.get(item, (f"kind {item}", ()))
        return names[index] if index < len(names) else f"{kind} {index}"

    return name


def _express(message: m.Express, name: Names) -> str:
    mood = "" if message.mood == m.NOTHING else f" {name(m.ITEM_MOOD, message.mood)}"
    return f"{message.number}: feel{mood} {_emotion(message)}"


def _move(message: m.Move, name: Names) -> str:
    turned, released = (
        [name(m.ITEM_JOINT, joint) for joint in range(m.JOINTS_MAX) if bits >> joint & 1]
        for bits in (message.moved, message.released)
    )
    parts = [f"turn {', '.join(turned)} in {message.duration:.1f} s"] if turned else []
    parts += [f"let go of {', '.join(released)}"] if released else []
    return f"{message.number}: {' and '.join(parts) or 'move nothing'}"


def _ack(message: m.Ack, name: Names) -> str:
    if message.result == m.RESULT_TAKEN:
        return f"{message.number} is taken"
    return f"{message.number} is refused: {m.REFUSALS.get(message.result, 'another reason')}"


def _log(message: m.Log, name: Names) -> str:
    kind = {m.SEVERITY_INFO: "log", m.SEVERITY_WARNING: "warning"}.get(message.severity, "error")
    return f"{kind}: {message.text}"


def _state(message: m.State, name: Names) -> str:
    playing = [
        f", playing {name(item, index)}"
        for item, index in ((m.ITEM_MOTION, message.motion), (m.ITEM_SOUND, message.sound))
        if index != m.NOTHING
    ]
    mood = name(m.ITEM_MOOD, message.mood)
    return f"I feel {mood} {_emotion(message)}" + "".join(playing)


def _emotion(message: m.Express | m.State) -> str:
    """Return valence and arousal."""
    return f"({message.valence:+z.2f}, {message.arousal:+z.2f})"


WORDS: dict[type[Any], Callable[[Any, Names], str]] = {
    m.Hello: lambda hello, name: f"hello, I speak version {hello.version}",
    m.Ask: lambda ask, name: f"what is {name(ask.item, ask.index)}?",
    m.Beat: lambda beat, name: f"beat {beat.count}",
    m.Express: _express,
    m.Play: lambda play, name: f"{play.number}: play {name(play.item, play.index)}",
    m.Move: _move,
    m.Stop: lambda stop, name: f"{stop.number}: stop",
    m.Bye: lambda bye, name: "goodbye",
    m.Welcome: lambda welcome, name: f"welcome, I am {welcome.name} with {welcome.firmware}",
    m.Joint: lambda joint, name: f"joint {joint.index} is {joint.name}",
    m.Name: lambda entry, name: f"{_names(None)(entry.item, entry.index)} is {entry.name}",
    m.State: _state,
    m.Log: _log,
    m.Ack: _ack,
    m.Gone: lambda gone, name: "this session is not open here",
}
"""What each message of the protocol "cubeling" says; a test compares with `robot.protocol`."""

ROUTINE = (m.Beat, m.State)
"""Messages that are sent all the time."""
