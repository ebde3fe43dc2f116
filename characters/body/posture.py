"""How an emotion shows in a body: erect or slumped, tense or loose, quick or slow.

Low spirits show in a bowed head and a sunken chest, pride in the opposite (Wallbott, "Bodily
expression of emotion", 1998); arousal shows in the tempo and size of all movements.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cubeling.affect import Emotion
from cubeling.characters.body.axes import Degrees, body_axes, rotation_vectors
from cubeling.characters.skeleton.anatomy import Anatomy
from cubeling.characters.skeleton.pose import Array, Skeleton
from cubeling.characters.smoothing import damped_spring

EXPRESSIVITY_LAG_S = 0.9
"""Lag with which a body follows an emotion [s]; the face is faster."""

TEMPO_OCTAVES = 0.6
"""Powers of two by which full arousal raises the tempo of breath, gaze and blinks."""

AMPLITUDE_OCTAVES = 0.7
"""Powers of two by which full arousal enlarges small movements."""

MAX_HEAD_DROP_RAD = math.radians(16.0)
"""How far a head drops at most [rad]; it is raised by less."""

NEGLIGIBLE_AFFECT = 1e-4
"""Valence and arousal, and their rates, below which a body is neutral again."""

# Turns of joints about the body's axes [degrees]: of a fully erect body, and of a fully tense one.
# A slumped body is the opposite of an erect one.
_ERECT_DEG: dict[str, Degrees] = {
    "spine": (-4.0, 0.0, 0.0),
    "chest": (-7.0, 0.0, 0.0),
    "upperChest": (-4.0, 0.0, 0.0),
    "leftShoulder": (0.0, -5.0, 2.0),
    "rightShoulder": (0.0, 5.0, -2.0),
    "leftUpperArm": (-2.0, 0.0, 3.0),
    "rightUpperArm": (-2.0, 0.0, -3.0),
}
_TENSE_DEG: dict[str, Degrees] = {
    "spine": (3.0, 0.0, 0.0),
    "chest": (3.0, 0.0, 0.0),
    "neck": (4.0, 0.0, 0.0),
    "leftShoulder": (0.0, 4.0, 9.0),
    "rightShoulder": (0.0, -4.0, -9.0),
    "leftUpperArm": (0.0, 0.0, 9.0),
    "rightUpperArm": (0.0, 0.0, -9.0),
}
# The trunk of a quadruped carries the forelegs too, so only neck, head and tail turn.
_QUADRUPED_ERECT_DEG: dict[str, Degrees] = {
    "neck": (-15.0, 0.0, 0.0),
    "head": (5.0, 0.0, 0.0),
    "tail1": (14.0, 0.0, 0.0),
    "tail2": (8.0, 0.0, 0.0),
}
_QUADRUPED_TENSE_DEG: dict[str, Degrees] = {
    "neck": (12.0, 0.0, 0.0),
    "head": (-3.0, 0.0, 0.0),
    "tail1": (10.0, 0.0, 0.0),
}


@dataclass(frozen=True, slots=True)
class Expressivity:
    """How a body moves by itself."""

    tempo: float = 1.0
    """Tempo of breath, gaze and blinks; 1 without an emotion."""

    amplitude: float = 1.0
    """Size of small movements and depth of breath; 1 without an emotion."""

    head_drop: float = 0.0
    """How far the head drops [rad]."""

    erectness: float = 0.0
    """From slumped, −1, to erect, 1."""

    tension: float = 0.0
    """From loose, 0, to tense, 1."""


NEUTRAL_EXPRESSIVITY = Expressivity()
"""Of a body without an emotion."""


def expressivity_of(valence: float, arousal: float) -> Expressivity:
    """Return how a body moves with an emotion, each axis −1…1.

    >>> expressivity_of(0.7, 0.6).tempo > 1 > expressivity_of(0.0, -0.9).tempo
    True
    >>> expressivity_of(-0.6, -0.4).head_drop > 0 > expressivity_of(0.7, 0.6).head_drop
    True
    """
    erectness = min(max(0.75 * valence + 0.55 * arousal, -1.0), 1.0)
    tension = max(-valence, 0.0) * max(arousal, 0.0)
    drop = -erectness if erectness < 0.0 else -0.5 * erectness
    return Expressivity(
        tempo=2.0 ** (TEMPO_OCTAVES * arousal),
        amplitude=2.0 ** (AMPLITUDE_OCTAVES * arousal),
        head_drop=MAX_HEAD_DROP_RAD * min(drop + 0.9 * tension, 1.0),
        erectness=erectness,
        tension=min(1.5 * tension, 1.0),
    )


class ExpressivityFilter:
    """Follows an emotion with a lag; without one it is exactly neutral."""

    def __init__(self) -> None:
        self._valence = self._arousal = (0.0, 0.0)
        self._place = (0.0, 0.0)  # for which the value holds
        self.value = NEUTRAL_EXPRESSIVITY
        """The present expressivity."""

    def update(self, elapsed: float, emotion: Emotion | None) -> Expressivity:
        """Advance by a time [s] towards an emotion, or towards none."""
        valence, arousal = (emotion.valence, emotion.arousal) if emotion else (0.0, 0.0)
        neutral = valence == arousal == 0.0
        if self.value is NEUTRAL_EXPRESSIVITY and neutral:
            return NEUTRAL_EXPRESSIVITY
        self._valence = damped_spring(*self._valence, valence, elapsed, EXPRESSIVITY_LAG_S)
        self._arousal = damped_spring(*self._arousal, arousal, elapsed, EXPRESSIVITY_LAG_S)
        place = self._valence[0], self._arousal[0]
        if math.dist(place, self._place) < NEGLIGIBLE_AFFECT and not neutral:
            return self.value
        self._place = place
        if neutral and max(map(abs, (*self._valence, *self._arousal))) < NEGLIGIBLE_AFFECT:
            self._valence = self._arousal = (0.0, 0.0)
            self.value = NEUTRAL_EXPRESSIVITY
        else:
            self.value = expressivity_of(*place)
        return self.value


class Posture:
    """The joints by which one body shows its expressivity.

    Joints that are `moving`, (m,), turn anyway, by breath and sway.
    """

    def __init__(self, skeleton: Skeleton, anatomy: Anatomy, moving: NDArray[np.intp]) -> None:
        quadruped = anatomy.kind == "quadruped"
        erect = _joints(_QUADRUPED_ERECT_DEG if quadruped else _ERECT_DEG, anatomy)
        tense = _joints(_QUADRUPED_TENSE_DEG if quadruped else _TENSE_DEG, anatomy)
        joints = list(dict.fromkeys([*moving.tolist(), *erect, *tense]))
        self.joints = np.array(joints, np.intp)
        """The joints that turn, (n,): first those that turn anyway."""
        axes, none = body_axes(skeleton, self.joints), (0.0, 0.0, 0.0)
        self._erect = rotation_vectors(axes, [erect.get(joint, none) for joint in joints])
        self._tense = rotation_vectors(axes, [tense.get(joint, none) for joint in joints])

    def rotation_vectors(self, expressivity: Expressivity, share: float) -> Array:
        """Return `share` (0…1) of the turns, (n, 3) [rad], in the joints' own frames."""
        vectors: Array = self._erect * (expressivity.erectness * share)
        if expressivity.tension > 0.0:
            vectors += self._tense * (expressivity.tension * share)
        return vectors


def _joints(degrees: Mapping[str, Degrees], anatomy: Anatomy) -> dict[int, Degrees]:
    found = {anatomy.joint(part): turn for part, turn in degrees.items()}
    return {joint: turn for joint, turn in found.items() if joint is not None}
