"""What every scenario is: from what the hand does to what character and robot are to do."""

from dataclasses import dataclass, field, replace
from typing import Protocol

import numpy as np

from characters import CharacterCommand, PosedCharacter, Step
from characters.rendering import FloorPath
from robot import Emotion
from tracking import CubeControls


@dataclass(frozen=True)
class Inputs:
    """What enters a frame beside the camera's picture."""

    clear: bool = False
    """Whether the player asked to start over: forget the path, the mood …"""

    actions: tuple[str, ...] = ()
    """What the character on the table can be asked to do beside walking."""


@dataclass(frozen=True)
class EmotionTarget:
    """What character, likeness and robot feel, and are asked to show."""

    emotion: Emotion
    """Valence and arousal."""

    label: str
    """The word for it, with hysteresis: one of the personality's label set."""

    timestamp: float
    """That of the frame [s]."""

    def shown_by(self, command: CharacterCommand) -> CharacterCommand:
        """Return a command to a character that shows this too."""
        feeling = np.array([self.emotion.valence, self.emotion.arousal])
        return replace(command, feeling=feeling, mood=self.label)


@dataclass(frozen=True)
class Outcome:
    """What a scenario wants of one frame."""

    command: CharacterCommand
    """To the animator."""

    emotion: EmotionTarget
    """To the robot; face and bearing of the character show it too."""

    hint: str
    """One short sentence for the player: what to do now."""

    icon: str = "idle"
    """Name of the icon that stands for what is going on."""

    floor: tuple[FloorPath, ...] = field(default=())
    """What is painted on the table."""


class Scenario(Protocol):
    """A way to play. Its state advances by `update`, once a frame; it reads no clock."""

    name: str
    """How it is called on the command line."""

    cube: str
    """Name of the cube that it is made for."""

    character: str
    """Name of the bundled character that plays it."""

    personality: str
    """Name of the bundled personality that it is played with."""

    start: Step
    """Where the character first stands on the table [m], and which way it looks [rad]."""

    def update(
        self, controls: CubeControls, character: PosedCharacter | None, inputs: Inputs
    ) -> Outcome:
        """Decide on one frame.

        Parameters
        ----------
        controls
            What the hand does with the cube in this frame.
        character
            The character as it stood after the frame before, None in the first.
        inputs
            What else the player asked for.
        """
        ...
