"""Splines with tension, continuity and bias (Kochanek and Bartels 1984)."""

from dataclasses import dataclass

import numpy as np

from cubeling.characters.behaviour.expressivity import NEUTRAL, GestureExpressivity
from cubeling.characters.skeleton.pose import Array


@dataclass(frozen=True, eq=False)
class TcbSpline:
    """A path through keys at any times; at its first and last key it rests."""

    times: Array
    """Ascending, (keys,)."""

    points: Array
    """(keys, n)."""

    incoming: Array
    """Derivative by time just before each key, (keys, n)."""

    outgoing: Array
    """Derivative by time just after each key, (keys, n)."""

    @staticmethod
    def of(times: Array, points: Array, style: GestureExpressivity = NEUTRAL) -> "TcbSpline":
        """Return the path through points: fluidity is c, bias is b, tension is t.

        The tangents are the differences to both neighbours, weighted as in the paper, and scaled
        to the unequal lengths of the segments, so that the speed is continuous at c = 0.
        """
        incoming, outgoing = np.zeros_like(points), np.zeros_like(points)
        if len(times) > 2:
            before, after = np.diff(points, axis=0)[:-1], np.diff(points, axis=0)[1:]
            mean = ((times[2:] - times[:-2]) / 2.0)[:, None]
            t, c, b = style.tension, style.fluidity, style.bias
            low, high = (1.0 - t) * (1.0 + b) / 2.0, (1.0 - t) * (1.0 - b) / 2.0
            incoming[1:-1] = ((1.0 - c) * low * before + (1.0 + c) * high * after) / mean
            outgoing[1:-1] = ((1.0 + c) * low * before + (1.0 - c) * high * after) / mean
        return TcbSpline(times, points, incoming, outgoing)

    def straighten(self, segment: int) -> "TcbSpline":
        """Return the path with one segment straight: its tangents keep the part along it."""
        chord = self.points[segment + 1] - self.points[segment]
        squared = float(chord @ chord)
        incoming, outgoing = self.incoming.copy(), self.outgoing.copy()
        for tangents, key in ((outgoing, segment), (incoming, segment + 1)):
            share = float(tangents[key] @ chord) / squared if squared > 0.0 else 0.0
            tangents[key] = chord * share
        return TcbSpline(self.times, self.points, incoming, outgoing)

    def segment(self, number: int, u: Array) -> Array:
        """Return the points of a segment at shares u (m,) of its time, (m, n)."""
        start, end = self.points[number], self.points[number + 1]
        length = float(self.times[number + 1] - self.times[number])
        out, into = self.outgoing[number] * length, self.incoming[number + 1] * length
        u = u[:, None]
        rest = u - 1.0
        points: Array = (
            (1.0 + 2.0 * u) * rest**2 * start
            + u * rest**2 * out
            + u**2 * (3.0 - 2.0 * u) * end
            + u**2 * rest * into
        )
        return points
