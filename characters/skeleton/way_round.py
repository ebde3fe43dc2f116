"""The way round between two poses that both move: it does not change from frame to frame."""

import numpy as np

from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.pose import Array

STRAIGHT_COSINE = 0.95
"""Cosine of half the angle between two rotations above which a straight line between quaternions is
within 0.1° of the arc."""

DOUBTFUL_COSINE = 0.35
"""The same below which the way round begins past the rest, from 139° on."""

FULL_TURN_COSINE = -0.97
"""The same below which two rotations are alike again, a turn apart: the way begins again."""


class WayRound:
    """Interpolates between two sets of rotations, (n, 4), in the order of time.

    It begins by the shorter way; where that is hardly shorter, by the way past rotations at which
    the joints rest: what goes there or comes from there may make the other way the shorter one, and
    a limb does not go round behind. Where the two come to be half a turn apart, the shorter way
    becomes the other one: a blend that keeps to it would jump from one frame to the next. This one
    goes on.

    >>> way = WayRound()
    >>> a, b = rotations.about("y", [0.0]), [rotations.about("y", [t]) for t in (-3.0, -3.3)]
    >>> [np.round(2.0 * np.arccos(way.mix(a, each, 0.5)[:, 3]), 2).tolist() for each in b]
    [[1.5], [1.65]]
    """

    def __init__(self) -> None:
        self._ends: tuple[Array, Array] | None = None

    def mix(self, a: Array, b: Array, u: float, rest: Array | None = None) -> Array:
        """Return the interpolation from unit quaternions a at u = 0 to b at u = 1.

        A `u` a little over 1 overshoots. `rest` are the rotations at rest, if they are known.
        """
        if self._ends is not None and 0.0 < u < 1.0:
            a, b = (rotations.align(*each) for each in zip((a, b), self._ends, strict=True))
        else:
            b = rotations.align(b, a)
            if rest is not None:
                doubtful = np.vecdot(a, b) < DOUBTFUL_COSINE
                past = rotations.align(b, rotations.align(rest, a))
                b = np.where(doubtful[:, None], past, b)
        cosines = np.vecdot(a, b)
        if cosines.min(initial=1.0) < FULL_TURN_COSINE:
            around = cosines < FULL_TURN_COSINE
            b, cosines = np.where(around[:, None], -b, b), np.where(around, -cosines, cosines)
        self._ends = a, b
        below, over = 1.0 - u, u
        if cosines.min(initial=1.0) < STRAIGHT_COSINE:
            angles = np.arccos(np.minimum(cosines, 0.9999))
            below, over = np.sin(below * angles)[:, None], np.sin(over * angles)[:, None]
        return rotations.normalize(a * below + b * over)
