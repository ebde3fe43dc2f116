"""The JSON messages of the topic tree: a struct for each kind of topic, encoded and validated.

`tools.network_reference` writes the tables in docs/many.md from their JSON schemas.
"""

from collections.abc import Iterator
from typing import Annotated, Any, Literal, TypeVar

import msgspec
from msgspec import Meta, Struct

from cubeling.robot.errors import RobotError

MAX_PAYLOAD_BYTES = 4096
"""Largest payload that is sent or read [bytes]."""

MAX_TEXT_BYTES = 80
"""Longest text in a message [bytes of UTF-8]."""

MAX_INTEGER = 2**53 - 1
"""Largest integer: beyond it, JSON readers that use doubles lose bits."""

MAX_ENTRIES = 32
"""Most entries of a list or a table in a message."""

M = TypeVar("M", bound=Struct)

Count = Annotated[int, Meta(ge=0, le=MAX_INTEGER)]
Serial = Annotated[int, Meta(ge=1, le=MAX_INTEGER)]
Unit = Annotated[float, Meta(ge=-1, le=1)]
Share = Annotated[float, Meta(ge=0, le=1)]
Text = Annotated[str, Meta(max_length=MAX_TEXT_BYTES)]
Texts = Annotated[tuple[Text, ...], Meta(max_length=MAX_ENTRIES)]
Point = Annotated[tuple[Unit, Unit], Meta(title="[valence, arousal], each −1 … 1")]
Acks = Annotated[
    dict[Text, tuple[Count, Count]],
    Meta(
        max_length=MAX_ENTRIES,
        title=f"table of ≤ {MAX_ENTRIES}: SITE/NAME to [session, number]",
    ),
]


def _doc(description: str) -> Meta:
    return Meta(description=description)


class MalformedError(RobotError):
    """A payload that is not a valid message; it is counted and ignored."""


class StatusMessage(Struct, frozen=True, omit_defaults=True):
    """Presence of a member; repeated as a heartbeat."""

    session: Annotated[Serial, _doc("epoch of the program; greater for a later start")]
    number: Annotated[Count, _doc("increases by one with every heartbeat")]
    status: Annotated[
        Literal["online", "lost", "closed"],
        _doc("lost: the last will, sent by the broker; closed: by the member at its end"),
    ]
    follows: Annotated[
        Texts, _doc("of a robot: players to follow, SITE/NAME, either may be *")
    ] = ()


class ActionMessage(Struct, frozen=True, omit_defaults=True):
    """A single action of a character."""

    session: Annotated[Serial, _doc("the player's")]
    number: Annotated[Serial, _doc("increases by one with every action of the session")]
    oldest: Annotated[Serial, _doc("first action still sent: the others are taken or expired")]
    name: Annotated[Text, _doc('the action: "kiss"')]
    weight: Annotated[Unit, _doc("its strength")] = 0.0
    age: Annotated[float, Meta(ge=0), _doc("time since the action when this was sent [s]")] = 0.0


class EmotionMessage(Struct, frozen=True, omit_defaults=True):
    """Emotion of a character, and of the robots that follow it, from now on."""

    session: Annotated[Serial, _doc("the player's")]
    number: Annotated[Serial, _doc("increases by one with every change")]
    valence: Annotated[Unit, _doc("unpleasant to pleasant")]
    arousal: Annotated[Unit, _doc("calm to excited")]
    label: Annotated[Text | None, _doc("its word, if it has one")] = None


class AckMessage(Struct, frozen=True, omit_defaults=True):
    """Acknowledgement: the last action that a robot took of each player."""

    session: Annotated[Serial, _doc("the robot's")]
    number: Annotated[Count, _doc("increases by one with every change")]
    players: Annotated[Acks, _doc("session and number of the last action of each player")]


class StateMessage(Struct, frozen=True, omit_defaults=True):
    """State of a robot."""

    session: Annotated[Serial, _doc("the robot's")]
    number: Annotated[Count, _doc("increases by one with every change")]
    link: Annotated[Text, _doc("state of its link: connecting, ready, degraded, lost, closed")]
    player: Annotated[Text | None, _doc("the player it shows, SITE/NAME")] = None
    commanded: Annotated[Point | None, _doc("the emotion commanded")] = None
    acknowledged: Annotated[Point | None, _doc("the emotion that it acknowledged")] = None
    observed: Annotated[Point | None, _doc("the emotion that it says it shows")] = None
    label: Annotated[Text | None, _doc("its own word for what it shows")] = None
    motion: Annotated[Text | None, _doc("the motion being played")] = None
    battery: Annotated[Share | None, _doc("empty to full")] = None
    charging: Annotated[bool, _doc("whether the battery is being charged")] = False
    played: Annotated[Count, _doc("actions played")] = 0
    unknown: Annotated[Count, _doc("actions without a motion or sound of that name")] = 0
    missed: Annotated[Count, _doc("actions taken while it could not be reached")] = 0


MESSAGE_TYPES: dict[tuple[str, str], type[Any]] = {
    ("player", "status"): StatusMessage,
    ("player", "action"): ActionMessage,
    ("player", "emotion"): EmotionMessage,
    ("robot", "status"): StatusMessage,
    ("robot", "taken"): AckMessage,
    ("robot", "state"): StateMessage,
}
"""The message of each topic, by role and kind."""

RETAINED_KINDS = frozenset({"status", "emotion", "taken", "state"})
"""Kinds of topics whose last message the broker keeps for later subscribers."""


def encode(message: Struct) -> bytes:
    """Return a message's payload; fields with default values are left out."""
    return msgspec.json.encode(message)


def decode(kind: type[M], payload: bytes) -> M:
    """Return the message in a payload. Unknown fields are ignored: a later version added them.

    Raises MalformedError if the payload is too long, is not a JSON object, lacks a field, or has
    an invalid one.
    """
    if len(payload) > MAX_PAYLOAD_BYTES:
        raise MalformedError(f"{len(payload)} bytes; a message has at most {MAX_PAYLOAD_BYTES}")
    try:
        message = msgspec.json.decode(payload, type=kind)
    except (ValueError, RecursionError) as error:  # msgspec's errors are ValueErrors
        raise MalformedError(str(error)) from error
    for name, value in msgspec.structs.asdict(message).items():
        if not all(map(is_text, _texts(value))):
            raise MalformedError(
                f"Expected text of {MAX_TEXT_BYTES} printable bytes - at `$.{name}`"
            )
    return message


def is_text(text: str) -> bool:
    """Whether a text may be sent: printable, and not too long in UTF-8."""
    return text.isprintable() and len(text.encode()) <= MAX_TEXT_BYTES


def _texts(value: Any) -> Iterator[str]:
    match value:
        case str():
            yield value
        case tuple() | dict():
            for one in value:
                yield from _texts(one)
