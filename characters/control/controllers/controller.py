"""What every controller is: it decides what a character plays, and where it stands."""

from dataclasses import dataclass
from typing import Protocol

from cubeling.characters.control.command import CharacterCommand
from cubeling.characters.locomotion.gaits import TOP_SPEED
from cubeling.characters.model.character import Character
from cubeling.characters.motion.motion import RootDelta
from cubeling.characters.skeleton.pose import Pose


@dataclass(frozen=True)
class ControllerFrame:
    """What a controller plays in one frame."""

    pose: Pose
    """The pose of its clips, with the root in place."""

    state: str
    """What the character is doing: "idle", "walk", "run", "hop", or the name of an action."""

    place: RootDelta
    """Where it stands on the table [m] and where it faces [rad]."""

    height: float = 0.0
    """Its height above the table [m]."""

    speed: float = 0.0
    """AvatAR's Speed in use, 0…5."""

    angular: float = 0.0
    """How sharply it turns [rad], positive to its right."""

    weight: float = 0.0
    """The intensity in use, −1…1."""

    acting: bool = False
    """Whether an action needs head and trunk, so that less is laid over them."""

    shows_emotion: bool = False
    """Whether the clip shows an emotion itself, so that the face need not."""

    feet_down: list[bool] | None = None
    """Which feet the clips have on the ground; None if feet are not to be held."""

    standing: bool = False
    """Whether the feet step back to their places where they were left elsewhere."""

    @property
    def effort(self) -> float:
        """How hard the body works, 0 at rest … 1 at a full run."""
        return self.speed / TOP_SPEED


class CharacterController(Protocol):
    """Plays one character under commands: chosen by `first_suitable`, or by name.

    `scale` is in table metres per metre of the character. Without a first `place` it starts where
    it is first sent.
    """

    walks: bool
    """Whether it walks and runs; else it hops."""

    def __init__(self, character: Character, scale: float, place: RootDelta | None) -> None: ...

    @property
    def actions(self) -> tuple[str, ...]:
        """The actions that it knows, besides standing, walking and running."""
        ...

    def update(
        self, command: CharacterCommand, elapsed: float, tempo: float = 1.0
    ) -> ControllerFrame:
        """Advance by a time [s] under a command and return what is played.

        `tempo` is that of standing: an emotion changes it.

        Raises
        ------
        CharacterError
            If the character does not know the action.
        """
        ...
