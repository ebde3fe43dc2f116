"""Splines with tension, continuity and bias (Kochanek and Bartels 1984)."""

from dataclasses import dataclass

import numpy as np

from cubeling.characters.behaviour.expressivity import NEUTRAL, GestureExpressivity
from cubeling.characters.skeleton.pose import Array

MOST_WEIGHT = 1.0
"""Weight of a difference in a tangent, at most: that of one parameter at its end. Together they
would have up to 4, and a hand would leave the space about the body."""


@dataclass(frozen=True, eq=False)
class TcbSpline:
    """A path through keys at any times; at its first and last key it rests."""

    times: Array
    """Ascending, (keys,)."""

    points: Array
    """(keys, …)."""

    incoming: Array
    """Derivative by time just before each key, (keys, …)."""

    outgoing: Array
    """Derivative by time just after each key, (keys, …)."""

    @staticmethod
    def of(times: Array, points: Array, style: GestureExpressivity = NEUTRAL) -> "TcbSpline":
        """Return the path through points: fluidity is c, bias is b, tension is t.

        The tangents are the differences to both neighbours, weighted as in the paper, and scaled
        to the unequal lengths of the segments, so that the speed is continuous at c = 0.
        """
        incoming, outgoing = np.zeros_like(points), np.zeros_like(points)
        if len(times) > 2:
            steps = np.diff(points, axis=0)
            before, after = steps[:-1], steps[1:]
            mean = ((times[2:] - times[:-2]) / 2.0).reshape(-1, *(1,) * (points.ndim - 1))
            t, c, b = style.tension, style.fluidity, style.bias
            weights = [
                min((1.0 - t) * (1.0 + side * c) * (1.0 + sign * b) / 2.0, MOST_WEIGHT)
                for side, sign in ((-1.0, 1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, -1.0))
            ]
            incoming[1:-1] = (weights[0] * before + weights[1] * after) / mean
            outgoing[1:-1] = (weights[2] * before + weights[3] * after) / mean
        return TcbSpline(times, points, incoming, outgoing)
