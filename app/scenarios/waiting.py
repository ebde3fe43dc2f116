"""What characters of a cast do that no cube leads: they watch, feel, and are alive."""

import math

import numpy as np

from cubeling.affect import Personality
from cubeling.app.pipeline.scenario import Inputs, Outcome
from cubeling.app.pipeline.table.situation import PLAYER_POSITION, Situation
from cubeling.app.scenarios.mood import MoodController
from cubeling.app.scenarios.presence import Presence
from cubeling.app.scenarios.shake_reaction import ShakeReaction
from cubeling.characters import (
    ActionIntent,
    CharacterCommand,
    LocomotionIntent,
    PosedCharacter,
    RootDelta,
)
from cubeling.tracking import CubeControls

AWAY_M, HOME_M = 0.06, 0.03
"""Who was driven further than the first from its place goes back there, nearer than the second
[m]."""

CALM_S = 1.5
"""It goes back when the cube has rested for so long [s]: the hand is away then."""

WALK_SPEED = 1.5
"""AvatAR's Speed with which it goes back."""


class Waiting:
    """Stands at a place, turned to the player, and answers a shake of the cube as `Follow` does.

    When hand and cube have driven it away, it comes back as soon as they are gone. It feels what
    the hand does with the cube, with a mood of its own. It is a `Scenario` for one character beside
    the one that the cube leads, and not one to play.

    Parameters
    ----------
    start
        Where it stands [m, rad].
    number
        Its number in the cast: at a shake, those beside each other do different things.
    """

    name = "waiting"
    summary = "a character of the cast that no cube leads"
    cube = "locomotion"
    roles: tuple[str, ...] = ()
    character = "human"
    personality = "lively"
    has_intensity = False

    def __init__(self, start: RootDelta, number: int) -> None:
        self.start = start
        self._mood = MoodController(Personality.load(self.personality))
        self._presence = Presence()
        self._shaken = ShakeReaction(number)
        self._moved_at = -math.inf
        self._returns = False

    def update(self, controls: CubeControls, situation: Situation, inputs: Inputs) -> Outcome:
        """Decide on one frame; see `Scenario.update`."""
        if inputs.clear:
            self._mood.reset()
        visible = self._presence.update(controls)
        action = self._shaken.update(controls, situation) or "idle"
        emotion = self._mood.update(controls, action if visible else "idle", events=inputs.events)
        returns = self._is_on_its_way(controls, situation.character) and action == "idle"
        command = CharacterCommand(
            timestamp=controls.timestamp,
            locomotion=LocomotionIntent(
                WALK_SPEED if returns else 0.0,
                np.array([self.start.x, self.start.z]) if returns else None,
                facing=PLAYER_POSITION,
            ),
            action=None if returns else ActionIntent(action),
            visible=visible,
        )
        return Outcome(command, emotion, hint="", icon=action)

    def _is_on_its_way(self, controls: CubeControls, character: PosedCharacter | None) -> bool:
        """Return whether it goes back to its place now."""
        if not controls.resting:
            self._moved_at = controls.timestamp
        if character is None or controls.timestamp - self._moved_at < CALM_S:
            self._returns = False
            return False
        x, z = character.table_from_character[[0, 2], 3].tolist()
        away = math.hypot(x - self.start.x, z - self.start.z)
        self._returns = away > (HOME_M if self._returns else AWAY_M)
        return self._returns
