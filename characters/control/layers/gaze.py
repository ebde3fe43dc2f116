"""Gaze: head and eyes that follow a point, and movements of the head besides."""

import numpy as np

from cubeling.characters.behaviour.realization.head_movements import turned_head
from cubeling.characters.behaviour.realization.planned_values import PlannedValues
from cubeling.characters.body.gaze import HEAD_LAG_S, Gaze
from cubeling.characters.control.layers.behaviour import gaze_of, lag_of
from cubeling.characters.control.layers.layer import Found, FrameContext
from cubeling.characters.control.layers.posture import posture_share
from cubeling.characters.model.character import Character
from cubeling.characters.skeleton.pose import Array, Pose

HEAD_SHARE_IN_ACTION = 0.2
"""Part of its turn that the head makes while an action needs it."""


class GazeLayer:
    """Turns head and eyes to the point that the command names, nods and shakes the head."""

    def __init__(self, character: Character, seed: int = 0) -> None:
        self._gaze = Gaze(
            character.skeleton, character.anatomy, character.morphs, character.look_at
        )
        self._movements = PlannedValues(3)

    def update(self, pose: Pose, context: FrameContext) -> Found:
        """Return the pose with its gaze on the point, and how far that has moved."""
        looked = gaze_of(context)
        target, tempo = context.gaze_target, context.expressivity.tempo
        share = 1.0 - (1.0 - HEAD_SHARE_IN_ACTION) * float(context.frame.acting)
        if looked is not None:
            target, tempo = context.in_character(looked.target), HEAD_LAG_S / lag_of(looked)
            share *= float(looked.influence != "EYES")
        speaking = context.speaking
        pose = self._gaze.update(
            pose,
            target,
            context.elapsed,
            share,
            tempo=tempo,
            head_drop=context.expressivity.head_drop * posture_share(context),
            head_turn=self._head_turn(context) + speaking.nod,
            averted=None if looked is not None else speaking.aversion,
        )
        return Found(pose, context.found(gaze_shift=self._gaze.shift))

    def _head_turn(self, context: FrameContext) -> Array:
        """Return how the head moves besides: a rotation vector about the body's axes, (3,)."""
        behaviour = context.command.behaviour
        heads = () if behaviour is None else behaviour.heads
        return self._movements.update(
            tuple((each.key, each.lexeme, each.times, each.amount) for each in heads),
            lambda time: turned_head(heads, time) if heads else np.zeros(3),
            context.command.timestamp,
        )
