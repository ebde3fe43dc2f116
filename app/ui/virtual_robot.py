"""The virtual robot: it shows the mood on the screen where no real robot shows it on the desk."""

import math

import cv2
import moderngl
import numpy as np
from numpy.typing import NDArray

from affect import Emotion
from affect.hysteresis import HAPPY_ABOVE
from affect.words import closest_word
from app.pipeline.scenario import EmotionTarget
from app.ui.palette import PAPER, between, mood_color
from characters import ActionIntent, Animator, Character, CharacterCommand, RootDelta
from characters.rendering import SceneCharacter, Stage, View

LARGEST = 216
"""Side of the picture that is drawn at most [px]; software rendering takes longer for more."""

PAUSE = 0.08
"""Shortest time from one picture to the next where the processor draws [s]: every third frame of
a usual camera, for the character on the table needs the processor too."""

SOFTWARE = ("llvmpipe", "softpipe", "swiftshader", "software")
"""What drivers that draw on the processor call themselves."""

FACING = -0.52
"""The robot is turned so far to its right of the camera, so that its tail is seen too [rad]."""

CENTER, RADIUS = np.array([-0.010, 0.0835, 0.0]), 0.107
"""What the camera looks at on the table, and how much about it is in the picture [m]."""

FIELD, ABOVE = math.radians(22.0), 0.15
"""The camera's field of view, and how far it looks down [rad]."""


class VirtualRobot:
    """A small picture of the robot that feels what it is asked to feel.

    The same emotions at the same times give the same pictures, on one graphics driver. Who makes
    it closes it, before the context; a second `close` does nothing.

    Parameters
    ----------
    context
        Where to draw.
    side
        Of the picture as it is shown [px].
    """

    def __init__(self, context: moderngl.Context, side: int) -> None:
        self.side = max(16, side)
        """Width and height of its pictures [px]."""
        self._drawn = min(self.side, LARGEST)
        self._character = Character.load("robot")
        self._animator = Animator(self._character, place=RootDelta(yaw=FACING))
        self._stage: Stage | None = Stage(context, (self._drawn, self._drawn))
        self._matrix, self._camera_from_table = _camera(self._drawn)
        renderer = str(context.info["GL_RENDERER"]).lower()
        self._pause = PAUSE if any(name in renderer for name in SOFTWARE) else 0.0
        self._last: tuple[float, NDArray[np.uint8]] | None = None
        self._eye = np.asarray(np.linalg.inv(self._camera_from_table)[:3, 3], np.float64)

    def portrait(self, target: EmotionTarget) -> NDArray[np.uint8]:
        """Advance to an emotion and its time; return the picture, (side, side, 3) BGR.

        The same picture is returned again where it is too early for another.

        Raises
        ------
        RuntimeError
            If the virtual robot is closed.
        """
        if self._last is not None and 0.0 <= target.timestamp - self._last[0] < self._pause:
            return self._last[1]
        picture = self._drawing(target)
        if self._drawn != self.side:
            size = (self.side, self.side)
            picture = np.asarray(cv2.resize(picture, size, interpolation=cv2.INTER_CUBIC), np.uint8)
        self._last = target.timestamp, picture
        return picture

    def _drawing(self, target: EmotionTarget) -> NDArray[np.uint8]:
        if self._stage is None:
            raise RuntimeError("the virtual robot is closed")
        posed = self._animator.update(self.command(target))
        image = backdrop(self._drawn, target.emotion.valence)
        view = View(image, self._matrix, np.zeros(0), self._camera_from_table)
        return self._stage.draw(view, [SceneCharacter(self._character, posed)])

    def command(self, target: EmotionTarget) -> CharacterCommand:
        """Return how it is asked to show an emotion.

        It plays the mood that a robot with the same words would; what that leaves out is in its
        face and its bearing, as in any other character's.
        """
        action = closest_word(self._animator.actions, target.emotion)
        return CharacterCommand(
            timestamp=target.timestamp,
            action=ActionIntent(action or "idle", intensity(target.emotion, action)),
            gaze=self._eye,
            emotion=target.emotion,
        )

    def close(self) -> None:
        """Give the card's memory back."""
        if self._stage is not None:
            self._stage.release()
            self._stage = None


def intensity(emotion: Emotion, played: str | None = None) -> float:
    """Return how strongly an emotion is to be shown, −1…1.

    From where a mood begins to where it cannot be stronger; within neutral, from calm to stirred.
    `played` is the mood that shows it, where that has another name.

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
    elif played == "neutral":
        share = (emotion.arousal + 1.0) / 2.0
    else:
        share = (strength - HAPPY_ABOVE) / (1.0 - HAPPY_ABOVE)
    return float(np.clip(2.0 * share - 1.0, -1.0, 1.0))


def backdrop(side: int, mood: float) -> NDArray[np.uint8]:
    """Return a plain wall and floor in the colour of a mood, −1…1, (side, side, 3) BGR."""
    color = mood_color(mood)
    high, low = between(PAPER, color, 0.20), between(PAPER, color, 0.52)
    down = np.linspace(0.0, 1.0, side)[:, None] ** 1.5
    rows = np.array(high) + (np.array(low, float) - high) * down
    return np.repeat(np.round(rows).astype(np.uint8)[:, None], side, axis=1)


def _camera(side: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the pinhole matrix (3, 3) [px] and `camera_from_table` (4, 4)."""
    toward = np.array([0.0, math.sin(ABOVE), math.cos(ABOVE)])
    eye = CENTER + RADIUS / math.sin(FIELD / 2) * toward
    right = np.array([1.0, 0.0, 0.0])
    turn = np.stack([right, np.cross(right, toward), -toward])
    camera_from_table = np.eye(4)
    camera_from_table[:3, :3], camera_from_table[:3, 3] = turn, -turn @ eye
    focal, middle = side / 2 / math.tan(FIELD / 2), (side - 1) / 2
    matrix = np.array([[focal, 0.0, middle], [0.0, focal, middle], [0.0, 0.0, 1.0]])
    return matrix, camera_from_table
