"""A character in play: its scenario, its body, where it looks, and what it says."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from cubeling.app.pipeline.cast.directing import Directing
from cubeling.app.pipeline.scenario import (
    Inputs,
    Outcome,
    Scenario,
    check_actions,
    check_gestures,
)
from cubeling.app.pipeline.scenario_errors import check_outcome, scenario_errors
from cubeling.app.pipeline.step import Performance
from cubeling.app.pipeline.table.attention import ALONE, Attention, Company
from cubeling.app.pipeline.table.props import BodyParts, PosedBody
from cubeling.app.pipeline.table.situation import SeenCube, Situation, table_from_cube
from cubeling.app.pipeline.table.spoken_line import Speaking
from cubeling.characters import (
    Animator,
    Character,
    CharacterCommand,
    ControllerFactory,
    Obstacle,
    PosedCharacter,
    RootDelta,
    TableView,
    first_suitable,
)
from cubeling.characters.speech import Complexion

MAX_SPEED_M_S = 2.0
"""A body that is somewhere else at a greater speed was put there [m/s]: it does not come nearer."""


class CastMember:
    """A character in play. It changes from frame to frame, and a checkpoint copies it.

    Parameters
    ----------
    name
        Its name in the cast; see `cast_names`.
    character
        Its body.
    scenario
        Decides what it does, and where it stands at first.
    attention
        Chooses what it looks at.
    player
        The number of the player whose cube leads it, or whom it watches.
    led
        Whether that cube leads it.
    place
        Where it stands at first; None for the scenario's own place.
    seed
        Of its blinks, sway and idle motion.
    controller
        Makes its controller; see `choose_controller`.

    Raises
    ------
    AppError
        The character lacks an action that the scenario asks for.
    CharacterError
        The character cannot be animated.
    """

    def __init__(
        self,
        name: str,
        character: Character,
        scenario: Scenario,
        attention: Attention,
        *,
        player: int = 0,
        led: bool = True,
        place: RootDelta | None = None,
        seed: int = 0,
        controller: ControllerFactory = first_suitable,
    ) -> None:
        self.name, self.scenario, self.attention = name, scenario, attention
        self._directing = Directing(character)
        self.led = led
        """Whether a cube leads it."""
        self.player = player
        """The number of the player whose cube leads it, or whom it watches."""
        place = place or scenario.start
        self._take(character, Animator(character, None, place, seed, None, controller))
        self.posed: PosedCharacter | None = None
        """The character as after the previous frame; None before the first."""
        self.body: PosedBody | None = None
        """Its body then."""
        self.speaking = Speaking()
        self.complexion = Complexion()
        self._before: PosedCharacter | None = None

    def _take(self, character: Character, animator: Animator) -> None:
        check_actions(self.scenario, character.name, animator.actions)
        check_gestures(self.scenario, character)
        self.character, self._animator = character, animator
        self._parts = BodyParts.of(character, animator.scale)

    @property
    def actions(self) -> tuple[str, ...]:
        """Names of the actions that it can perform."""
        return self._animator.actions

    def exchange(self, character: Character, animator: Animator) -> None:
        """Go on with another body; see the errors of the class."""
        self._take(character, animator)
        self._directing.take(character)
        self.body = None

    def decide(
        self,
        seen: SeenCube,
        inputs: Inputs,
        heard: int | None = None,
        view: TableView | None = None,
    ) -> Outcome:
        """Let its scenario decide, and do what it is told; `heard`, `view` are of `Situation`."""
        animator, controls = self._animator, seen.controls
        cube = table_from_cube(seen.state, controls)
        situation = Situation(
            self.posed,
            self.body,
            animator.actions,
            animator.walks,
            animator.length,
            cube,
            heard,
            view,
        )
        scenario = type(self.scenario)
        with scenario_errors(scenario):
            decision = self.scenario.update(controls, situation, replace(inputs, acts=()))
        return self._directing.update(check_outcome(decision, scenario), inputs)

    def command(
        self,
        seen: SeenCube,
        decision: Outcome,
        inputs: Inputs,
        obstacles: tuple[Obstacle, ...],
        view: TableView | None,
        company: Company = ALONE,
    ) -> CharacterCommand:
        """Return the command of a decision with gaze, emotion, speech, and what is in the way.

        Only this method adds the emotion: character, virtual robot and robot show one.
        """
        command = decision.command
        return replace(
            command,
            obstacles=obstacles,
            view=view,
            gaze=self.attention.update(
                seen.state, seen.controls, command, company, thinks=decision.thinks
            ),
            emotion=decision.emotion.emotion,
            speech=self.speaking.update(
                decision.line if decision.keeps_line else decision.line or inputs.line,
                command,
                silence=inputs.clear or decision.hush,
            ),
        )

    def perform(self, command: CharacterCommand, posed: PosedCharacter | None = None) -> PosedBody:
        """Advance to the time of a command, or take a recorded pose, and return the body."""
        posed = posed or self._animator.update(command)
        self._before, self.posed, self.body = self.posed, posed, self.body_of(posed)
        self.complexion.update(command.timestamp, command.emotion)
        return self.body

    def performance(self, outcome: Outcome) -> Performance:
        """Return what it does in a frame, after `perform`."""
        assert self.posed is not None, "it has just performed"
        line = self.speaking.line if outcome.command.speech is not None else None
        return Performance(self.name, outcome, self.posed, line, self.scenario.name)

    def body_of(self, posed: PosedCharacter) -> PosedBody:
        """Return its body in a pose."""
        return PosedBody(self.character, self._parts, posed)

    @property
    def face(self) -> NDArray[np.float64]:
        """Where the others look that look at it, (3,) in the table frame [m]."""
        assert self.body is not None
        return self.body.face

    @property
    def obstacle(self) -> Obstacle | None:
        """Its body as it is in the way of others; None where it is not seen on the table."""
        if self.posed is None or not self.posed.visible:
            return None
        return self._animator.obstacle(_velocity(self._before, self.posed))


def _velocity(before: PosedCharacter | None, now: PosedCharacter) -> NDArray[np.float64]:
    """Return how a character moves over the table, (3,) [m/s]."""
    elapsed = 0.0 if before is None else now.timestamp - before.timestamp
    if before is None or elapsed <= 0.0:
        return np.zeros(3)
    moved = now.table_from_character[:3, 3] - before.table_from_character[:3, 3]
    velocity = np.array([moved[0], 0.0, moved[2]]) / elapsed
    return velocity if float(np.linalg.norm(velocity)) < MAX_SPEED_M_S else np.zeros(3)
