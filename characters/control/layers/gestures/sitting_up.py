"""Four-legged bodies that sit up to use their front legs as arms."""

from cubeling.characters.control.layers.layer import FrameContext
from cubeling.characters.ik.sitting_up import SittingUp
from cubeling.characters.model.character import Character
from cubeling.characters.skeleton.pose import Pose
from cubeling.characters.smoothing import damped_spring

LAG_S = 0.3
"""Lag with which a body sits up, and comes down [s]."""

NEGLIGIBLE = 1e-3
"""Share of sitting up below which a body stands."""

STANDING_REST = 0.5
"""Rest, 0…1, from which on a body stands still enough to sit up."""


class SittingUpLayer:
    """Raises the trunk of a four-legged body while its hands are asked for and it stands."""

    def __init__(self, character: Character, seed: int = 0) -> None:
        self._sitting = SittingUp.of(character.skeleton, character.anatomy)
        self._share, self._speed = 0.0, 0.0

    def update(self, pose: Pose, context: FrameContext) -> Pose:
        """Return the pose, sitting up as far as it has got."""
        asked = context.command.behaviour
        if self._sitting is None or (asked is None and self._share == 0.0):
            return pose
        busy = asked is not None and bool(asked.gestures or asked.reaches)
        target = float(busy and context.rest > STANDING_REST)
        self._share, self._speed = damped_spring(
            self._share, self._speed, target, context.elapsed, LAG_S
        )
        if target == 0.0 and self._share < NEGLIGIBLE:
            self._share = self._speed = 0.0
        return self._sitting.sit_up(pose, min(max(self._share, 0.0), 1.0))
