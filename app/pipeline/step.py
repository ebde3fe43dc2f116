"""What one frame led to, and what a replay may give instead."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from app.pipeline.scenario import EmotionTarget, Outcome
from characters import CharacterCommand, PosedCharacter
from tracking import CubeControls, CubeState, Frame


@dataclass(frozen=True)
class Step:
    """All that one frame led to: every arrow of the line."""

    frame: Frame
    """The camera's picture."""

    state: CubeState
    """Where the cube is."""

    controls: CubeControls
    """What the hand does with it."""

    outcome: Outcome
    """What the scenario wants: command, emotion, hint, marks on the table."""

    posed: PosedCharacter
    """The character as it is to be drawn."""

    picture: NDArray[np.uint8] | None
    """The camera's picture with the character on the table, (height, width, 3) BGR;
    None where nothing draws."""

    @property
    def command(self) -> CharacterCommand:
        """What the character is asked to do."""
        return self.outcome.command

    @property
    def emotion(self) -> EmotionTarget:
        """What the robot is asked to feel."""
        return self.outcome.emotion

    def arrows(self) -> dict[str, object]:
        """Every arrow between the camera and the picture, by its channel in a recording."""
        return {
            "/cube/state": self.state,
            "/cube/controls": self.controls,
            "/character/command": self.command,
            "/character/pose": self.posed,
            "/robot/emotion": self.emotion,
        }


@dataclass(frozen=True)
class Given:
    """Arrows that are known already: a recording replayed from further down the line."""

    state: CubeState | None = None
    """Where the cube is; None to track it."""

    controls: CubeControls | None = None
    """What the hand does; None to read it from the state."""

    command: CharacterCommand | None = None
    """What the character is asked; None to ask the scenario."""

    posed: PosedCharacter | None = None
    """The character; None to animate it."""


@dataclass(frozen=True)
class RobotView:
    """What is known of the robot when a frame is shown."""

    link: str
    """"ready", "connecting", "lost", "none" …"""

    mood: float
    """Valence that the robot itself reports, −1…1; the asked one where there is no robot."""

    label: str
    """Its word for it: "angry", "neutral", "happy", or another that it knows."""

    real: bool = False
    """Whether it stands on the desk; one that is simulated, or absent, is drawn instead."""
