"""Vleo and Pleo: the cube makes the dinosaur kiss or shout, which changes the robot's mood."""

import math
from typing import Literal, cast

import numpy as np
from numpy.typing import NDArray

from cubeling.affect import Personality
from cubeling.app.pipeline.registry import SUMMARIES
from cubeling.app.pipeline.scenario import Inputs, Outcome, ScenarioSettings
from cubeling.app.pipeline.table.situation import Situation
from cubeling.app.scenarios.mood import MoodController
from cubeling.app.scenarios.presence import Presence
from cubeling.characters import (
    ActionIntent,
    CharacterCommand,
    LocomotionIntent,
    RootDelta,
)
from cubeling.tracking import CubeControls, CubeModel

Action = Literal["idle", "kiss", "shout"]

OFFSET_FROM_CUBE = np.array([-0.135, -0.01])
"""Where Vleo stands from the cube, (x, z) on the table [m]: to its left, as the player sees it."""

MIN_CUBE_DISTANCE_M, MAX_CUBE_DISTANCE_M = 0.09, 0.26
"""Vleo moves to a new place when the cube is nearer or farther than this."""

FACING_OFFSET = np.array([0.5, 2.0])
"""The point that Vleo faces, from its place [m]: the player, and a little towards the cube."""

INSTEAD: dict[Action, tuple[str, ...]] = {
    "idle": (),
    "kiss": ("cheer", "wave", "nod"),
    "shout": ("shake", "jump"),
}
"""What characters do who can neither kiss nor shout, such as persons; the first that they can."""

FULL_WEIGHT = 0.97
"""Intensity that counts as the maximum for the hint: nobody turns a knob exactly to its end."""


class Companion:
    """The top face sets the action and the cube's turn its intensity; both change the mood (M11).

    The roles of the cube's faces name the actions.
    """

    name = "companion"
    summary = SUMMARIES["companion"]
    cube = "companion"
    roles: tuple[str, ...] = ("idle", "kiss", "shout")
    character = "vleo"
    personality = "thesis"
    start = RootDelta(float(OFFSET_FROM_CUBE[0]), float(OFFSET_FROM_CUBE[1]), 0.2)
    has_intensity = True
    adjustable = ("turns", "personality")

    def __init__(self, cube: CubeModel, settings: ScenarioSettings) -> None:
        self._roles = {face.side: face.role for face in cube.faces}
        self._turns = settings.turns
        self._mood = MoodController(settings.personality or Personality.load(self.personality))
        self._presence = Presence()
        self._action: Action = "idle"
        self._face: str | None = None
        self._weight = 0.0
        self._knob = (0, 0.0)  # placements and turns of the previous frame
        self._place: NDArray[np.float64] | None = None

    def adjust(self, settings: ScenarioSettings) -> None:
        """Play on with other settings; the intensity stays."""
        self._turns = settings.turns
        self._mood.adjust(settings.personality or Personality.load(self.personality))

    def update(self, controls: CubeControls, situation: Situation, inputs: Inputs) -> Outcome:
        """Decide on one frame; see `Scenario.update`."""
        if inputs.clear:
            self._mood.reset()
        self._read_action(controls)
        visible = self._presence.update(controls)
        # A hidden Vleo does not change the mood: a lost cube leaves it as it is (M11).
        action = self._action if visible else "idle"
        emotion = self._mood.update(controls, action, self._weight, events=inputs.events)
        command = CharacterCommand(
            timestamp=controls.timestamp,
            locomotion=LocomotionIntent(
                target=self._place,
                facing=None if self._place is None else self._place + FACING_OFFSET,
            ),
            action=ActionIntent(_nearest(self._action, situation), self._weight),
            visible=visible,
        )
        return Outcome(command, emotion, self._hint(controls), self._action)

    def _read_action(self, controls: CubeControls) -> None:
        """Take the action from the top face of a resting cube, and the intensity from its turn."""
        if controls.resting and controls.top_face is not None:
            self._place_cube(controls)
        placement, before = self._knob
        if placement == controls.placements:
            # Clamping in every frame makes turning back take effect at once at either end.
            change = (controls.turns - before) * 2.0 / self._turns
            self._weight = float(np.clip(self._weight + change, -1.0, 1.0))
        self._knob = (controls.placements, controls.turns)

    def _place_cube(self, controls: CubeControls) -> None:
        if controls.top_face != self._face:
            self._face = controls.top_face
            role = self._roles.get(controls.top_face or "", "idle")
            self._action = cast(Action, role) if role in ("kiss", "shout") else "idle"
            self._weight = 0.0
            self._knob = (controls.placements, controls.turns)
        if controls.position is None:
            return
        if self._place is None:
            self._place = controls.position + OFFSET_FROM_CUBE
        distance = math.dist(self._place, controls.position)
        if not MIN_CUBE_DISTANCE_M < distance < MAX_CUBE_DISTANCE_M:
            self._place = controls.position + OFFSET_FROM_CUBE

    def _hint(self, controls: CubeControls) -> str:
        if not controls.visible:
            return "Show me the cube"
        if controls.top_face is None:
            return "Put the cube on the table"
        if controls.lifted:
            return "Choose a face and put the cube down"
        if self._action == "idle":
            return "Tip the cube: heart for a kiss, burst for a shout"
        if self._weight > FULL_WEIGHT:
            return "That is all I can give!"
        return "Turn the cube like a knob: right for more, left for less"


def _nearest(action: Action, situation: Situation) -> str:
    """Return what a character does instead of an action that it cannot do, "idle" for nothing."""
    if situation.character is None or action in situation.actions:
        return action
    return next((each for each in INSTEAD[action] if each in situation.actions), "idle")
