"""The regions of labels in the plane of valence and arousal, and runs of labels over time."""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from cubeling.affect import ANGRY_BELOW, HAPPY_ABOVE, LabelSet

Array = NDArray[np.float64]

PLANE_CORNERS = np.array([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)])
"""Corners of the plane: (valence, arousal)."""


def regions(labels: LabelSet) -> dict[str, Array]:
    """Return the polygon (n, 2) of every label: the part of the plane where it is the nearest.

    Of labels at the same point of the plane, only the first has a region.
    """
    if labels.by_valence:
        ranges = {
            "angry": (-1.0, ANGRY_BELOW),
            "neutral": (ANGRY_BELOW, HAPPY_ABOVE),
            "happy": (HAPPY_ABOVE, 1.0),
        }
        return {
            label: np.array([(low, -1.0), (high, -1.0), (high, 1.0), (low, 1.0)])
            for label, (low, high) in ranges.items()
        }
    label_at: dict[tuple[float, float], str] = {}
    for label, point in labels.places.items():
        label_at.setdefault(point, label)
    found = {}
    for point, label in label_at.items():
        polygon = PLANE_CORNERS
        for other in label_at:
            if other != point:
                polygon = _nearer_part(polygon, np.array(point), np.array(other))
        if len(polygon):
            found[label] = polygon
    return found


def _nearer_part(polygon: Array, point: Array, other: Array) -> Array:
    """Return the part of a convex polygon that is nearer to one point than to another."""
    side = (polygon - (point + other) / 2) @ (other - point)
    kept: list[Array] = []
    for index in range(len(polygon)):
        a, b = index - 1, index
        if (side[a] > 0) != (side[b] > 0):
            kept.append(polygon[a] + (polygon[b] - polygon[a]) * side[a] / (side[a] - side[b]))
        if side[b] <= 0:
            kept.append(polygon[b])
    return np.array(kept).reshape(-1, 2)


def label_position(labels: LabelSet, label: str, polygon: Array) -> tuple[float, float]:
    """Return where in its region a label is written, so that curves leave it readable."""
    x, y = centroid(polygon).tolist()
    if labels.by_valence:
        y = -0.85  # the thesis' model keeps to the upper half
    elif math.dist(labels.places[label], (0.0, 0.0)) < 0.1:
        y = 0.7 * float(polygon[:, 1].min())  # curves start in the middle
    return x, y


def centroid(polygon: Array) -> Array:
    """Return the centre of a polygon's area, (2,)."""
    following = np.roll(polygon, -1, axis=0)
    cross = polygon[:, 0] * following[:, 1] - following[:, 0] * polygon[:, 1]
    if math.isclose(float(cross.sum()), 0.0, abs_tol=1e-12):
        return np.asarray(polygon.mean(axis=0))
    return np.asarray(((polygon + following) * cross[:, None]).sum(axis=0) / (3 * cross.sum()))


def runs(names: Sequence[str], times: Array) -> list[tuple[str, float, float]]:
    """Return (name, start, end [s]) of every run of equal names; each ends where the next starts.

    >>> runs(["calm", "calm", "glad"], np.array([0.0, 1.0, 2.0]))
    [('calm', 0.0, 2.0), ('glad', 2.0, 2.0)]
    """
    starts = [0] + [i for i in range(1, len(names)) if names[i] != names[i - 1]]
    ends = [float(times[start]) for start in starts[1:]] + [float(times[-1])]
    return [
        (names[start], float(times[start]), end) for start, end in zip(starts, ends, strict=True)
    ]
