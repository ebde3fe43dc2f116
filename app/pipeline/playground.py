"""The pipeline for one frame: from a picture of the cube to a picture of the character."""

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cubeling.app.errors import AppError
from cubeling.app.pipeline.cast.cast import Cast
from cubeling.app.pipeline.cast.further_members import further_members
from cubeling.app.pipeline.cast.member import CastMember
from cubeling.app.pipeline.checkpoint import Checkpoint
from cubeling.app.pipeline.choices import REALISM_CHOICES, ROBOT_NAMES, distinct_names
from cubeling.app.pipeline.cube_window import CubeWindow
from cubeling.app.pipeline.cubes.tracked_cube import TrackedCube
from cubeling.app.pipeline.frame_times import Lap
from cubeling.app.pipeline.picture_regions import picture_regions
from cubeling.app.pipeline.player import check_players, make_players
from cubeling.app.pipeline.registry import make_scenario
from cubeling.app.pipeline.scenario import (
    AdjustableScenario,
    Inputs,
    Outcome,
    Scenario,
    ScenarioSettings,
)
from cubeling.app.pipeline.scenario_errors import scenario_errors
from cubeling.app.pipeline.sight import Sight
from cubeling.app.pipeline.step import ReplayInputs, Step
from cubeling.app.pipeline.step_renderer import DrawnBody, StepRenderer
from cubeling.app.pipeline.table.attention import Attention
from cubeling.app.pipeline.table.obstacles import is_leftmost, view_of
from cubeling.app.pipeline.table.situation import SeenCube
from cubeling.characters import (
    Animator,
    Character,
    ControllerFactory,
    RootDelta,
    first_suitable,
)
from cubeling.characters.rendering import Quality
from cubeling.tracking import CubeModel, Frame, FrameMarkers, Intrinsics, MarkerDetector
from cubeling.tracking.appearance import APPEARANCE_PARTS

if TYPE_CHECKING:
    import moderngl

LOOK_INSIDE = "Look into the cube: turn it, or tip it"
"""What the player is told when the cube has opened."""

STATE_NAMES = ("cast", "players", "_window")
"""The attributes of a playground that change from frame to frame."""


class Playground:
    """The pipeline from the camera to the picture, without clock, window or threads.

    The same frames and inputs give the same steps, bit for bit. The pictures are equal on the same
    graphics driver.

    Parameters
    ----------
    scenario
        A scenario, or the name of one: bundled, or added by an installed package.
    intrinsics
        Of the camera; the pictures have their size.
    cube
        The cube in the player's hand; None for the scenario's own.
    character
        The character that the cube leads; None for the scenario's own.
    others
        The rest of the cast, at most four characters.
    further_cubes
        Those of further players, each of whom leads one of `others` in the same scenario.
    robots
        Names of the players' robots.
    settings
        Those of the further players; None for the usual ones. The first one's are in `scenario`.
    context
        Where to draw, from `create_context`; the caller releases it. None for no pictures.
    look
        What the character's eyes follow: one of `LOOK_CHOICES`.
    fixed
        Whether the scenario cannot be changed, so that the player is not told how.
    known_cubes
        The player's cubes; they are recognised as the bundled ones are.
    lap
        Called at the end of each part of `step` with its name, to measure its time.
    controller
        Makes the controller of the characters; see `choose_controller`.
    realism
        What makes the characters look real, of `REALISM_CHOICES`.
    inside
        When the character is in the cube, one of `INSIDE_CHOICES`.
    measured
        Whether the appearance of the pictures is measured although none is drawn.
    plain
        Whether the frames hold no pictures: a plain room is drawn in their place.

    Raises
    ------
    AppError
        No scenario has that name, the character lacks an action that it asks for, or `look` is
        not one of `LOOK_CHOICES`.
    CharacterError
        The character cannot be animated, or pictures of this size cannot be drawn.
    """

    def __init__(
        self,
        scenario: Scenario | str,
        intrinsics: Intrinsics,
        *,
        cube: CubeModel | None = None,
        character: Character | None = None,
        others: Sequence[Character] = (),
        further_cubes: Sequence[CubeModel] = (),
        robots: Sequence[str] = ROBOT_NAMES,
        settings: ScenarioSettings | None = None,
        context: "moderngl.Context | None" = None,
        look: str = "auto",
        fixed: bool = False,
        known_cubes: Sequence[CubeModel] = (),
        lap: Lap = lambda part: None,
        controller: ControllerFactory = first_suitable,
        realism: Sequence[str] = tuple(REALISM_CHOICES),
        inside: str = "auto",
        measured: bool = False,
        plain: bool = False,
    ) -> None:
        if isinstance(scenario, str):
            scenario = make_scenario(scenario, cube)
        self.known_cubes, self._robots = tuple(known_cubes), tuple(robots)
        self._look, self._lap = look, lap
        self._controller, self._inside, self._others = controller, inside, tuple(others)
        self._further_cubes, self._settings = tuple(further_cubes), settings or ScenarioSettings()
        self.fixed = fixed
        """Whether the scenario cannot be changed now, so that the player is not told how."""
        parts = tuple(each for each in APPEARANCE_PARTS if each in realism)
        self._renderer = StepRenderer(context, intrinsics, realism, plain=plain)
        seen = parts if measured or (context is not None and not plain) else ()
        self.sight = Sight(self._renderer, intrinsics, seen)
        """The lens, and what is measured of the pictures."""
        self.play(scenario, cube, character)

    def play(
        self,
        scenario: Scenario,
        cube: CubeModel | None = None,
        character: Character | None = None,
    ) -> None:
        """Start a scenario from its beginning; the parameters are those of the class.

        If it raises an error, the present one goes on.
        """
        cube = cube or CubeModel.load(scenario.cube)
        character = character or Character.load(scenario.character)
        cubes, look = [cube, *self._further_cubes], self._look
        check_players(cubes)
        with scenario_errors(type(scenario)):
            led = [type(scenario)(each, self._settings) for each in self._further_cubes]
        name, *names = distinct_names(each.name for each in (character, *self._others))
        attention, edges = Attention(look, cube.edge), [each.edge for each in cubes]
        lead = CastMember(name, character, scenario, attention, controller=self._controller)
        self.cast = Cast([lead, *further_members(names, self._others, scenario, led, look, edges)])
        """Who is on the table: first the character that the first cube leads."""
        self.players = make_players(cubes, self._robots, self.intrinsics, self.known_cubes)
        """Who plays, each with a cube."""
        self._detectors = {each.dictionary: MarkerDetector(each.dictionary) for each in cubes}
        self.sight.begin(cubes)
        self._window = CubeWindow(cube, character, scenario.roles, self._inside)

    @property
    def cube(self) -> CubeModel:
        """The cube of the first player."""
        return self.players[0].cube

    @property
    def tracked(self) -> TrackedCube:
        """The first player's cube in view, and what it has told of the camera."""
        return self.players[0].tracked

    @property
    def scenario(self) -> Scenario:
        """What the cube plays."""
        return self.cast.lead.scenario

    @property
    def character(self) -> Character:
        """The character that the cube leads."""
        return self.cast.lead.character

    def exchange_character(self, character: Character) -> None:
        """Let another character go on where the present one stands.

        Raises
        ------
        AppError
            It lacks an action that the scenario asks for.
        CharacterError
            It cannot be animated.
        """
        lead, place = self.cast.lead, self.scenario.start
        if lead.posed is not None:
            table = lead.posed.table_from_character
            yaw = math.atan2(float(table[0, 2]), float(table[2, 2]))
            place = RootDelta(float(table[0, 3]), float(table[2, 3]), yaw)
        animator = Animator(character, place=place)
        asked = [role for role in self.scenario.roles if role in lead.actions]
        missing = [role for role in asked if role not in animator.actions]
        if missing:
            raise AppError(f"{character.name} cannot {' or '.join(missing)}")
        lead.exchange(character, animator)
        self._window.cast(character)

    def look_through(self, intrinsics: Intrinsics) -> None:
        """Take another camera; `play` must follow, as the table is another one in its picture."""
        self.sight.take(intrinsics)

    def keep_lens(self) -> None:
        """Begin with the lens as play has measured it; `play` must follow."""
        self.look_through(self.tracked.measured_intrinsics)

    @property
    def intrinsics(self) -> Intrinsics:
        """Of the camera, as they are at the beginning of the scenario."""
        return self.sight.intrinsics

    @property
    def draws_in_software(self) -> bool:
        """Whether pictures are drawn on the processor, not on a graphics card."""
        return self._renderer.in_software

    @property
    def quality(self) -> Quality:
        """How finely characters are drawn."""
        return self._renderer.quality

    @quality.setter
    def quality(self, quality: Quality) -> None:
        self._renderer.quality = quality

    def checkpoint(self) -> Checkpoint:
        """Return a copy of the state after the last frame, for `restore`; see its errors."""
        state = {name: getattr(self, name) for name in STATE_NAMES}
        return Checkpoint({**state, "intrinsics": self.intrinsics})

    def restore(self, checkpoint: Checkpoint) -> None:
        """Go on as after the frame at which a checkpoint was made.

        The scenario, the cube and the character must be the same as then. What the drawing follows
        is measured again: the appearance of a later time is not that of this one.
        """
        content = dict(checkpoint.content())
        self.sight.intrinsics = content.pop("intrinsics")
        for name, value in content.items():
            setattr(self, name, value)
        self.sight.look_through(self.tracked.intrinsics)
        self.sight.begin([each.cube for each in self.players])

    def adjust(self, settings: ScenarioSettings, look: str) -> None:
        """Play on with other settings, as far as the scenarios of the cast can be adjusted."""
        self._settings, self._look = settings, look
        for member in self.cast.members:
            if isinstance(member.scenario, AdjustableScenario):
                with scenario_errors(type(member.scenario)):
                    member.scenario.adjust(settings)
            member.attention.look = look

    def step(
        self,
        frame: Frame,
        inputs: Inputs | None = None,
        replay: ReplayInputs | None = None,
        *,
        drawn: bool = True,
        measured: bool | None = None,
    ) -> Step:
        """Process one frame.

        Parameters
        ----------
        frame
            The camera's picture, with its timestamp [s].
        inputs
            The other inputs of the frame; None if there are none.
        replay
            Recorded messages to use instead of computing them; None to compute all.
        drawn
            Whether to draw the picture; all else is the same.
        measured
            Whether to measure the picture's appearance; None to do so if it is drawn.

        Returns
        -------
        Step
            Every message of the frame, and the picture if there is a graphics context.
        """
        replay = replay or ReplayInputs()
        if drawn:
            self.expect(frame)
        first, *further = self.players
        markers = FrameMarkers(frame, self._detectors) if further else None
        state = replay.state or first.tracked.track(frame, markers)
        self.sight.follow(state, self.cube)
        self._lap("tracking")
        controls = replay.controls or first.gesture(state)
        played = [each.play(frame, markers, controls, replay) for each in further if markers]
        self._lap("gestures")
        appearance = replay.appearance
        if appearance is None and (drawn if measured is None else measured):
            appearance = self.sight.see(frame, state, controls)
        self._lap("appearance")
        inputs = inputs or Inputs()
        cast = self.cast
        told = cast.hear(inputs, controls.timestamp)
        seen = [SeenCube(state, controls), *(SeenCube(p.state, p.controls) for p in played)]
        view = view_of(controls, self.sight.lens)
        decisions = cast.decide(seen, told, view)
        for player, cube in zip(self.players, seen, strict=True):
            player.tracked.advise(frame, cube.state)
        self._lap("scenario")
        things = [
            each
            for player, cube in zip(self.players, seen, strict=True)
            for each in player.obstacles.update(
                cube.state, cube.controls, from_left=is_leftmost(cube, seen)
            )
        ]
        lead, *others = cast.perform(seen, decisions, told, tuple(things), view, replay)
        interior = self._window.update(state, controls, lead.command, inputs.inside)
        self._lap("animation")
        cubes, figures = picture_regions(
            [(state, self.cube.edge), *((each.state, each.edge) for each in played)],
            controls.camera_from_table,
            [each.body for each in cast.members if each.body is not None],
            interior,
            self.sight.lens.matrix,
        )
        step = Step(
            frame,
            state,
            controls,
            replace(lead.outcome, hint=self._hint(lead.outcome)),
            lead.posed,
            picture=None,
            subjects=(*cubes, *(each for each in figures if each is not None)),
            figures=figures,
            scenario=self.scenario.name,
            has_intensity=self.scenario.has_intensity,
            line=lead.line,
            name=lead.name,
            stands_upright=self.character.anatomy.kind == "humanoid",
            others=tuple(others),
            players=tuple(played),
            interior=interior,
            appearance=appearance,
            tracker_error="" if replay.state else self.tracked.error,
        )
        if drawn:
            step = self._drawn(step)
        self._lap("drawing")
        return step

    def expect(self, frame: Frame) -> None:
        """Begin to draw a frame, as far as nothing of what is in it is known."""
        self._renderer.expect(frame)

    def _hint(self, decision: Outcome) -> str:
        """Return what the player can do now; what the cube in view is comes first."""
        told = self.tracked.hint(self.scenario.name, self.fixed)
        return told or (LOOK_INSIDE if self._window.invites else decision.hint)

    def draw(self, step: Step) -> NDArray[np.uint8] | None:
        """Draw the picture of a step; return None without a graphics context."""
        return self._renderer.draw(step, self._drawn_bodies(step))

    def with_picture(self, step: Step) -> Step:
        """Return a step with its picture, which `step` left out."""
        appearance = step.appearance or self.sight.see(step.frame, step.state, step.controls)
        return self._drawn(replace(step, appearance=appearance))

    def _drawn(self, step: Step) -> Step:
        close_up = self._renderer.close_up(step, self._drawn_bodies(step)[0])
        return replace(step, picture=self.draw(step), close_up=close_up)

    def _drawn_bodies(self, step: Step) -> list[DrawnBody]:
        """Return the bodies of the cast as a step shows them."""
        poses = [step.posed, *(each.posed for each in step.others)]
        return [
            DrawnBody(member.body_of(posed), member.complexion.blood)
            for member, posed in zip(self.cast.members, poses, strict=True)
        ]

    def close(self) -> None:
        """Release the graphics; a second call does nothing."""
        self._renderer.close()
