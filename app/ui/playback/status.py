"""What a session tells its screen besides the steps: where it is, and what can be chosen."""

from dataclasses import dataclass


@dataclass(frozen=True)
class PlaybackMark:
    """Something that happened in a recording."""

    position: float
    """When, from the first frame [s]."""

    event: str
    """What: "placed front", "start over" …"""


@dataclass(frozen=True)
class Position:
    """Where a session is in its recording. Times are from the first frame of the recording [s]."""

    now: float
    """Time of the frame that is shown [s]."""

    length: float
    """The end of the recording."""

    start: float
    """Where the part that is played starts."""

    end: float
    """Where the part that is played ends [s]."""

    target: float | None = None
    """Where it seeks to; None if it does not seek."""

    marks: tuple[PlaybackMark, ...] = ()
    """What happened in it."""


@dataclass(frozen=True)
class MenuChoice:
    """Something that the player can choose."""

    part: str
    """The part of the session: "camera", "character", "robot"."""

    value: str
    """What the option of that name takes."""

    label: str
    """What the player reads."""

    present: bool = False
    """Whether it is in use."""


@dataclass(frozen=True)
class EndCard:
    """A card at the end of a recording: what the player can do next."""

    title: str
    """First line of the card, in large letters."""

    lines: tuple[tuple[str, str], ...] = ()
    """What can be done, and the command or key that does it."""


@dataclass(frozen=True)
class SessionStatus:
    """The state of a session between two frames."""

    scenario: str = ""
    """Name of the scenario that plays; "" for none."""

    source: str = ""
    """URI of what its frames come from."""

    paused: bool = False
    """Whether it is paused."""

    seeking: bool = False
    """Whether frames are processed and not shown, until the one that is sought."""

    recorded: bool = False
    """Whether it is being recorded, by R or from its start."""

    recording: float | None = None
    """How long the recording is that R began [s]; None if there is none."""

    position: Position | None = None
    """Where it is in its recording; None for a live camera."""

    ending: EndCard | None = None
    """The card to show, once the recording has ended."""

    choices: tuple[MenuChoice, ...] = ()
    """What can be chosen, as far as it is known."""

    looking: bool = False
    """Whether more choices may be found."""

    listens: bool = False
    """Whether what is typed is said to the character."""

    hears: bool = False
    """Whether what the player says now is heard."""


NO_STATUS = SessionStatus()
"""The status of a screen that was told nothing."""
