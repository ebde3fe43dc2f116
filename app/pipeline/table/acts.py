"""What somebody beside the player asks a character to do: an experimenter, or another program."""

from dataclasses import dataclass
from typing import Literal

from cubeling.affect import Emotion
from cubeling.app.pipeline.table.spoken_line import LEAD

ACTION_S = 3.0
"""How long an action goes on that nobody ends before [s]."""

MAX_SAID_CHARS = 500
"""Longest text that may be said at once."""


@dataclass(frozen=True)
class Act:
    """One thing that a character is to do, whatever its scenario decides."""

    kind: Literal["action", "gesture", "say", "emotion"]
    """"action" takes the place of the scenario's for `ACTION_S`, "idle" ends it; "gesture" is made
    besides; "say" cuts off what is being said; "emotion" is shown by character and robot until
    another one comes."""

    text: str = ""
    """The name of an action or gesture, or what is said, whose tags name gestures."""

    weight: float = 1.0
    """Intensity of an action, −1…1."""

    emotion: Emotion | None = None
    """What is shown; None to show again what the scenario decides."""

    who: str = LEAD
    """Name in the cast of who does it; `LEAD` for the first."""
