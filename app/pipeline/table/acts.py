"""What somebody beside the player asks a character to do: an experimenter, or another program."""

from dataclasses import dataclass
from typing import Literal

from cubeling.affect import Emotion
from cubeling.app.pipeline.table.spoken_line import LEAD

ACTION_S = 3.0
"""How long an action goes on that nobody ends before [s]."""

MAX_PLACE_M = 1.0
"""How far from the middle of the table a character may be sent along x and z [m]."""

MAX_SAID_CHARS = 500
"""Longest text that may be said at once."""


@dataclass(frozen=True)
class ActNote:
    """What a wizard's desk notes of an act, for those who analyse the session."""

    number: int
    """Of the act in its session, from 1; of an undo, that of the act that was an error."""

    cue: str = ""
    """The cue that it answers; "" for none."""

    delay_s: float | None = None
    """Time from the cue to the act [s]; None without a cue."""


@dataclass(frozen=True)
class Act:
    """One thing that a character is to do, whatever its scenario decides."""

    kind: Literal["action", "gesture", "say", "emotion", "go", "play", "cue", "undo"]
    """"action" takes the place of the scenario's for `ACTION_S`, "idle" ends it; "gesture" is made
    besides; "say" cuts off what is being said; "emotion" is shown by character and robot until
    another one comes; "go" leads to a place, and keeps the character there until another one comes.
    "play" is done by the robot. "cue" is only noted; "undo" ends what a noted act still does."""

    text: str = ""
    """The name of an action or gesture, or what is said, whose tags name gestures; the motion or
    sound of the robot; the name of the cue."""

    weight: float = 1.0
    """Intensity of an action, −1…1."""

    emotion: Emotion | None = None
    """What is shown; None to show again what the scenario decides."""

    place: tuple[float, float] | None = None
    """Where to go, (x, z) on the table [m]; None to go again where the scenario decides."""

    note: ActNote | None = None
    """What a wizard's desk notes of it; None for another program's."""

    who: str = LEAD
    """Name in the cast of who does it; `LEAD` for the first."""
