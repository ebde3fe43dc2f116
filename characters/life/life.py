"""Gaze, blinks, breath and small movements, laid over a pose."""

import numpy as np

from characters import rotations
from characters.anatomy import Anatomy
from characters.life.blink import Blinking
from characters.life.gaze import HUMAN, Gaze, Limits
from characters.life.lids import Lids
from characters.life.stirring import Stirring
from characters.pose import Array, Pose, Skeleton
from characters.smoothing import eased

_CALM_LAG = 0.5  # [s]


class Life:
    """What one character does without being asked.

    Poses go through `update` in the order of time. Two with the same seed live alike.

    Parameters
    ----------
    skeleton, anatomy
        Whose joints turn.
    morphs
        Names of the character's morphs; those that close the eyes (`Lids`) and "breath" are used.
    seed
        Of blinks and drift.
    limits
        How far it can look.
    """

    def __init__(
        self,
        skeleton: Skeleton,
        anatomy: Anatomy,
        morphs: tuple[str, ...] = (),
        seed: int = 0,
        limits: Limits = HUMAN,
    ) -> None:
        self._gaze = Gaze(skeleton, anatomy, limits)
        self._blinking = Blinking(seed)
        self._stirring = Stirring(skeleton, anatomy, seed)
        self._morphs = len(morphs)
        self._lids = Lids.of(morphs)
        self._wide = morphs.index("surprised") if "surprised" in morphs else None
        self._breath = morphs.index("breath") if "breath" in morphs else None
        self._calm = 1.0

    @property
    def breath(self) -> float:
        """How full the chest is, 0…1."""
        return self._stirring.breath

    def update(
        self,
        pose: Pose,
        elapsed: float,
        *,
        target: Array | None = None,
        effort: float = 0.0,
        busy: float = 0.0,
    ) -> Pose:
        """Advance by a time [s] and return the pose with what lives in it.

        Parameters
        ----------
        pose
            What the clips give.
        elapsed
            Since the last call.
        target
            What is looked at, (3,) in the character frame [m], or None.
        effort
            How hard the body works, 0 at rest … 1 at a full run.
        busy
            How much head and trunk have to do otherwise, 0 … 1 in the midst of an action.
        """
        self._calm = eased(self._calm, 1.0 - max(busy, min(2.0 * effort, 1.0)), elapsed, _CALM_LAG)
        joints = self._stirring.joints
        turns = self._stirring.update(elapsed, effort, self._calm)
        local = pose.rotations.copy()
        local[joints] = rotations.multiply(local[joints], turns)
        stirred = Pose(pose.translations, local, pose.scales, pose.morphs)
        looked = self._gaze.update(stirred, target, elapsed, 1.0 - 0.8 * busy)
        return self._with_face(looked, elapsed)

    def _with_face(self, pose: Pose, elapsed: float) -> Pose:
        """Return the pose with lids and breath in its morphs."""
        closed = self._blinking.update(elapsed, self._gaze.jumped)
        if not self._lids and self._breath is None:
            return pose
        morphs = np.zeros(self._morphs) if pose.morphs is None else pose.morphs.copy()
        self._lids.close(morphs, closed)
        if self._wide is not None:
            # Morphs add up: eyes that are torn open would not close all the way.
            morphs[self._wide] *= 1.0 - closed
        if self._breath is not None:
            morphs[self._breath] += self._stirring.breath
        return Pose(pose.translations, pose.rotations, pose.scales, morphs)
