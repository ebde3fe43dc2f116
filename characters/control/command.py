"""What enters and what leaves an animator."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from characters.skeleton.pose import Pose


@dataclass(frozen=True)
class CharacterCommand:
    """What a scenario asks of a character in one frame."""

    timestamp: float
    """That of the frame [s]."""

    action: str = "idle"
    """"idle", "move", or the name of an action that the character knows ("kiss", "shout")."""

    speed: float = 0.0
    """AvatAR's Speed, 0…5: below 0.5 idle, to 3 walking, above running."""

    target: NDArray[np.float64] | None = None
    """Where to go, (x, z) in the table frame [m]; None to stay."""

    look_at: NDArray[np.float64] | None = None
    """A point to turn to when standing, (x, z) in the table frame [m], or None."""

    gaze: NDArray[np.float64] | None = None
    """A point that head and eyes follow, (x, y, z) in the table frame [m], or None."""

    weight: float = 0.0
    """Intensity of the action, −1…1."""

    feeling: NDArray[np.float64] | None = None
    """What face and bearing show: (valence, arousal), each −1…1; None for what the clips have."""

    mood: str = ""
    """The word for that feeling, "happy", "angry" …, as everyone else shows it; "" for none."""

    visible: bool = True
    """Whether the character is to be seen."""

    stop: bool = True
    """Whether to stop at the target; False for a point that runs ahead along a path."""


@dataclass(frozen=True)
class PosedCharacter:
    """A character as it is to be drawn."""

    pose: Pose
    """The joints."""

    table_from_character: NDArray[np.float64]
    """Where it stands, (4, 4): the character frame scaled to the table, turned and placed."""

    visible: bool
    """Whether to draw it."""

    state: str
    """Name of the state it is in: "idle", "walk", "run", "kiss" …"""

    speed: float
    """The Speed that was used, 0…5."""

    angular: float
    """The change of its direction of movement that steers the turn clips [rad], −π/2…π/2.

    Positive to its right.
    """

    weight: float
    """The intensity in use, −1…1."""

    timestamp: float
    """That of the frame [s]."""
