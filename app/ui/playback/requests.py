"""What a player asks for with a key or the mouse.

A scenario sees only `StartOver`, `PlayScenario` and `OpenCube`, as `Inputs`, and a recording keeps
them.
"""

from dataclasses import dataclass
from enum import Enum


class WindowRequest(Enum):
    """What the window does by itself; the value says what."""

    MIRROR = "mirror the picture"
    SNAPSHOT = "write the picture to a file"
    FULL_SCREEN = "fill the screen, or return to the place and size from before"
    PANELS = "show or hide the panels"
    KEYS = "show or hide the keys"
    MENU = "show or hide the menu"
    SCENARIOS = "show or hide what can be played"
    BACK = "close what lies over the picture, else the window"
    QUIT = "close the window"


@dataclass(frozen=True)
class StartOver:
    """Forget the path and the mood."""


@dataclass(frozen=True)
class PlayScenario:
    """Go on with another scenario, with the same camera and robot."""

    number: int
    """Its place in the list of scenarios, from 1."""


@dataclass(frozen=True)
class OpenCube:
    """Open the cube with the character in it, or close it."""


@dataclass(frozen=True)
class Pause:
    """Pause, or go on."""


@dataclass(frozen=True)
class Seek:
    """Go back or ahead in a recording."""

    seconds: float
    """How far ahead; negative to go back [s]."""


@dataclass(frozen=True)
class SeekTo:
    """Go to a place in a recording."""

    position: float
    """Time from its first frame; infinite for its end [s]."""


@dataclass(frozen=True)
class StepFrames:
    """Pause, and show another frame of a recording."""

    count: int
    """How many frames ahead; negative to go back."""


@dataclass(frozen=True)
class Record:
    """Begin a recording, or end it."""


@dataclass(frozen=True)
class MarkMoment:
    """Mark this moment in the recording that is being made."""


@dataclass(frozen=True)
class NameMark:
    """Say what the last mark is."""

    name: str
    """A digit, a name, or "TYPE: NAME"."""


@dataclass(frozen=True)
class Listen:
    """Listen to what the player says; or, the second time, it has been said."""


@dataclass(frozen=True)
class ListChoices:
    """Find out which cameras, characters and robots there are."""


@dataclass(frozen=True)
class Choose:
    """Exchange a part of the session."""

    part: str
    """"camera", "character" or "robot"."""

    value: str
    """A URI, a name or a path, as the option of the same name takes it."""


@dataclass(frozen=True)
class ChangeSetting:
    """Change a setting of the scenario that is played."""

    setting: str
    """A field of `SessionOptions`."""

    value: str | float


@dataclass(frozen=True)
class ChangeSound:
    """Change how a session sounds."""

    setting: str
    """"volume" or "muted"."""

    value: float
    """0…1, or whether nothing sounds."""


@dataclass(frozen=True)
class ChangeSpeech:
    """Change how the next line is said."""

    setting: str
    """"language", or a field of `SpeechProfile`."""

    value: str | float


PlayerInput = StartOver | PlayScenario | OpenCube
"""What the scenario is told."""

SessionRequest = (
    Pause
    | Seek
    | SeekTo
    | StepFrames
    | Record
    | MarkMoment
    | NameMark
    | Listen
    | ListChoices
    | Choose
    | ChangeSetting
    | ChangeSound
    | ChangeSpeech
)
"""What the session carries out."""

Request = WindowRequest | PlayerInput | SessionRequest
