"""How a body bears a feeling: tall or slumped, tense or loose, quick or slow.

Low spirits show in a bowed head and a sunken chest, pride in the opposite (Wallbott, "Bodily
expression of emotion", 1998); arousal in the tempo and size of all movements.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from affect import Emotion
from characters.body.axes import body_axes, turned
from characters.skeleton.anatomy import Anatomy
from characters.skeleton.pose import Array, Skeleton
from characters.smoothing import damped_spring

LAG = 0.9
"""How slowly a body follows a feeling [s]; the face is faster."""

FASTER = 0.6
"""Powers of two by which full arousal quickens breath, gaze and blinks, and calm slows them."""

LARGER = 0.7
"""The same of the size of small movements."""

BOW = math.radians(16.0)
"""How far a head hangs that is as low as can be [rad]; one that is held high is lifted by less."""

Degrees = tuple[float, float, float]
"""Of a turn about the body's axes: x to the left, y up, z forward."""

# Degrees by which joints turn about the body's axes, x to the left, y up, z forward: of a body as
# tall and open as can be, and of one as tense as can be. Slumped is the opposite of tall.
_TALL: dict[str, Degrees] = {
    "spine": (-4.0, 0.0, 0.0),
    "chest": (-7.0, 0.0, 0.0),
    "upperChest": (-4.0, 0.0, 0.0),
    "leftShoulder": (0.0, -5.0, 2.0),
    "rightShoulder": (0.0, 5.0, -2.0),
    "leftUpperArm": (-2.0, 0.0, 3.0),
    "rightUpperArm": (-2.0, 0.0, -3.0),
}
_TENSE: dict[str, Degrees] = {
    "spine": (3.0, 0.0, 0.0),
    "chest": (3.0, 0.0, 0.0),
    "neck": (4.0, 0.0, 0.0),
    "leftShoulder": (0.0, 4.0, 9.0),
    "rightShoulder": (0.0, -4.0, -9.0),
    "leftUpperArm": (0.0, 0.0, 9.0),
    "rightUpperArm": (0.0, 0.0, -9.0),
}
# On four legs the trunk carries the forelegs too: the neck and the tail tell.
_TALL_ON_FOUR: dict[str, Degrees] = {
    "neck": (-15.0, 0.0, 0.0),
    "head": (5.0, 0.0, 0.0),
    "tail1": (14.0, 0.0, 0.0),
    "tail2": (8.0, 0.0, 0.0),
}
_TENSE_ON_FOUR: dict[str, Degrees] = {
    "neck": (12.0, 0.0, 0.0),
    "head": (-3.0, 0.0, 0.0),
    "tail1": (10.0, 0.0, 0.0),
}


@dataclass(frozen=True, slots=True)
class Manner:
    """How a body does what it does without being asked."""

    pace: float = 1.0
    """Tempo of breath, gaze and blinks; 1 without a feeling."""

    size: float = 1.0
    """Size of small movements and depth of breath; 1 without a feeling."""

    bow: float = 0.0
    """How far the head hangs [rad]."""

    tall: float = 0.0
    """From slumped, −1, to tall, 1."""

    tense: float = 0.0
    """From loose, 0, to tense, 1."""


PLAIN = Manner()
"""That of a body that feels nothing."""


class Bearing:
    """The bearing of one character; a body that feels nothing is left alone, to the bit.

    Parameters
    ----------
    skeleton, anatomy
        Whose joints turn.
    stirring
        Numbers of joints that turn anyway, (m,), by breath and drift.
    """

    def __init__(
        self, skeleton: Skeleton, anatomy: Anatomy, stirring: Sequence[int] | NDArray[np.intp] = ()
    ) -> None:
        on_four = anatomy.kind == "quadruped"
        tall = _named(_TALL_ON_FOUR if on_four else _TALL, anatomy)
        tense = _named(_TENSE_ON_FOUR if on_four else _TENSE, anatomy)
        joints = list(dict.fromkeys([*map(int, stirring), *tall, *tense]))
        self.joints = np.array(joints, np.intp)
        """Numbers of the joints that turn, (n,): first those that turn anyway."""
        axes, still = body_axes(skeleton, self.joints), (0.0, 0.0, 0.0)
        self._tall = turned(axes, [tall.get(joint, still) for joint in joints])
        self._tense = turned(axes, [tense.get(joint, still) for joint in joints])
        self._valence = self._arousal = (0.0, 0.0)
        self.manner = PLAIN
        """How the body moves now."""

    def update(self, elapsed: float, emotion: Emotion | None) -> Manner:
        """Advance by a time [s] towards an emotion, or to none."""
        valence, arousal = (emotion.valence, emotion.arousal) if emotion else (0.0, 0.0)
        if self.manner is PLAIN and valence == arousal == 0.0:
            return PLAIN
        self._valence = damped_spring(*self._valence, valence, elapsed, LAG)
        self._arousal = damped_spring(*self._arousal, arousal, elapsed, LAG)
        moving = (*self._valence, *self._arousal)
        if valence == arousal == 0.0 and max(map(abs, moving)) < 1e-4:
            self._valence = self._arousal = (0.0, 0.0)
            self.manner = PLAIN
        else:
            self.manner = manner(self._valence[0], self._arousal[0])
        return self.manner

    def turns(self, share: float) -> Array:
        """Return rotation vectors in the joints' own frames, (n, 3) [rad]; `share` 0…1 of them."""
        vectors: Array = self._tall * (self.manner.tall * share)
        if self.manner.tense > 0.0:
            vectors += self._tense * (self.manner.tense * share)
        return vectors


def _named(degrees: Mapping[str, Degrees], anatomy: Anatomy) -> dict[int, Degrees]:
    """Return turns of parts as those of the joints that a body has."""
    found = {anatomy.joint(part): turn for part, turn in degrees.items()}
    return {joint: turn for joint, turn in found.items() if joint is not None}


def manner(valence: float, arousal: float) -> Manner:
    """Return how a body moves that feels so, each −1…1.

    >>> manner(0.7, 0.6).pace > 1 > manner(0.0, -0.9).pace
    True
    >>> manner(-0.6, -0.4).bow > 0 > manner(0.7, 0.6).bow
    True
    """
    tall = min(max(0.75 * valence + 0.55 * arousal, -1.0), 1.0)
    tense = max(-valence, 0.0) * max(arousal, 0.0)
    hung = -tall if tall < 0.0 else -0.3 * tall
    return Manner(
        pace=2.0 ** (FASTER * arousal),
        size=2.0 ** (LARGER * arousal),
        bow=BOW * min(hung + 0.9 * tense, 1.0),
        tall=tall,
        tense=min(1.5 * tense, 1.0),
    )
