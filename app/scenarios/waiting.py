"""What characters of a cast do that no cube leads: they watch, feel, and are alive."""

import numpy as np

from cubeling.affect import Personality
from cubeling.app.pipeline.scenario import Inputs, Outcome
from cubeling.app.pipeline.table.situation import Situation
from cubeling.app.scenarios.mood import MoodController
from cubeling.app.scenarios.presence import Presence
from cubeling.app.scenarios.shake_reaction import ShakeReaction
from cubeling.characters import ActionIntent, CharacterCommand, LocomotionIntent, RootDelta
from cubeling.tracking import CubeControls

PLAYER_POSITION = np.array([0.0, 2.0])
"""A point far towards the camera, (x, z) on the table [m]: where the player sits."""


class Waiting:
    """Stands at a place, turned to the player, and answers a shake of the cube as `Follow` does.

    It feels what the hand does with the cube, with a mood of its own. It is a `Scenario` for one
    character beside the one that the cube leads, and not one to play.

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

    def update(self, controls: CubeControls, situation: Situation, inputs: Inputs) -> Outcome:
        """Decide on one frame; see `Scenario.update`."""
        if inputs.clear:
            self._mood.reset()
        visible = self._presence.update(controls)
        action = self._shaken.update(controls, situation) or "idle"
        emotion = self._mood.update(controls, action if visible else "idle", events=inputs.events)
        place = np.array([self.start.x, self.start.z])
        command = CharacterCommand(
            timestamp=controls.timestamp,
            locomotion=LocomotionIntent(target=place, facing=PLAYER_POSITION),
            action=ActionIntent(action),
            visible=visible,
        )
        return Outcome(command, emotion, hint="", icon=action)
