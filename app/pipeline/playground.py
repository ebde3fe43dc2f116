"""The whole line for one frame: from a picture of the cube to a picture of the character."""

from dataclasses import replace

import moderngl
import numpy as np
from numpy.typing import NDArray

from app.pipeline.attention import Attention
from app.pipeline.scenario import Inputs, Outcome, Scenario, make_scenario
from app.pipeline.step import Given, Step
from characters import Animator, Character, CharacterCommand, PosedCharacter
from characters.rendering import Box, FloorPath, SceneCharacter, Stage, View
from tracking import (
    CubeControls,
    CubeGestures,
    CubeModel,
    CubeState,
    CubeTracker,
    Frame,
    Intrinsics,
)


class Playground:
    """The line of the design from the camera to the picture, without clock, window or threads.

    The same frames and inputs give the same steps, bit for bit but for the picture, which is
    equal on one graphics driver.

    Parameters
    ----------
    scenario
        A scenario, or the name of one.
    intrinsics
        The camera.
    cube
        The cube in the player's hand; the scenario's own where it is None.
    character
        Who plays; the scenario's own where it is None.
    context
        Where to draw; None to leave the pictures out.
    look
        What the character's eyes follow: one of `LOOKS`.
    """

    def __init__(
        self,
        scenario: Scenario | str,
        intrinsics: Intrinsics,
        *,
        cube: CubeModel | None = None,
        character: Character | None = None,
        context: moderngl.Context | None = None,
        look: str = "auto",
    ) -> None:
        if isinstance(scenario, str):
            scenario = make_scenario(scenario, cube)
        self.scenario = scenario
        self.intrinsics = intrinsics
        self.cube = cube or CubeModel.load(scenario.cube)
        self.character = character or Character.load(scenario.character)
        self._tracker = CubeTracker(self.cube, intrinsics)
        self._gestures = CubeGestures(self.cube)
        self._animator = Animator(self.character, place=scenario.start)
        self._stage = None if context is None else Stage(context, intrinsics.size)
        self._posed: PosedCharacter | None = None
        self._attention = Attention(look, self.cube.edge)

    def step(self, frame: Frame, inputs: Inputs | None = None, given: Given | None = None) -> Step:
        """Walk one frame down the line.

        Parameters
        ----------
        frame
            The camera's picture.
        inputs
            What else the player asked for.
        given
            Arrows to take as they are instead of working them out.
        """
        given = given or Given()
        state = given.state or self.track(frame)
        controls = given.controls or self.gesture(state)
        outcome = self.attend(state, controls, self.decide(controls, inputs or Inputs()))
        if given.command is not None:
            outcome = replace(outcome, command=given.command)
        posed = given.posed or self.animate(outcome.command)
        self._posed = posed
        picture = self.draw(frame, state, controls, outcome, posed)
        return Step(frame, state, controls, outcome, posed, picture)

    def track(self, frame: Frame) -> CubeState:
        """First arrow: find the cube."""
        return self._tracker.update(frame)

    def gesture(self, state: CubeState) -> CubeControls:
        """Second arrow: read the hand."""
        return self._gestures.update(state)

    def decide(self, controls: CubeControls, inputs: Inputs) -> Outcome:
        """Third arrow: ask the scenario."""
        known = replace(inputs, actions=self._animator.actions)
        return self.scenario.update(controls, self._posed, known)

    def attend(self, state: CubeState, controls: CubeControls, outcome: Outcome) -> Outcome:
        """Add to what a scenario wants where the character looks, and that it shows its mood.

        Nothing else says so: character, virtual robot and robot show one emotion.
        """
        gaze = self._attention.update(state, controls, outcome.command)
        command = replace(outcome.command, gaze=gaze, emotion=outcome.emotion.emotion)
        return replace(outcome, command=command)

    def animate(self, command: CharacterCommand) -> PosedCharacter:
        """Fourth arrow: move the character."""
        return self._animator.update(command)

    def draw(
        self,
        frame: Frame,
        state: CubeState,
        controls: CubeControls,
        outcome: Outcome,
        posed: PosedCharacter,
    ) -> NDArray[np.uint8] | None:
        """Fifth arrow: draw the picture, or None without a stage."""
        if self._stage is None:
            return None
        return self._stage.draw(*self.shot(frame, state, controls, outcome, posed))

    def shot(
        self,
        frame: Frame,
        state: CubeState,
        controls: CubeControls,
        outcome: Outcome,
        posed: PosedCharacter,
    ) -> tuple[View, tuple[SceneCharacter, ...], tuple[FloorPath, ...]]:
        """Return what a stage needs: the view, who is in it, and what is on the floor."""
        boxes: tuple[Box, ...] = ()
        if state.camera_from_cube is not None:
            boxes = (Box(state.camera_from_cube, self.cube.edge),)
        view = View(
            frame.image,
            self.intrinsics.matrix,
            self.intrinsics.distortion,
            controls.camera_from_table,
            boxes,
        )
        seen = posed.visible and controls.camera_from_table is not None
        actors = (SceneCharacter(self.character, posed),) if seen else ()
        return view, actors, outcome.floor if seen else ()

    def close(self) -> None:
        """Release what the stage holds; a second call does nothing."""
        if self._stage is not None:
            self._stage.release()
            self._stage = None
