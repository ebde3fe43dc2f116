"""What every pose layer is: it takes a pose and returns one, once a frame."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any, NamedTuple, Protocol

import numpy as np

from cubeling.affect import Emotion
from cubeling.characters.body.posture import Expressivity
from cubeling.characters.control.command import CharacterCommand
from cubeling.characters.control.controllers.controller import ControllerFrame
from cubeling.characters.control.speaking.state import NOT_SPEAKING, SpeakingState
from cubeling.characters.model.character import Character
from cubeling.characters.skeleton.pose import Array, Pose


@dataclass(frozen=True)
class FrameContext:
    """What the layers of one frame take besides the pose."""

    elapsed: float
    """Time since the last frame [s]."""

    command: CharacterCommand
    """What is asked of the character."""

    frame: ControllerFrame
    """What its controller plays."""

    scale: float
    """Table metres per metre of the character."""

    table_from_character: Array
    """Where it stands, (4, 4)."""

    expressivity: Expressivity
    """How its body moves by itself, because of its emotion."""

    rest: float
    """1 standing still … 0 running or in the midst of an action; smoothed."""

    gaze_shift: float = 0.0
    """Angle by which the gaze target moved, as the gaze layer found it [rad]."""

    breath: float = 0.0
    """Filling of the lungs, as the posture layer found it, 0…1."""

    speaking: SpeakingState = NOT_SPEAKING
    """What is done with a speech besides gestures, as the speech layer found it."""

    def found(self, **values: Any) -> "FrameContext":
        """Return the same with what a layer has found: other values of some fields.

        `dataclasses.replace` would read every field by its name, which takes as long as a layer.
        """
        context = object.__new__(FrameContext)
        context.__dict__.update(self.__dict__, **values)
        return context

    @property
    def emotion(self) -> Emotion | None:
        """The emotion to show."""
        return self.command.emotion

    @property
    def gaze_target(self) -> Array | None:
        """The point to look at, (3,) in the character frame [m], or None."""
        return None if self.command.gaze is None else self.in_character(self.command.gaze)

    def in_character(self, point: Array) -> Array:
        """Return a point (3,) of the table frame in the character frame [m]."""
        # A single point: plain numbers are quicker than arrays.
        (ax, ay, az, px), (bx, by, bz, py), (cx, cy, cz, pz), _ = self.table_from_character.tolist()
        x, y, z = np.asarray(point, float).tolist()
        x, y, z, square = x - px, y - py, z - pz, by * by
        turned = x * ax + y * bx + z * cx, x * ay + y * by + z * cy, x * az + y * bz + z * cz
        inside: Array = np.array(turned) / square
        return inside

    def direction_in_character(self, direction: Array | None) -> Array | None:
        """Return a direction (3,) of the table frame in the character frame; None stays None."""
        if direction is None:
            return None
        turned: Array = np.asarray(direction, float) @ self.table_from_character[:3, :3]
        return turned / float(np.linalg.norm(turned))


class Found(NamedTuple):
    """What a layer returns that has found something for those after it."""

    pose: Pose
    """The pose with the layer applied."""

    context: FrameContext
    """What the layers after it take."""


class PoseLayer(Protocol):
    """Changes the poses of one character, in the order of time."""

    def update(self, pose: Pose, context: FrameContext) -> Pose | Found:
        """Return the pose with this layer applied."""
        ...


def apply_layers(
    layers: Iterable[PoseLayer], pose: Pose, context: FrameContext
) -> tuple[Pose, FrameContext]:
    """Return a pose with layers applied in their order, and all that they found."""
    for layer in layers:
        made = layer.update(pose, context)
        pose, context = (made.pose, made.context) if isinstance(made, Found) else (made, context)
    return pose, context


LayerFactory = Callable[[Character, int], PoseLayer]
"""Makes the layer of a character, with a seed for what is random in it."""
