"""AvatAR's interactive control: the character goes where the cube is."""

import numpy as np
from numpy.typing import NDArray

from affect import Personality
from app.pipeline.scenario import Inputs, Outcome
from app.scenarios.affect import Temper
from app.scenarios.presence import Presence
from app.scenarios.speed import SpeedDial
from characters import ActionIntent, CharacterCommand, LocomotionIntent, PosedCharacter, RootDelta
from characters.control.command import IDLE_SPEED
from tracking import CubeControls

Point = NDArray[np.float64]

RUN_ABOVE = 3.0
"""Speed above which it runs (AvatAR)."""

ELBOW_ROOM = 0.04
"""How far from the cube's centre the character aims, so that both have room [m]."""

TREATS = ("jump", "wave", "cheer")
"""What a character that knows it does when the cube is shaken, in turn."""

CAMERA = np.array([0.0, 2.0])
"""A point on the table far towards the camera, (x, z) [m]: where the player sits."""


class Follow:
    """The character chases the cube; the turn of the cube sets how fast (M10).

    Shaking the cube is not in the thesis: the character then jumps, waves or cheers, if it can, and
    that pleases it. The faster it goes the more awake it is.
    """

    name = "follow"
    cube = "locomotion"
    character = "human"
    personality = "lively"
    start = RootDelta(-0.15, 0.03, 0.0)

    def __init__(
        self, speed_map: str = "corrected", personality: Personality | None = None
    ) -> None:
        self._dial = SpeedDial(speed_map)
        self._temper = Temper(personality or Personality.load(self.personality))
        self._presence = Presence()
        self._treats = 0
        self._treat: tuple[str, bool] | None = None  # what it does, and whether it has begun

    def update(
        self, controls: CubeControls, character: PosedCharacter | None, inputs: Inputs
    ) -> Outcome:
        """Decide on one frame; see `Scenario.update`."""
        if inputs.clear:
            self._temper.forget()
        speed = self._dial.update(controls.camera_angle, controls.timestamp)
        visible = self._presence.update(controls)
        treat = self._shaken(controls, character, inputs)
        command = CharacterCommand(
            timestamp=controls.timestamp,
            locomotion=LocomotionIntent(
                speed, _beside(controls.position, character), facing=CAMERA
            ),
            action=_action(treat, speed),
            visible=visible,
        )
        # Out of sight it goes nowhere, and does nothing that it could feel.
        emotion = self._temper.update(
            controls, (treat or "idle") if visible else "idle", speed=speed if visible else 0.0
        )
        return Outcome(command, emotion, _hint(controls, speed), gait(speed))

    def _shaken(
        self, controls: CubeControls, character: PosedCharacter | None, inputs: Inputs
    ) -> str:
        """Return what it does because the cube was shaken, one thing after the other, or ""."""
        known = [treat for treat in TREATS if treat in inputs.actions]
        if controls.shaken and known and self._treat is None:
            self._treat = known[self._treats % len(known)], False
            self._treats += 1
        if self._treat is None:
            return ""
        name, begun = self._treat
        doing = character is not None and character.state == name
        self._treat = None if begun and not doing else (name, begun or doing)
        return name if self._treat else ""


def _beside(cube: Point | None, character: PosedCharacter | None) -> Point | None:
    """Return the point at the cube's near side: the character comes to it, not into it."""
    if cube is None or character is None:
        return cube
    way = character.table_from_character[[0, 2], 3] - cube
    distance = float(np.linalg.norm(way))
    return cube + way * (min(ELBOW_ROOM, distance) / max(distance, 1e-9))


def _action(treat: str, speed: float) -> ActionIntent | None:
    """Return the action for a treat, or for standing; None to move."""
    if treat:
        return ActionIntent(treat)
    return None if speed > IDLE_SPEED else ActionIntent("idle")


def gait(speed: float) -> str:
    """Name of the icon for a Speed: "stand", "walk" or "run"."""
    if speed <= IDLE_SPEED:
        return "stand"
    return "walk" if speed <= RUN_ABOVE else "run"


def _hint(controls: CubeControls, speed: float) -> str:
    if not controls.visible:
        return "Show me the cube"
    if controls.position is None:
        return "Put the cube on the table"
    if speed <= IDLE_SPEED:
        return "Turn the cube to walk"
    return "Move the cube: I follow you" if speed <= RUN_ABOVE else "I run after you!"
