"""The plane of valence and arousal: the regions of the labels, and the ways of feelings in it."""

import math
from collections.abc import Callable, Sequence

import numpy as np

from affect.emotion import ANGRY_BELOW, HAPPY_ABOVE
from affect.labels import LabelSet
from app.moods.drawing import Array, Drawing
from app.moods.history import Felt
from app.moods.tints import FAINT, INK, QUIET, RULE, tint

Way = tuple[Felt, str, tuple[float, ...], float]
"""A feeling, and the colour, dashes and width of its line."""

SQUARE = np.array([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)])


def draw_plane(
    drawing: Drawing,
    frame: tuple[float, float, float, float],
    labels: LabelSet,
    ways: Sequence[Way],
) -> None:
    """Draw the plane.

    Parameters
    ----------
    drawing
        Where to draw.
    frame
        Left, top, right and bottom of the plane on the paper.
    labels
        Whose regions are drawn.
    ways
        The feelings, the most important first.
    """
    left, top, right, bottom = frame

    def place(points: Array) -> Array:
        across = left + (points[:, 0] + 1) / 2 * (right - left)
        down = bottom - (points[:, 1] + 1) / 2 * (bottom - top)
        return np.stack([across, down], axis=1)

    cells = regions(labels)
    for label, cell in cells.items():
        drawing.area(place(cell), tint(labels, label))
    for cell in cells.values():
        drawing.line(place(np.concatenate([cell, cell[:1]])), FAINT, 0.8)
    for line in (np.array([(-1, 0), (1, 0)]), np.array([(0, -1), (0, 1)])):
        drawing.line(place(line.astype(float)), RULE, 0.7)
    _ticks(drawing, frame)
    for felt, colour, dashes, width in reversed(ways):
        drawing.line(place(felt.emotion), colour, width, dashes)
    _words(drawing, place, labels, cells)
    for felt, colour, _, _ in reversed(ways):
        (x, y), (x2, y2) = place(felt.emotion[[0, -1]]).tolist()
        drawing.disc(x, y, 4.0, "#ffffff", colour)
        drawing.disc(x2, y2, 4.0, colour, "#ffffff")
    drawing.disc(left + 6, bottom + 56, 4.0, "#ffffff", INK)
    drawing.text("first", left + 15, bottom + 60, 11, INK)
    drawing.disc(left + 56, bottom + 56, 4.0, INK, "#ffffff")
    drawing.text("last", left + 65, bottom + 60, 11, INK)


def regions(labels: LabelSet) -> dict[str, Array]:
    """Return the polygon of every label, (n, 2) in the plane: where it is the nearest.

    Labels that share their place with one before them have none.
    """
    if labels.by_valence:
        edges = {
            "angry": (-1.0, ANGRY_BELOW),
            "neutral": (ANGRY_BELOW, HAPPY_ABOVE),
            "happy": (HAPPY_ABOVE, 1.0),
        }
        return {
            label: np.array([(low, -1.0), (high, -1.0), (high, 1.0), (low, 1.0)])
            for label, (low, high) in edges.items()
        }
    places: dict[tuple[float, float], str] = {}
    for label, there in labels.places.items():
        places.setdefault(there, label)
    found = {}
    for here, label in places.items():
        cell = SQUARE
        for there in places:
            if there != here:
                cell = _nearer(cell, np.array(here), np.array(there))
        if len(cell):
            found[label] = cell
    return found


def _nearer(polygon: Array, here: Array, there: Array) -> Array:
    """Return the part of a polygon that is nearer to one point than to another."""
    way, middle = there - here, (here + there) / 2
    side = (polygon - middle) @ way
    kept: list[Array] = []
    for index in range(len(polygon)):
        a, b = index - 1, index
        if (side[a] > 0) != (side[b] > 0):
            kept.append(polygon[a] + (polygon[b] - polygon[a]) * side[a] / (side[a] - side[b]))
        if side[b] <= 0:
            kept.append(polygon[b])
    return np.array(kept).reshape(-1, 2)


def _ticks(drawing: Drawing, frame: tuple[float, float, float, float]) -> None:
    left, top, right, bottom = frame
    drawing.line(
        [(left, top), (right, top), (right, bottom), (left, bottom), (left, top)], QUIET, 0.8
    )
    for value in (-1.0, -0.5, 0.0, 0.5, 1.0):
        share = (value + 1) / 2
        words = f"{value:+g}".replace("-", "−").replace("+0", "0")
        words = "0" if value == 0 else words
        drawing.text(words, left + share * (right - left), bottom + 16, 11, INK, 0.5)
        drawing.text(words, left - 7, bottom - share * (bottom - top) + 4, 11, INK, 1.0)
    drawing.text("unpleasant", left, bottom + 33, 11, QUIET)
    drawing.text("valence [1]", (left + right) / 2, bottom + 33, 12.5, INK, 0.5)
    drawing.text("pleasant", right, bottom + 33, 11, QUIET, 1.0)
    drawing.text("arousal [1]", left - 42, (top + bottom) / 2, 12.5, INK, 0.5, upright=True)
    drawing.text("calm", left - 42, bottom, 11, QUIET, 0.0, upright=True)
    drawing.text("excited", left - 42, top, 11, QUIET, 1.0, upright=True)


def _words(
    drawing: Drawing,
    place: Callable[[Array], Array],
    labels: LabelSet,
    cells: dict[str, Array],
) -> None:
    """Write each label in its region, smaller where there are many."""
    size = 11.5 if len(cells) <= 10 else 8.0
    for label, cell in cells.items():
        middle = centroid(cell)
        if labels.by_valence:
            middle[1] = -0.85  # below the way, which the thesis' law keeps in the upper half
        elif math.dist(labels.places[label], (0.0, 0.0)) < 0.1:
            middle[1] = 0.7 * cell[:, 1].min()  # ways begin in the middle
        x, y = place(middle[None])[0].tolist()
        drawing.text(label, x, y + 4, size, INK, 0.5, bold=True)


def centroid(polygon: Array) -> Array:
    """Return the middle of a polygon by its area, (2,)."""
    after = np.roll(polygon, -1, axis=0)
    cross = polygon[:, 0] * after[:, 1] - after[:, 0] * polygon[:, 1]
    if math.isclose(float(cross.sum()), 0.0, abs_tol=1e-12):
        return np.asarray(polygon.mean(axis=0))
    return np.asarray(((polygon + after) * cross[:, None]).sum(axis=0) / (3 * cross.sum()))
