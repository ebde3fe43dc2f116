"""The hand that was found last, which often moves with the cube."""

import numpy as np

from cubeling.tracking.appearance.hand.mask import HandMask
from cubeling.tracking.cube.model import CubeModel
from cubeling.tracking.geometry.arrays import Array
from cubeling.tracking.geometry.projection import MIN_DEPTH, Projection

MIN_AGREEMENT, CARRIED_LOOKS = 0.9, 8
"""A hand is carried when it has moved with the cube from look to look so many times in turn: it was
where the one before, moved as the cube, is, up to this IoU."""

UNSEEN_S = 0.075
"""Time after which a hand is looked at again though it moves with the cube [s]."""

MAX_STEP_EDGES = 0.5
"""How far the cube moves in a frame that is not looked at, at most [apparent edges of the cube]."""


class LastHand:
    """The hand in the frame before, and whether it moves with the cube.

    One that has done so for a while is taken to go on in the next frames, which need not be looked
    at. A hand that comes, lets go or turns the cube is looked at in each frame.
    """

    def __init__(self, cube: CubeModel, projection: Projection) -> None:
        self.mask: HandMask | None = None
        """What it covers; None where there is no hand."""

        self._projection = projection
        self._edge = cube.edge * float(projection.matrix[0, 0])  # at 1 m [px]
        self._pose = np.eye(4)
        self._carried_looks, self._looked_at = 0, 0.0

    def update(self, mask: HandMask | None, camera_from_cube: Array, time: float) -> None:
        """Keep what was found at a time [s], with the pose of the cube, (4, 4)."""
        expected = self._move(camera_from_cube)
        is_carried = (
            mask is not None and expected is not None and expected.agreement(mask) > MIN_AGREEMENT
        )
        self._carried_looks = self._carried_looks + 1 if is_carried else 0
        self.mask, self._pose, self._looked_at = mask, camera_from_cube, time

    def carry(self, camera_from_cube: Array, time: float) -> bool:
        """Move the hand with the cube; return False where it must be looked for instead."""
        is_due = not 0.0 < time - self._looked_at < UNSEEN_S
        if is_due or self._carried_looks < CARRIED_LOOKS:
            return False
        hand = self._move(camera_from_cube)
        if hand is None or self.mask is None:
            return False
        step_px = max(abs(hand.x - self.mask.x), abs(hand.y - self.mask.y))
        depth = float(camera_from_cube[2, 3])
        if depth < MIN_DEPTH or step_px * depth > MAX_STEP_EDGES * self._edge:
            return False
        self.mask, self._pose = hand, camera_from_cube
        return True

    def predict(self, camera_from_cube: Array | None) -> HandMask | None:
        """Return the hand in a frame in which the cube is not seen, but expected somewhere."""
        self._carried_looks = 0
        return self.mask if camera_from_cube is None else self._move(camera_from_cube)

    def _move(self, camera_from_cube: Array) -> HandMask | None:
        """Return the hand moved with the cube; where it was if the cube is at the camera."""
        if self.mask is None or camera_from_cube[2, 3] < MIN_DEPTH:
            return self.mask
        centres = np.stack([self._pose[:3, 3], camera_from_cube[:3, 3]])
        before, now = np.rint(self._projection.project(centres))
        right, down = (int(step) for step in now - before)
        return self.mask.move(right, down, centres[1] - centres[0])
