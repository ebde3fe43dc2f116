"""Gaze, blinks, breath and small movements, and what is felt, laid over a pose."""

import math
from collections.abc import Sequence

import numpy as np

from affect import Emotion
from characters.body.gaze import HUMAN, Gaze, Limits
from characters.body.posture import PLAIN, Bearing
from characters.body.sway import Stirring
from characters.face.affect_display import Face
from characters.face.blink import Blinking
from characters.face.lids import Lids, blinks_in
from characters.model.mesh import Mesh
from characters.skeleton import rotations
from characters.skeleton.anatomy import Anatomy
from characters.skeleton.pose import Array, Pose, Skeleton
from characters.smoothing import low_pass

_CALM_LAG = 0.5  # [s]
_HELD_IN_ACTION = 0.5  # so much of a bearing stays in the midst of an action


class Life:
    """What one character does without being asked.

    Poses go through `update` in the order of time. Two with the same seed live alike.

    Parameters
    ----------
    skeleton, anatomy
        Whose joints turn.
    morphs
        Names of the character's morphs; those that close the eyes (`Lids`), those that make faces
        (`Expressions`) and "breath" are used.
    seed
        Of blinks and drift.
    limits
        How far it can look.
    meshes
        That the morphs change: they tell how much of a blink is in each.
    """

    def __init__(
        self,
        skeleton: Skeleton,
        anatomy: Anatomy,
        morphs: tuple[str, ...] = (),
        seed: int = 0,
        limits: Limits = HUMAN,
        meshes: Sequence[Mesh] = (),
    ) -> None:
        self._gaze = Gaze(skeleton, anatomy, limits)
        self._blinking = Blinking(seed)
        self._stirring = Stirring(skeleton, anatomy, seed)
        self._bearing = Bearing(skeleton, anatomy, self._stirring.joints)
        self._morphs = len(morphs)
        self._lids = Lids.of(morphs)
        self._face = Face(morphs, blinks_in(morphs, meshes, self._lids))
        self._wide = morphs.index("surprised") if "surprised" in morphs else None
        self._breath = morphs.index("breath") if "breath" in morphs else None
        self._calm = 1.0

    @property
    def breath(self) -> float:
        """How full the chest is, 0…1."""
        return self._stirring.breath

    @property
    def tempo(self) -> float:
        """How much faster a clip in which it stands is to go, because of what it feels."""
        return math.sqrt(self._bearing.manner.pace)

    def update(
        self,
        pose: Pose,
        elapsed: float,
        *,
        target: Array | None = None,
        effort: float = 0.0,
        busy: float = 0.0,
        emotion: Emotion | None = None,
        played: bool = False,
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
        emotion
            What face and posture show, or None to leave them to the clips.
        played
            Whether the clips are those of a mood, so that the face need not show one.
        """
        self._calm = low_pass(
            self._calm, 1.0 - max(busy, min(2.0 * effort, 1.0)), elapsed, _CALM_LAG
        )
        manner = self._bearing.update(elapsed, emotion)
        self._face.update(elapsed, None if played else emotion)
        share = _HELD_IN_ACTION + (1.0 - _HELD_IN_ACTION) * self._calm
        joints, borne = self._stirring.joints, None
        if manner is not PLAIN:
            joints, borne = self._bearing.joints, self._bearing.turns(share)
        turns = self._stirring.update(elapsed, effort, self._calm, manner, borne)
        local = pose.rotations.copy()
        local[joints] = rotations.multiply(local[joints], turns)
        stirred = Pose(pose.translations, local, pose.scales, pose.morphs)
        looked = self._gaze.update(
            stirred,
            target,
            elapsed,
            1.0 - 0.8 * busy,
            pace=manner.pace,
            bow=manner.bow * share,
        )
        return self._with_face(looked, elapsed, busy)

    def _with_face(self, pose: Pose, elapsed: float, busy: float) -> Pose:
        """Return the pose with feeling, lids and breath in its morphs."""
        pace = self._bearing.manner.pace
        closed = self._blinking.update(elapsed, self._gaze.jumped, pace)
        felt = self._face.felt and self._face.able
        if not self._lids and self._breath is None and not felt:
            return pose
        morphs = np.zeros(self._morphs) if pose.morphs is None else pose.morphs.copy()
        if felt:
            # A lid that an expression holds half closed is only closed the other half.
            shut, hang = self._face.show(morphs, elapsed, closed, busy)
            self._lids.close(morphs, max(closed, hang - shut))
            self._lids.narrow(morphs, 1.0 - shut)
        else:
            self._lids.close(morphs, closed)
        if self._wide is not None:
            # Morphs add up: eyes that are torn open would not close all the way.
            morphs[self._wide] *= 1.0 - closed
        if self._breath is not None:
            morphs[self._breath] += self._stirring.breath
        return Pose(pose.translations, pose.rotations, pose.scales, morphs)
