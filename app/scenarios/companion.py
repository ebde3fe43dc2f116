"""Vleo and Pleo: the cube makes the dinosaur kiss or shout, and the robot feels it."""

import math
from typing import Literal, cast

import numpy as np
from numpy.typing import NDArray

from affect import Personality
from app.pipeline.scenario import Inputs, Outcome
from app.scenarios.affect import Temper
from app.scenarios.presence import Presence
from characters import ActionIntent, CharacterCommand, LocomotionIntent, PosedCharacter, RootDelta
from tracking import CubeControls, CubeModel

Action = Literal["idle", "kiss", "shout"]

BESIDE = np.array([-0.135, -0.01])
"""Where Vleo stands from the cube, (x, z) on the table [m]: to its left, as the player sees it."""

ALL = 0.97
"""Intensity from which there is nothing more to give: a knob is never turned exactly to its end."""

NEAREST, FARTHEST = 0.09, 0.26
"""How near the cube may come to Vleo, and how far it may be, before Vleo moves over [m]."""

FACING = np.array([0.5, 2.0])
"""Vleo looks at the player, and a little towards the cube: a point from where it stands [m]."""


class Companion:
    """The top face chooses the action, turning the cube its intensity, both the robot's mood (M11).

    Parameters
    ----------
    cube
        The cube in use; the roles of its faces name the actions.
    turns
        How many full turns lead from intensity −1 to 1.
    personality
        Who feels; without, the law of the thesis.
    """

    name = "companion"
    cube = "companion"
    character = "vleo"
    personality = "thesis"
    start = RootDelta(float(BESIDE[0]), float(BESIDE[1]), 0.2)

    def __init__(
        self, cube: CubeModel, turns: float = 2.0, personality: Personality | None = None
    ) -> None:
        self._roles = {face.name: face.role for face in cube.faces}
        self._turns = turns
        self._temper = Temper(personality or Personality.load(self.personality))
        self._presence = Presence()
        self._action: Action = "idle"
        self._face: str | None = None
        self._weight = 0.0
        self._knob = (0, 0.0)
        self._place: NDArray[np.float64] | None = None

    def update(
        self, controls: CubeControls, character: PosedCharacter | None, inputs: Inputs
    ) -> Outcome:
        """Decide on one frame; see `Scenario.update`."""
        if inputs.clear:
            self._temper.forget()
        self._choose(controls)
        visible = self._presence.update(controls)
        # Hidden, Vleo does nothing that the robot could feel: a lost cube leaves the mood (M11).
        acting = self._action if visible else "idle"
        emotion = self._temper.update(controls, acting, self._weight)
        command = CharacterCommand(
            timestamp=controls.timestamp,
            locomotion=LocomotionIntent(
                target=self._place, facing=None if self._place is None else self._place + FACING
            ),
            action=ActionIntent(self._action, self._weight),
            visible=visible,
        )
        return Outcome(command, emotion, self._hint(controls), self._action)

    def _choose(self, controls: CubeControls) -> None:
        """Take the action from the face that has come to rest, the intensity from the knob."""
        if controls.resting and controls.top_face is not None:
            self._settle(controls)
        placement, before = self._knob
        if placement == controls.placements:
            # Clamped at every step, so that turning back takes effect at once at either end.
            change = (controls.turns - before) * 2.0 / self._turns
            self._weight = float(np.clip(self._weight + change, -1.0, 1.0))
        self._knob = (controls.placements, controls.turns)

    def _settle(self, controls: CubeControls) -> None:
        if controls.top_face != self._face:
            self._face = controls.top_face
            role = self._roles.get(controls.top_face or "", "idle")
            self._action = cast(Action, role) if role in ("kiss", "shout") else "idle"
            self._weight = 0.0
            self._knob = (controls.placements, controls.turns)
        if controls.position is None:
            return
        if self._place is None:
            self._place = controls.position + BESIDE
        distance = math.dist(self._place, controls.position)
        if not NEAREST < distance < FARTHEST:
            self._place = controls.position + BESIDE

    def _hint(self, controls: CubeControls) -> str:
        if not controls.visible:
            return "Show me the cube"
        if controls.top_face is None:
            return "Put the cube on the table"
        if controls.lifted:
            return "Choose a face and put the cube down"
        if self._action == "idle":
            return "Tip the cube: heart for a kiss, burst for a shout"
        if self._weight > ALL:
            return "That is all I can give!"
        return "Turn the cube like a knob: right for more, left for less"
