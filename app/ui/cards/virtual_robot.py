"""A virtual robot on the screen, which shows the emotion when there is no real robot."""

import math
from collections.abc import Callable

import cv2
import moderngl
import numpy as np
from numpy.typing import NDArray

from cubeling.affect import HAPPY_ABOVE, Emotion, closest_word
from cubeling.app.pipeline.scenario import EmotionTarget
from cubeling.app.ui.canvas import Canvas
from cubeling.app.ui.display import is_software_renderer
from cubeling.app.ui.palette import PAPER, between, mood_color
from cubeling.characters import ActionIntent, Animator, Character, CharacterCommand, RootDelta
from cubeling.characters.rendering import CameraView, SceneCharacter, Stage

MAX_SIDE_PX = 216
"""Largest picture that is drawn [px]; a larger one is scaled up, to spare software rendering."""

SOFTWARE_INTERVAL_S, SOFTWARE_CHANGE_S = 0.165, 0.099
"""Shortest time between two pictures with software rendering, and where the mood has another word
[s]: every fifth and every third frame of a usual camera, since the character on the table needs the
processor too."""

YAW_RAD = -0.52
"""Heading of the robot, to the right of the camera, so that its tail is visible [rad]."""

CENTER_M, RADIUS_M = np.array([-0.010, 0.0835, 0.0]), 0.107
"""Sphere of the table frame that fills the picture [m]."""

FIELD_OF_VIEW_RAD, ELEVATION_RAD = math.radians(22.0), 0.15
"""The camera's field of view, and the angle by which it looks down [rad]."""


class VirtualRobot:
    """Small pictures of a robot that shows the emotion it is given.

    The same emotions at the same times give the same pictures, on one graphics driver. Whoever
    creates it closes it, before the context; a second `close` does nothing.
    """

    def __init__(self, context: moderngl.Context, side: int) -> None:
        self._context = context
        self._twin: VirtualRobot | None = None
        self.side = max(16, side)
        """Width and height of its pictures [px]."""
        self._drawn_side = min(self.side, MAX_SIDE_PX)
        self._character = Character.load("robot")
        self._animator = Animator(self._character, place=RootDelta(yaw=YAW_RAD))
        self._stage = Stage(context, (self._drawn_side, self._drawn_side))
        self._matrix, self._camera_from_table = _camera(self._drawn_side)
        software = is_software_renderer(str(context.info["GL_RENDERER"]))
        self._intervals = (SOFTWARE_INTERVAL_S, SOFTWARE_CHANGE_S) if software else (0.0, 0.0)
        self._label = ""
        self._last: tuple[float, NDArray[np.uint8]] | None = None
        self._card: tuple[object, NDArray[np.uint8], Canvas] | None = None
        self._eye = np.asarray(np.linalg.inv(self._camera_from_table)[:3, 3], np.float64)

    def portrait(self, target: EmotionTarget) -> NDArray[np.uint8]:
        """Advance to an emotion and its time, and return the picture, (side, side, 3) BGR.

        With software rendering, the last picture is returned until `SOFTWARE_INTERVAL_S` is over.
        """
        label = target.emotion.label
        interval = self._intervals[label != self._label]
        if self._last is not None and 0.0 <= target.timestamp - self._last[0] < interval:
            return self._last[1]
        self._label = label
        posed = self._animator.update(self.command(target))
        image = backdrop(self._drawn_side, target.emotion.valence)
        view = CameraView(image, self._matrix, np.zeros(0), self._camera_from_table)
        picture = self._stage.draw(view, [SceneCharacter(self._character, posed)])
        if self._drawn_side != self.side:
            size = (self.side, self.side)
            picture = np.asarray(cv2.resize(picture, size, interpolation=cv2.INTER_CUBIC), np.uint8)
        self._last = target.timestamp, picture
        return picture

    def card(self, content: object, draw: Callable[[], Canvas]) -> Canvas:
        """Return the card with the last picture: `draw` is called where the content is another."""
        assert self._last is not None, "a portrait comes first"
        picture = self._last[1]
        if self._card is None or self._card[0] != content or self._card[1] is not picture:
            self._card = content, picture, draw()
        return self._card[2]

    @property
    def twin(self) -> "VirtualRobot":
        """Another one, for the robot of a second player; it is closed with this one."""
        if self._twin is None:
            self._twin = VirtualRobot(self._context, self.side)
        return self._twin

    def fit(self, side: int) -> None:
        """Give pictures of another side [px] from the next one on."""
        if self._twin is not None:
            self._twin.fit(side)
        if side != self.side:
            self.side, self._last = max(16, side), None

    def command(self, target: EmotionTarget) -> CharacterCommand:
        """Return the command that shows an emotion.

        The action is the mood that a robot with the same labels plays. Face and posture show the
        exact emotion, as those of every character do.
        """
        action = closest_word(self._animator.actions, target.emotion)
        return CharacterCommand(
            timestamp=target.timestamp,
            action=ActionIntent(action or "idle", intensity(target.emotion, action)),
            gaze=self._eye,
            emotion=target.emotion,
        )

    def close(self) -> None:
        """Release the graphics buffers."""
        self._stage.release()
        if self._twin is not None:
            self._twin.close()


def intensity(emotion: Emotion, action: str | None = None) -> float:
    """Return the weight of the action that shows an emotion, −1…1.

    It rises from the threshold of a mood to its maximum; within neutral, from calm to excited.
    `action` is the mood that is played, if it is not the emotion's own label.

    >>> [round(intensity(Emotion(v, abs(v), "happy")), 2) for v in (0.3, 1.0)]
    [-1.0, 1.0]
    >>> intensity(Emotion(0.0, 0.0, "neutral"))
    -1.0
    >>> round(intensity(Emotion(-0.6, -0.4, "sad"), "neutral"), 2)
    -0.4
    """
    strength = max(abs(emotion.valence), emotion.arousal)
    if emotion.label == "neutral":
        share = strength / HAPPY_ABOVE
    elif action == "neutral":
        share = (emotion.arousal + 1.0) / 2.0
    else:
        share = (strength - HAPPY_ABOVE) / (1.0 - HAPPY_ABOVE)
    return float(np.clip(2.0 * share - 1.0, -1.0, 1.0))


def backdrop(side: int, mood: float) -> NDArray[np.uint8]:
    """Return a plain wall and floor in the colour of a mood −1…1, (side, side, 3) BGR."""
    color = mood_color(mood)
    top, bottom = between(PAPER, color, 0.20), between(PAPER, color, 0.52)
    share = np.linspace(0.0, 1.0, side)[:, None] ** 1.5
    rows = np.array(top) + (np.array(bottom, float) - top) * share
    return np.repeat(np.round(rows).astype(np.uint8)[:, None], side, axis=1)


def _camera(side: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the pinhole matrix (3, 3) [px] and `camera_from_table` (4, 4)."""
    backward = np.array([0.0, math.sin(ELEVATION_RAD), math.cos(ELEVATION_RAD)])
    eye = CENTER_M + RADIUS_M / math.sin(FIELD_OF_VIEW_RAD / 2) * backward
    right = np.array([1.0, 0.0, 0.0])
    rotation = np.stack([right, np.cross(right, backward), -backward])
    camera_from_table = np.eye(4)
    camera_from_table[:3, :3], camera_from_table[:3, 3] = rotation, -rotation @ eye
    focal, middle = side / 2 / math.tan(FIELD_OF_VIEW_RAD / 2), (side - 1) / 2
    matrix = np.array([[focal, 0.0, middle], [0.0, focal, middle], [0.0, 0.0, 1.0]])
    return matrix, camera_from_table
