"""The layers of a character, applied without a controller."""

import numpy as np

from cubeling.affect import Emotion
from cubeling.characters import Character, CharacterCommand, Pose, RootDelta
from cubeling.characters.body.posture import ExpressivityFilter
from cubeling.characters.control.controllers.controller import ControllerFrame
from cubeling.characters.control.layers import LIVELINESS_LAYERS, FrameContext, apply_layers
from cubeling.characters.locomotion.gaits import TOP_SPEED


class AppliedLayers:
    """Applies layers to poses, one after the other, and keeps the last frame's context."""

    def __init__(self, character: Character, seed: int = 0, layers=LIVELINESS_LAYERS) -> None:
        self._layers = [layer(character, seed) for layer in layers]
        self._expressivity = ExpressivityFilter()
        self.context: FrameContext

    def update(
        self,
        pose: Pose,
        elapsed: float,
        *,
        target=None,
        effort: float = 0.0,
        emotion: Emotion | None = None,
    ) -> Pose:
        """Return the pose after all layers; `target` is in the character frame."""
        command = CharacterCommand(0.0, gaze=target, emotion=emotion)
        frame = ControllerFrame(pose, "idle", RootDelta(), speed=effort * TOP_SPEED)
        expressivity = self._expressivity.update(elapsed, emotion)
        context = FrameContext(elapsed, command, frame, 1.0, np.eye(4), expressivity, 1.0)
        moved, self.context = apply_layers(self._layers, pose, context)
        return moved
