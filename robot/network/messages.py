"""Every message of the tree: one frozen dataclass for each kind of topic."""

from dataclasses import dataclass
from typing import Any

from robot.network import schema as s
from robot.network.schema import entry


@dataclass(frozen=True)
class Status:
    """Who is there; repeated as a heartbeat."""

    session: int = entry(s.SERIAL, "which run of the program; a later run has a greater one")
    number: int = entry(s.COUNT, "counts up by one with every heartbeat")
    status: str = entry(
        s.PRESENCE, "lost: the last will, sent by the broker; closed: it said goodbye"
    )
    follows: tuple[str, ...] = entry(
        s.TEXTS, "of a robot: whom it follows, SITE/NAME, either may be *", ()
    )


@dataclass(frozen=True)
class Action:
    """Something that a character does, once."""

    session: int = entry(s.SERIAL, "the player's")
    number: int = entry(s.SERIAL, "counts up by one with every action of the session")
    oldest: int = entry(
        s.SERIAL, "earlier actions than this one will not come again: all have them, or too late"
    )
    name: str = entry(s.TEXT, 'what is done: "kiss"')
    weight: float = entry(s.UNIT, "how strongly", 0.0)
    age: float = entry(s.SECONDS, "how long ago, when this was sent", 0.0)


@dataclass(frozen=True)
class Feeling:
    """What a character, and whoever follows it, feels from now on."""

    session: int = entry(s.SERIAL, "the player's")
    number: int = entry(s.SERIAL, "counts up by one with every change")
    valence: float = entry(s.UNIT, "unpleasant to pleasant")
    arousal: float = entry(s.UNIT, "calm to excited")
    label: str | None = entry(s.TEXT, "the word for it, if it has one", None)


@dataclass(frozen=True)
class Taken:
    """How far a robot has taken its players' actions: the acknowledgement."""

    session: int = entry(s.SERIAL, "the robot's")
    number: int = entry(s.COUNT, "counts up by one with every change")
    players: dict[str, tuple[int, int]] = entry(  # noqa: RUF009 # a field
        s.MARKS, "session and number of the last action taken of each"
    )


@dataclass(frozen=True)
class RobotState:
    """What is known of a robot."""

    session: int = entry(s.SERIAL, "the robot's")
    number: int = entry(s.COUNT, "counts up by one with every change")
    link: str = entry(s.TEXT, "of its line: connecting, ready, degraded, lost, closed")
    player: str | None = entry(s.TEXT, "who has it, SITE/NAME", None)
    commanded: tuple[float, float] | None = entry(s.POINT, "what it was asked to feel", None)
    acknowledged: tuple[float, float] | None = entry(
        s.POINT, "what it has confirmed to have taken", None
    )
    observed: tuple[float, float] | None = entry(s.POINT, "what it says that it shows", None)
    label: str | None = entry(s.TEXT, "its own word for what it shows", None)
    motion: str | None = entry(s.TEXT, "the motion being played", None)
    battery: float | None = entry(s.SHARE, "empty to full", None)
    charging: bool = entry(s.FLAG, "whether the battery is being charged", False)
    played: int = entry(s.COUNT, "actions handed to the robot", 0)
    unknown: int = entry(s.COUNT, "actions taken that it has no motion or sound for", 0)
    missed: int = entry(s.COUNT, "actions taken while it could not be reached", 0)


KINDS: dict[tuple[str, str], type[Any]] = {
    ("player", "status"): Status,
    ("player", "action"): Action,
    ("player", "emotion"): Feeling,
    ("robot", "status"): Status,
    ("robot", "taken"): Taken,
    ("robot", "state"): RobotState,
}
"""What is said on which topic, by role and kind."""

RETAINED = frozenset({"status", "emotion", "taken", "state"})
"""Kinds of which the broker keeps the last one for whoever comes later."""
