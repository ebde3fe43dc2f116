"""How each model shows each mood: the settings, as they are used."""

from collections.abc import Mapping
from dataclasses import dataclass

Notes = tuple[tuple[int, int], ...]
"""Notes of a melody, each with its value: 4 is a quarter of a second, 8 an eighth."""

BAUDS = (57600, 115200)
"""Bits a second that OpenCat boards speak at."""


@dataclass(frozen=True)
class Mood:
    """How a mood is shown."""

    posture: str
    """The skill that is held while the mood lasts."""

    pose: Mapping[int, int]
    """Angles [deg] by the joint's number, taken after the posture and within the joints' limits."""

    gestures: tuple[str, ...]
    """Skills played now and then, in turn."""

    gesture_every: float
    """Time from one gesture to the next [s]; 0 for no gestures."""

    sound: str | None
    """The melody played once when the mood begins."""


@dataclass(frozen=True)
class Behaviour:
    """How a model behaves."""

    moods: Mapping[str, Mood]
    """By the moods' words; "neutral" is the first one."""

    motions: tuple[str, ...]
    """Skills that may be played by name: those named for this, and every posture and gesture."""

    sounds: Mapping[str, Notes]
    """Melodies by name."""

    stop: str
    """The posture taken for a stop."""


@dataclass(frozen=True)
class Settings:
    """Everything that a settings file says."""

    baud: int
    """Bits a second on the serial line."""

    model: str | None
    """Which of `MODELS` it is, whatever the board says; None to ask the board."""

    commands_per_s: float
    """Most lines sent in a second."""

    dwell: float
    """Time from the end of one skill to the beginning of the next [s]."""

    ask_every: float
    """Time without an answer after which a question is asked [s]."""

    rest_after: float
    """Time without a new mood after which the servos lose their power [s]; 0 for never."""

    behaviours: Mapping[str, Behaviour]
    """By model, one for each of `MODELS`."""
