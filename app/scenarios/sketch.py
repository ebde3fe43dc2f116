"""AvatAR's sketched path: the cube draws points, the character walks them in a loop."""

import numpy as np
from numpy.typing import NDArray

from cubeling.affect import Personality
from cubeling.app.pipeline.registry import SUMMARIES
from cubeling.app.pipeline.scenario import Inputs, Outcome, ScenarioSettings
from cubeling.app.pipeline.table.situation import PLAYER_POSITION, Situation
from cubeling.app.scenarios.follow import gait
from cubeling.app.scenarios.mood import MoodController
from cubeling.app.scenarios.presence import Presence
from cubeling.app.scenarios.speed import SpeedDial
from cubeling.characters import (
    IDLE_SPEED,
    ActionIntent,
    CharacterCommand,
    ClosedPath,
    LocomotionIntent,
    PosedCharacter,
    RootDelta,
)
from cubeling.characters.rendering import FloorPath
from cubeling.tracking import CubeControls, CubeModel

MAX_POINTS = 8
"""Number of points that closes the path (AvatAR)."""

MIN_LOOP_POINTS = 3
"""Number of points from which lifting the cube closes the path."""

MIN_POINT_DISTANCE_M = 0.05
"""How far the cube must be from the previous point to set another."""

LOOK_AHEAD_M = 0.07
"""How far ahead of the character its target is along the path."""

PATH_COLOR = (0.10, 0.45, 0.95)
"""Colour of the path on the table, sRGB."""


class Sketch:
    """Move the cube to draw, lift it (or reach eight points), then turn it to walk the loop (M10).

    The cube sets a point wherever it rests at least 5 cm from the previous one. Shaking the cube
    starts a new path. Beyond the thesis: a lap that is finished pleases the character.
    """

    name = "sketch"
    summary = SUMMARIES["sketch"]
    cube = "locomotion"
    roles: tuple[str, ...] = ()
    character = "human"
    personality = "lively"
    start = RootDelta(0.14, 0.0, 0.0)
    has_intensity = False
    adjustable = ("speed_map", "personality")

    def __init__(self, cube: CubeModel, settings: ScenarioSettings) -> None:
        self._dial = SpeedDial(settings.speed_map)
        self._mood = MoodController(settings.personality or Personality.load(self.personality))
        self._presence = Presence()
        self._points: list[NDArray[np.float64]] = []
        self._path: ClosedPath | None = None
        self._along: float | None = None  # where the character last was on the path [m]
        self._walked = 0.0

    @property
    def points(self) -> NDArray[np.float64]:
        """The points set so far, (n, 2) on the table [m]."""
        return np.array(self._points).reshape(-1, 2)

    def adjust(self, settings: ScenarioSettings) -> None:
        """Play on with other settings."""
        self._dial.use(settings.speed_map)
        self._mood.adjust(settings.personality or Personality.load(self.personality))

    def update(self, controls: CubeControls, situation: Situation, inputs: Inputs) -> Outcome:
        """Decide on one frame; see `Scenario.update`."""
        if inputs.clear or controls.shaken:
            self._points, self._path = [], None
        if inputs.clear:
            self._mood.reset()
        if self._path is None:
            self._draw(controls)
        speed = self._dial.update(controls.camera_angle, controls.timestamp)
        if self._path is None:
            speed = 0.0
        visible = self._presence.update(controls)
        command = CharacterCommand(
            timestamp=controls.timestamp,
            locomotion=LocomotionIntent(
                speed, self._target(situation.character), False, PLAYER_POSITION
            ),
            action=None if speed > IDLE_SPEED else ActionIntent("idle"),
            visible=visible,
        )
        events = ("finished",) if visible and self._finishes_lap(situation.character) else ()
        mood_speed = speed if visible else 0.0
        emotion = self._mood.update(
            controls, "idle", speed=mood_speed, events=(*events, *inputs.events)
        )
        icon = gait(speed, situation.walks)
        hint = self._hint(controls, speed)
        return Outcome(command, emotion, hint, icon, self._floor(), events)

    def _draw(self, controls: CubeControls) -> None:
        point = controls.position
        if controls.visible and controls.resting and point is not None and self.may_add(point):
            self._points.append(point)
        done = len(self._points) == MAX_POINTS
        if done or (controls.lifted and len(self._points) >= MIN_LOOP_POINTS):
            self._path = ClosedPath(self.points)

    def may_add(self, point: NDArray[np.float64]) -> bool:
        """Whether a point (x, z) [m] may be set: not a ninth, and not near the previous one."""
        if not self._points:
            return True
        distance = float(np.linalg.norm(point - self._points[-1]))
        return len(self._points) < MAX_POINTS and distance >= MIN_POINT_DISTANCE_M

    def _finishes_lap(self, character: PosedCharacter | None) -> bool:
        """Whether the character has just walked once around the path."""
        if self._path is None or character is None:
            self._along, self._walked = None, 0.0
            return False
        length, before = self._path.length, self._along
        self._along = self._path.nearest(character.table_from_character[[0, 2], 3])
        if before is not None:
            self._walked += (self._along - before + length / 2) % length - length / 2
        if self._walked < length:
            return False
        self._walked -= length
        return True

    def _target(self, character: PosedCharacter | None) -> NDArray[np.float64] | None:
        if self._path is None or character is None:
            return None
        return self._path.ahead(character.table_from_character[[0, 2], 3], LOOK_AHEAD_M)

    def _floor(self) -> tuple[FloorPath, ...]:
        if not self._points:
            return ()
        return (FloorPath(self.points, closed=self._path is not None, color=PATH_COLOR),)

    def _hint(self, controls: CubeControls, speed: float) -> str:
        if not controls.visible:
            return "Show me the cube"
        if controls.position is None:
            return "Put the cube on the table"
        if self._path is None:
            left = MAX_POINTS - len(self._points)
            again = "another point" if self._points else "a point"
            return f"Slide the cube and pause to leave {again} ({left} to go)"
        return "Turn the cube to walk" if speed <= IDLE_SPEED else "Shake the cube for a new path"
