"""AvatAR's interactive control: the character goes where the cube is."""

import numpy as np
from numpy.typing import NDArray

from cubeling.affect import Personality
from cubeling.app.pipeline.registry import SUMMARIES
from cubeling.app.pipeline.scenario import Inputs, Outcome, ScenarioSettings
from cubeling.app.pipeline.table.situation import PLAYER_POSITION, Situation
from cubeling.app.scenarios.mood import MoodController
from cubeling.app.scenarios.presence import Presence
from cubeling.app.scenarios.pursuit import Pursuit
from cubeling.app.scenarios.shake_reaction import ShakeReaction
from cubeling.app.scenarios.speed import SpeedDial
from cubeling.characters import (
    IDLE_SPEED,
    RUN_SPEED,
    ActionIntent,
    CharacterCommand,
    LocomotionIntent,
    PosedCharacter,
    RootDelta,
)
from cubeling.tracking import CubeControls, CubeModel

Point = NDArray[np.float64]


class Follow:
    """The character goes to the cube; the cube's turn sets how fast (M10).

    Beyond the thesis: shaken, the cube makes the character jump, wave or cheer, if it can; and it
    feels something about a cube that is reached, that runs away, or that nobody moves (`Pursuit`).
    """

    name = "follow"
    summary = SUMMARIES["follow"]
    cube = "locomotion"
    roles: tuple[str, ...] = ()
    character = "human"
    personality = "lively"
    start = RootDelta(-0.15, 0.03, 0.0)
    has_intensity = False
    adjustable = ("speed_map", "personality")

    def __init__(self, cube: CubeModel, settings: ScenarioSettings) -> None:
        self._dial = SpeedDial(settings.speed_map)
        self._mood = MoodController(settings.personality or Personality.load(self.personality))
        self._presence = Presence()
        self._pursuit = Pursuit()
        self._half_edge = cube.edge / 2
        self._shaken = ShakeReaction()

    def adjust(self, settings: ScenarioSettings) -> None:
        """Play on with other settings."""
        self._dial.use(settings.speed_map)
        self._mood.adjust(settings.personality or Personality.load(self.personality))

    def update(self, controls: CubeControls, situation: Situation, inputs: Inputs) -> Outcome:
        """Decide on one frame; see `Scenario.update`."""
        if inputs.clear:
            self._mood.reset()
        speed = self._dial.update(controls.camera_angle, controls.timestamp)
        visible = self._presence.update(controls)
        shake_action = self._shaken.update(controls, situation)
        # As if cube and character were discs, so that the character does not enter the cube.
        clearance = self._half_edge + situation.body_length / 2
        target = _near_side(controls.position, situation.character, clearance)
        if not situation.walks and speed <= IDLE_SPEED:
            target = None  # a character that hops does so at any speed
        command = CharacterCommand(
            timestamp=controls.timestamp,
            locomotion=LocomotionIntent(speed, target, facing=PLAYER_POSITION),
            action=_action(shake_action, speed),
            visible=visible,
        )
        # A hidden character does nothing that changes the mood.
        action, mood_speed = (shake_action or "idle", speed) if visible else ("idle", 0.0)
        events = self._pursuit.update(
            controls, situation.character, clearance, mood_speed > IDLE_SPEED
        )
        emotion = self._mood.update(
            controls, action, speed=mood_speed, events=(*events, *inputs.events)
        )
        icon = gait(speed, situation.walks)
        return Outcome(command, emotion, _hint(controls, icon), icon, events=events)


def _near_side(
    cube: Point | None, character: PosedCharacter | None, clearance: float
) -> Point | None:
    """Return the point on the way to the cube that is `clearance` [m] away from it."""
    if cube is None or character is None:
        return cube
    offset = character.table_from_character[[0, 2], 3] - cube
    distance = float(np.linalg.norm(offset))
    return cube + offset * (min(clearance, distance) / max(distance, 1e-9))


def _action(shake_action: str, speed: float) -> ActionIntent | None:
    """Return the action that answers a shake, or "idle" to stand; None to move."""
    if shake_action:
        return ActionIntent(shake_action)
    return None if speed > IDLE_SPEED else ActionIntent("idle")


def gait(speed: float, walks: bool = True) -> str:
    """Return the gait at a Speed, which is also its icon: "stand", "walk", "run" or "hop"."""
    if speed <= IDLE_SPEED:
        return "stand"
    if not walks:
        return "hop"
    return "walk" if speed <= RUN_SPEED else "run"


def _hint(controls: CubeControls, gait: str) -> str:
    if not controls.visible:
        return "Show me the cube"
    if controls.position is None:
        return "Put the cube on the table"
    return {
        "stand": "Turn the cube, and I come",
        "walk": "Move the cube: I follow you",
        "run": "I run after you!",
        "hop": "I cannot walk, so I hop after you",
    }[gait]
