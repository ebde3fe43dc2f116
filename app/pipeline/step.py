"""The result of one frame, and what a replay may provide instead of computing it."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cubeling.affect import Emotion
from cubeling.app.pipeline.choices import ROBOT_NAMES
from cubeling.app.pipeline.cube_window import Interior
from cubeling.app.pipeline.scenario import EmotionTarget, Outcome
from cubeling.app.pipeline.table.spoken_line import SpokenLine
from cubeling.characters import Character, CharacterCommand, PosedCharacter
from cubeling.robot import Catalogue, Telemetry
from cubeling.tracking import CubeControls, CubeState, Frame
from cubeling.tracking.appearance import Appearance

Rect = tuple[float, float, float, float]
"""Left, top, right and bottom of a rectangle in the picture."""


@dataclass(frozen=True)
class Performance:
    """What a character of the cast does in a frame."""

    name: str
    """Its name in the cast."""

    outcome: Outcome
    """The decision of its scenario."""

    posed: PosedCharacter
    """The character as it is to be drawn."""

    line: SpokenLine | None = None
    """What it says, also if it has begun before; None for nothing."""

    scenario: str = ""
    """Name of the scenario that decides for it."""

    @property
    def command(self) -> CharacterCommand:
        """What it is asked to do."""
        return self.outcome.command

    @property
    def emotion(self) -> EmotionTarget:
        """The emotion that it shows."""
        return self.outcome.emotion

    def messages(self) -> dict[str, object]:
        """Return its messages by the last part of their topics."""
        return {"command": self.command, "pose": self.posed, "emotion": self.emotion}


def speech_start(seen: Performance) -> float:
    """Return when the line began that a character says [s]; −∞ for silence."""
    speech = seen.command.speech
    return -math.inf if speech is None else speech.start


@dataclass(frozen=True)
class PlayerStep:
    """What a further player does in a frame."""

    name: str
    """Its name among the players: that of the cube."""

    state: CubeState
    """Where the cube is."""

    controls: CubeControls
    """What the hand does with it, on the table of the first player."""

    edge: float
    """Of the cube [m]."""

    robot: str
    """Name of the player's robot, which feels what its character does."""

    def messages(self) -> dict[str, object]:
        """Return its messages by the last part of their topics."""
        return {"state": self.state, "controls": self.controls}


@dataclass(frozen=True)
class Step:
    """The result of one frame: every message of the pipeline."""

    frame: Frame

    state: CubeState
    """Where the cube is."""

    controls: CubeControls
    """What the hand does with it."""

    outcome: Outcome
    """The scenario's decision: command, emotion, hint, paths on the table."""

    posed: PosedCharacter
    """The character as it is to be drawn."""

    picture: NDArray[np.uint8] | None
    """The camera's picture with the character on the table, (height, width, 3) BGR;
    None without a graphics context."""

    close_up: NDArray[np.uint8] | None = None
    """A look into the open cube from near by, (side, side, 3) BGR; None while it is closed."""

    subjects: tuple[Rect, ...] = ()
    """Where the cube with the hand, and the character are in the picture [px]."""

    figures: tuple[Rect | None, ...] = ()
    """Where each of the cast is in the picture [px]; None for one that is not seen."""

    scenario: str = ""
    """Name of the scenario that decided."""

    has_intensity: bool = False
    """Whether that scenario's actions have an intensity."""

    line: SpokenLine | None = None
    """What the character says, also if it has begun before; None for nothing."""

    name: str = ""
    """Name of the character in the cast."""

    stands_upright: bool = False
    """Whether the character is shown as a person where its picture is an icon."""

    others: tuple[Performance, ...] = ()
    """What the rest of the cast does."""

    players: tuple[PlayerStep, ...] = ()
    """What the further players do."""

    interior: Interior | None = None
    """What is seen in the cube; None while it is closed."""

    appearance: Appearance | None = None
    """What the picture tells beside the cube's pose; None where it was not measured."""

    tracker_error: str = ""
    """The error of the tracker that cost this frame, with its place in the code; "" for none."""

    @property
    def cast(self) -> tuple[Performance, ...]:
        """What all of the cast do, the first one too."""
        lead = Performance(self.name, self.outcome, self.posed, self.line, self.scenario)
        return lead, *self.others

    @property
    def command(self) -> CharacterCommand:
        """What the character is asked to do."""
        return self.outcome.command

    @property
    def emotion(self) -> EmotionTarget:
        """The emotion that character and robot show."""
        return self.outcome.emotion

    def messages(self) -> dict[str, object]:
        """Return the messages between camera and picture, by their topic in a recording."""
        seen = self.appearance
        measured = {} if seen is None else {"/picture/appearance": seen.news()}
        return {
            "/cube/state": self.state,
            "/cube/controls": self.controls,
            **measured,
            "/character/command": self.command,
            "/character/pose": self.posed,
            "/robot/emotion": self.emotion,
            **{
                f"/{folder}/{each.name}/{part}": message
                for folder, further in (("cast", self.others), ("cubes", self.players))
                for each in further
                for part, message in each.messages().items()
            },
            **{
                f"/robots/{player.robot}/emotion": led.emotion
                for player, led in zip(self.players, self.others, strict=False)
            },
        }


@dataclass(frozen=True)
class ReplayInputs:
    """Messages of a recording that replace computed ones, for a replay from a later stage."""

    state: CubeState | None = None
    """Where the cube is; None to track it."""

    controls: CubeControls | None = None
    """What the hand does; None to compute it from the state."""

    appearance: Appearance | None = None
    """What the picture tells beside the cube's pose; None to measure it."""

    command: CharacterCommand | None = None
    """What the character is asked to do; None for the scenario's command."""

    posed: PosedCharacter | None = None
    """The character; None to animate it."""

    emotion: EmotionTarget | None = None
    """The emotion that character and robot show; None for the scenario's."""

    further: Mapping[str, Any] = field(default_factory=dict)
    """The same of further players and characters, by their topics in a recording."""

    def command_of(self, name: str) -> CharacterCommand | None:
        """Return the recorded command of one of the cast, by its name as `Lines` have it."""
        return self.further.get(f"/cast/{name}/command") if name else self.command

    def emotion_of(self, name: str) -> EmotionTarget | None:
        """Return the recorded emotion of one of the cast."""
        return self.further.get(f"/cast/{name}/emotion") if name else self.emotion

    def pose_of(self, name: str, character: Character) -> PosedCharacter | None:
        """Return its recorded pose, for today's character, which may have got more morphs."""
        posed = self.further.get(f"/cast/{name}/pose") if name else self.posed
        count = len(character.morphs)
        morphs = None if posed is None else posed.pose.morphs
        if posed is None or morphs is None or len(morphs) >= count:
            return posed
        padded = np.concatenate([morphs, np.zeros(count - len(morphs))])
        return replace(posed, pose=replace(posed.pose, morphs=padded))


@dataclass(frozen=True)
class RobotView:
    """The state of the robot when a frame is shown."""

    link: str
    """"ready", "connecting", "lost", "none" …"""

    mood: float
    """Valence that the robot reports, −1…1; the requested one where there is no robot."""

    label: str
    """The robot's label for it: "angry", "neutral", "happy", or another of its moods."""

    real: bool = False
    """Whether it is a real robot; the virtual robot is drawn instead of any other."""

    shown: Emotion | None = None
    """The emotion that the robot reports or has acknowledged; None before the first."""

    telemetry: Telemetry | None = None
    """What is known of the robot and its link; None without a robot."""

    catalogue: Catalogue | None = None
    """What the robot has; None until it is known."""

    time: float = 0.0
    """Time of the robot's clock [s]."""

    name: str = ROBOT_NAMES[0]
    """Its name, as the player reads it."""

    second: "RobotView | None" = None
    """The robot of the second player; None without one."""
