"""The shapes of beat gestures: where a hand is at the top of the stroke, and where at its apex.

Vectors are of the left hand in the rest axes of the chest: +x to the outside, +y up, +z forward.
Shapes after the descriptions in McNeill, "Hand and Mind" (1992), and Kendon, "Gesture: Visible
Action as Utterance" (2004), chapters 12 and 13.
"""

from dataclasses import dataclass, replace

import numpy as np

from tools.authoring.modelling.shapes import Array

Vector = tuple[float, float, float]

FLAT = (6.0, 4.0, 4.0, 6.0)
LOOSE = (14.0, 16.0, 22.0, 28.0)
OPEN = (2.0, 0.0, 3.0, 8.0)
CUPPED = (16.0, 14.0, 18.0, 20.0)
FIST = (38.0, 74.0, 78.0, 80.0)
PINCH = (40.0, 46.0, 24.0, 12.0)
POINT = (34.0, 2.0, 70.0, 76.0)
"""Bends of thumb, index, middle and little finger [degrees]."""


@dataclass(frozen=True)
class HandShape:
    """A hand at one moment."""

    wrist: Vector
    """Where it is, in the rest pose [m]."""

    fingers: Vector
    """Where the fingers point to."""

    thumb: Vector
    """Where the thumb points to."""

    bends: tuple[float, float, float, float] = LOOSE
    """Of thumb, index, middle and little finger [degrees]."""

    elbow: Vector = (0.75, -0.6, -0.45)
    """Where the elbow points to."""

    def values(self) -> Array:
        """Return all numbers in one row, (16,)."""
        return np.array([*self.wrist, *self.fingers, *self.thumb, *self.elbow, *self.bends])


@dataclass(frozen=True)
class Beat:
    """A stroke from its top to its apex."""

    top: HandShape
    """Where the stroke begins."""

    apex: HandShape
    """Where it is farthest."""

    round_trip: bool = False
    """Whether it goes around: the apex is in the middle of the stroke."""

    def scaled(self, size: float) -> "Beat":
        """Return it larger or smaller; its apex is half as much elsewhere as its top."""
        a, b = np.array(self.top.wrist), np.array(self.apex.wrist)
        middle = a + (b - a) * 0.65
        wrists = [tuple((middle + (p - middle) * size).tolist()) for p in (a, b)]
        return Beat(
            replace(self.top, wrist=wrists[0]), replace(self.apex, wrist=wrists[1]), self.round_trip
        )


BEATS = {
    "chop": Beat(
        HandShape((0.17, 1.07, 0.23), (-0.10, 0.50, 0.85), (0.05, 1.0, -0.4), FLAT),
        HandShape((0.17, 0.92, 0.27), (-0.15, -0.10, 1.0), (0.05, 1.0, 0.1), FLAT),
    ),
    "palm up": Beat(
        HandShape((0.14, 1.04, 0.24), (-0.20, 0.35, 1.0), (0.40, 0.9, -0.2), LOOSE),
        HandShape((0.25, 0.94, 0.28), (0.40, 0.05, 0.95), (1.0, 0.30, -0.3), OPEN),
    ),
    "precision": Beat(
        HandShape((0.15, 1.07, 0.25), (-0.15, 0.45, 0.9), (-0.5, 0.85, -0.3), PINCH),
        HandShape((0.16, 0.97, 0.29), (-0.15, -0.10, 1.0), (-0.5, 0.85, 0.1), PINCH),
    ),
    "fist": Beat(
        HandShape((0.21, 1.09, 0.19), (-0.10, 0.60, 0.8), (-0.4, 0.8, -0.5), FIST),
        HandShape((0.17, 0.94, 0.27), (-0.20, -0.10, 1.0), (-0.3, 1.0, 0.1), FIST),
    ),
    "sweep": Beat(
        HandShape((0.08, 1.01, 0.27), (-0.55, 0.10, 0.85), (-0.8, 0.35, -0.5), FLAT),
        HandShape((0.34, 0.98, 0.20), (0.65, 0.0, 0.75), (-0.7, 0.4, 0.6), FLAT),
    ),
    "flick": Beat(
        HandShape((0.16, 0.98, 0.25), (-0.25, -0.05, 1.0), (-0.9, 0.4, 0.0), LOOSE),
        HandShape((0.23, 1.00, 0.26), (0.30, 0.30, 0.9), (0.9, 0.5, -0.4), OPEN),
    ),
    "press": Beat(
        HandShape((0.17, 1.05, 0.23), (-0.25, 0.15, 0.95), (-0.95, 0.2, -0.2), CUPPED),
        HandShape((0.18, 0.90, 0.25), (-0.20, 0.35, 0.9), (-0.95, 0.1, -0.2), OPEN),
    ),
    "self": Beat(
        HandShape((0.22, 1.02, 0.24), (-0.30, 0.35, 0.9), (0.1, 0.9, -0.3), OPEN),
        HandShape(
            (0.14, 1.04, 0.205), (-0.95, 0.25, -0.10), (0.2, 0.95, 0.15), FLAT, (0.9, -0.5, 0.1)
        ),
    ),
    "toss": Beat(
        HandShape((0.11, 1.00, 0.26), (-0.45, 0.10, 0.9), (0.1, 0.95, 0.0), LOOSE),
        HandShape((0.32, 1.07, 0.20), (0.60, 0.50, 0.65), (0.3, 0.75, -0.75), OPEN),
    ),
    "wag": Beat(
        HandShape((0.20, 1.06, 0.20), (0.05, 0.95, 0.25), (-0.8, 0.2, 0.5), POINT),
        HandShape((0.19, 1.01, 0.26), (0.0, 0.55, 0.85), (-0.8, 0.5, -0.2), POINT),
    ),
    "offer": Beat(
        HandShape((0.17, 0.95, 0.21), (-0.10, 0.15, 1.0), (0.7, 0.7, -0.1), CUPPED),
        HandShape((0.19, 0.99, 0.34), (0.10, 0.15, 1.0), (0.95, 0.35, -0.1), OPEN),
    ),
    "circle": Beat(
        HandShape((0.16, 1.05, 0.23), (-0.20, 0.30, 0.95), (-0.3, 0.9, -0.3), LOOSE),
        HandShape((0.23, 0.95, 0.30), (0.10, -0.05, 1.0), (0.2, 0.95, 0.0), LOOSE),
        round_trip=True,
    ),
    "open": Beat(
        HandShape((0.13, 0.98, 0.25), (-0.40, 0.15, 0.9), (0.3, 0.9, -0.1), LOOSE),
        HandShape((0.37, 1.03, 0.16), (0.70, 0.25, 0.65), (0.6, 0.6, -0.7), OPEN),
    ),
    "weigh": Beat(
        HandShape((0.20, 1.06, 0.24), (0.05, 0.25, 1.0), (0.9, 0.4, -0.2), CUPPED),
        HandShape((0.20, 0.92, 0.25), (0.05, -0.10, 1.0), (0.9, 0.4, 0.0), CUPPED),
    ),
}
"""The vocabulary."""
