"""What enters and what leaves an animator."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cubeling.affect import Emotion
from cubeling.characters.behaviour.intents import BehaviourIntent
from cubeling.characters.control.speech_profile import DEFAULT_PROFILE, SpeechProfile
from cubeling.characters.locomotion.gaits import IDLE_SPEED
from cubeling.characters.locomotion.obstacles import Obstacle, TableView
from cubeling.characters.skeleton.pose import Pose
from cubeling.characters.speech.speech import Utterance


@dataclass(frozen=True)
class LocomotionIntent:
    """Where to go and how fast, and where to face when standing."""

    speed: float = 0.0
    """AvatAR's Speed, 0…5: up to `IDLE_SPEED` standing, to 3 walking, above running."""

    target: NDArray[np.float64] | None = None
    """Where to go, (x, z) in the table frame [m]; None to stay."""

    stop: bool = True
    """Whether to stop at the target; False for a point that moves ahead along a path."""

    facing: NDArray[np.float64] | None = None
    """A point to turn to when standing, (x, z) in the table frame [m]; None to keep the heading."""

    exact: bool = False
    """Whether it must be this place, because hands reach something from there; else the character
    may stand nearby, where it is seen."""


@dataclass(frozen=True)
class ActionIntent:
    """An action to perform."""

    name: str
    """The name of an action that the character knows ("kiss", "shout"), or "idle" to stand."""

    weight: float = 0.0
    """Intensity, −1…1."""


@dataclass(frozen=True)
class SpeechIntent:
    """Something to say: the mouth, the face and the hands follow its sound."""

    utterance: Utterance
    """What is said, with the times of its phones and accents."""

    start: float
    """When its sound begins [s]; may lie in the past."""

    profile: SpeechProfile = DEFAULT_PROFILE
    """How it is said with the body."""

    emphasis: float = 0.0
    """How much more, or less, body and mouth stress it in this frame, −1…1."""

    @property
    def end(self) -> float:
        """When its sound ends [s]."""
        return self.start + self.utterance.duration

    def sounds_at(self, time: float) -> bool:
        """Return whether it is heard at a time [s]."""
        return self.start <= time < self.end


@dataclass(frozen=True)
class ComingAct:
    """What a character will be asked to do soon, where that is known."""

    start: float
    """When [s]."""

    action: str = ""
    """Name of the action; "" for gestures, and for what it says."""


@dataclass(frozen=True)
class CharacterCommand:
    """What a scenario asks of a character in one frame: intents, each optional."""

    timestamp: float
    """Time of the frame [s]."""

    locomotion: LocomotionIntent | None = None
    """Where to go; None to stay."""

    action: ActionIntent | None = None
    """What to do instead of going somewhere; None for nothing."""

    gaze: NDArray[np.float64] | None = None
    """A point that head and eyes follow, (x, y, z) in the table frame [m]; None for none."""

    emotion: Emotion | None = None
    """What face and posture show; None for what the clips have."""

    visible: bool = True
    """Whether the character is drawn."""

    speech: SpeechIntent | None = None
    """What the character says, or has just said; None for nothing."""

    behaviour: BehaviourIntent | None = None
    """What hands, head, face, eyes and posture are to do besides; None for nothing."""

    obstacles: tuple[Obstacle, ...] = ()
    """What the character keeps out of."""

    view: TableView | None = None
    """How the table is seen: it prefers places where it is seen, too; None for any place."""

    coming: ComingAct | None = None
    """What it will do next: a shift of its weight ends before that. None where nobody knows."""

    @property
    def speaks(self) -> bool:
        """Whether something is heard of what the character says."""
        return self.speech is not None and self.speech.sounds_at(self.timestamp)

    @property
    def activity(self) -> str:
        """The name of the action, else "move" or "idle".

        >>> CharacterCommand(0.0, LocomotionIntent(speed=2.0)).activity
        'move'
        """
        if self.action is not None:
            return self.action.name
        return "move" if self.speed > IDLE_SPEED else "idle"

    @property
    def speed(self) -> float:
        """AvatAR's Speed that is asked for; 0 without locomotion."""
        return 0.0 if self.locomotion is None else self.locomotion.speed

    @property
    def weight(self) -> float:
        """Intensity of the action; 0 without one."""
        return 0.0 if self.action is None else self.action.weight


@dataclass(frozen=True)
class PosedCharacter:
    """A character as it is to be drawn."""

    pose: Pose
    """Of its joints and morphs, all layers included."""

    table_from_character: NDArray[np.float64]
    """Where it stands, (4, 4): the character frame scaled to the table, turned and placed."""

    visible: bool
    """Whether to draw it."""

    state: str
    """Name of the state it is in: "idle", "walk", "run", "hop", "kiss" …"""

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
