"""The icons next to the markers, as outlines to fill on paper and on screen.

An icon is a list of loops in the unit square, x right and y down. They are filled by the
**nonzero** rule: clockwise loops are ink and may overlap, counter-clockwise loops are holes.
Painting them one after the other, ink or paper, gives the same result.
"""

import functools
import itertools
import math

import cv2
import numpy as np

from cubeling.tracking.geometry.arrays import Array, Image

Point = tuple[float, float]

CIRCLE_POINTS = 40
"""At 6 mm the sides of such a circle are half a millimetre long and look round."""

ICON_SHARE, FOLD_GAP_SHARE = 0.8, 0.04
"""Height of an icon on a face, and its distance from the fold, as shares of the white margin.

Larger ones come so near to the marker that its edges are measured less well.
"""

ICON_COLOURS: dict[str, tuple[int, int, int]] = {
    "stand": (42, 157, 143),
    "walk": (238, 148, 46),
    "run": (231, 96, 70),
    "turn": (142, 118, 200),
    "idle": (84, 168, 104),
    "kiss": (236, 92, 140),
    "shout": (240, 160, 30),
}
"""Colour of each icon that a face can carry (red, green, blue).

None is dark: next to a marker, a dark colour would look like its black to a camera out of focus.
"""


OTHER_ACTION = "act"
"""The icon of an action that has none of its own."""


def icon_paths(name: str) -> list[Array]:
    """Return the loops of an icon, (N, 2) each, in the unit square, x right and y down.

    Parameters
    ----------
    name
        One of `icons`, such as "walk".

    Raises
    ------
    KeyError
        There is no such icon.
    """
    return icons()[name]


def has_icon(name: str) -> bool:
    """Return whether there is an icon of a name."""
    return name in icons()


def icon_mask(name: str, pixels: int) -> Image:
    """Draw an icon as the coverage of each pixel, 0 to 255, (pixels, pixels).

    Parameters
    ----------
    name
        As in `icon_paths`.
    pixels
        Width and height of the image [px].

    Raises
    ------
    KeyError
        There is no such icon.
    """
    oversampling = 8
    mask = np.zeros((pixels * oversampling, pixels * oversampling), np.uint8)
    for loop in icon_paths(name):
        corners = np.rint(loop * (pixels * oversampling * 16) - 8).astype(np.int32)
        cv2.fillPoly(mask, [corners], 255 if signed_area(loop) > 0 else 0, shift=4)
    small = cv2.resize(mask, (pixels, pixels), interpolation=cv2.INTER_AREA)
    return np.asarray(small, np.uint8)


def signed_area(loop: Array) -> float:
    """Area of a loop, positive where it runs clockwise with y down."""
    x, y = loop.T
    return float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y)) / 2


def _disc(x: float, y: float, radius: float) -> Array:
    angle = np.linspace(0, 2 * math.pi, CIRCLE_POINTS, endpoint=False)
    return np.column_stack([x + radius * np.cos(angle), y + radius * np.sin(angle)])


def _hole(loop: Array) -> Array:
    return loop[::-1]


def _limb(*joints: tuple[float, float, float]) -> list[Array]:
    """Strokes with round ends from joint to joint, each joint (x, y, radius)."""
    loops = []
    for one, other in itertools.pairwise(joints):
        circles = np.concatenate([_disc(*one), _disc(*other)]).astype(np.float32)
        hull = cv2.convexHull(circles, clockwise=False)[:, 0].astype(np.float64)
        loops.append(hull if signed_area(hull) > 0 else hull[::-1])
    return loops


def _stroke(width: float, *points: Point) -> list[Array]:
    return _limb(*((x, y, width / 2) for x, y in points))


def _arc(x: float, y: float, radius: float, width: float, start: float, end: float) -> Array:
    """Return part of a ring; angles in degrees, clockwise from the right."""
    angle = np.radians(np.linspace(start, end, CIRCLE_POINTS))
    direction = np.column_stack([np.cos(angle), np.sin(angle)])
    ring = np.concatenate(
        [direction * (radius + width / 2), direction[::-1] * (radius - width / 2)]
    )
    return np.asarray(ring + np.array([x, y]))


def _heart(x: float, y: float, size: float) -> Array:
    angle = np.linspace(0, 2 * math.pi, 2 * CIRCLE_POINTS, endpoint=False)
    across = 16 * np.sin(angle) ** 3
    upwards = 13 * np.cos(angle) - 5 * np.cos(2 * angle) - 2 * np.cos(3 * angle) - np.cos(4 * angle)
    return np.column_stack([across, -upwards - 2.5]) * (size / 32) + (x, y)


def _turn() -> list[Array]:
    loops: list[Array] = [_disc(0.5, 0.5, 0.09)]
    for start in (-70, 110):
        loops.append(_arc(0.5, 0.5, 0.35, 0.12, start, start + 118))
        end = math.radians(start + 112)
        way = np.array([math.cos(end), math.sin(end)])
        ahead = np.array([-math.sin(end), math.cos(end)])
        head = [way * 0.18, way * 0.35 + ahead * 0.21, way * 0.5]
        loops.append(np.array(head)[::-1] + 0.5)
    return loops


def _shout() -> list[Array]:
    spikes = 11
    angle = np.radians(np.arange(2 * spikes) * 180 / spikes - 90)
    reach = np.where(np.arange(2 * spikes) % 2, 0.34, 0.49)
    burst = np.column_stack([np.cos(angle), np.sin(angle)]) * reach[:, None] + 0.5
    stroke = _limb((0.5, 0.27, 0.062), (0.5, 0.52, 0.036))[0]
    return [burst, _hole(stroke), _hole(_disc(0.5, 0.69, 0.055))]


def _person(
    left: tuple[Point, ...], right: tuple[Point, ...], *more: Array, x: float = 0.5
) -> list[Array]:
    """Return a person who stands, with an elbow and a hand for each arm, and what is beside it."""
    return [
        _disc(x, 0.2, 0.115),
        *_stroke(0.22, (x, 0.45), (x, 0.58)),
        *_stroke(0.09, (x - 0.08, 0.4), *left),
        *_stroke(0.09, (x + 0.08, 0.4), *right),
        *_stroke(0.11, (x - 0.05, 0.62), (x - 0.07, 0.93)),
        *_stroke(0.11, (x + 0.05, 0.62), (x + 0.07, 0.93)),
        *more,
    ]


def _block(x: float, y: float, side: float) -> Array:
    return np.array([(x, y), (x + side, y), (x + side, y + side), (x, y + side)])


def _head(x: float, y: float) -> list[Array]:
    """Return a head with two eyes."""
    return [_disc(x, y, 0.35), *(_hole(_disc(x + each, y - 0.05, 0.055)) for each in (-0.13, 0.13))]


def _star(x: float, y: float, radius: float) -> Array:
    angle = np.radians(np.arange(8) * 45 - 90)
    reach = np.where(np.arange(8) % 2, 0.3, 1.0) * radius
    return np.column_stack([np.cos(angle), np.sin(angle)]) * reach[:, None] + (x, y)


def _flower(x: float, y: float) -> list[Array]:
    petals = [_disc(x + 0.075 * math.cos(a), y + 0.075 * math.sin(a), 0.06)
              for a in np.arange(5) * 0.4 * math.pi]  # fmt: skip
    return [*petals, _hole(_disc(x, y, 0.035)), *_stroke(0.04, (x, y + 0.1), (x, y + 0.32))]


def _actions() -> dict[str, list[Array]]:
    """Build the icons of a character that reaches for the cube, carries things, or talks."""
    hanging = ((0.3, 0.5), (0.29, 0.63))
    low, near = ((0.19, 0.5), (0.17, 0.63)), ((0.55, 0.49), (0.68, 0.53))
    return {
        "reach": _person(low, ((0.5, 0.46), (0.64, 0.5)), _block(0.7, 0.4, 0.26), x=0.34),
        "stretch": _person(
            low,
            ((0.5, 0.3), (0.63, 0.2)),
            _block(0.78, 0.04, 0.2),
            *_stroke(0.045, (0.64, 0.07), (0.7, 0.03)),
            *_stroke(0.045, (0.72, 0.3), (0.78, 0.34)),
            x=0.34,
        ),
        "shrug": _person(((0.28, 0.52), (0.15, 0.4)), ((0.72, 0.52), (0.85, 0.4))),
        "point": _person(
            low,
            ((0.55, 0.4), (0.7, 0.4)),
            np.array([(0.74, 0.26), (0.97, 0.4), (0.74, 0.54)]),
            x=0.34,
        ),
        "cheer": _person(
            ((0.26, 0.3), (0.2, 0.12)),
            ((0.74, 0.3), (0.8, 0.12)),
            *_stroke(0.045, (0.06, 0.3), (0.12, 0.33)),
            *_stroke(0.045, (0.94, 0.3), (0.88, 0.33)),
        ),
        "wave": _person(
            hanging,
            ((0.76, 0.34), (0.79, 0.16)),
            *_stroke(0.045, (0.62, 0.08), (0.67, 0.05)),
            *_stroke(0.045, (0.92, 0.12), (0.95, 0.18)),
        ),
        "jump": _person(
            ((0.3, 0.3), (0.22, 0.16)),
            ((0.7, 0.3), (0.78, 0.16)),
            *_stroke(0.045, (0.2, 0.74), (0.2, 0.9)),
            *_stroke(0.045, (0.8, 0.74), (0.8, 0.9)),
        ),
        "nod": [
            *_head(0.37, 0.47),
            *_stroke(0.09, (0.86, 0.2), (0.86, 0.6)),
            np.array([(0.72, 0.56), (1.0, 0.56), (0.86, 0.78)]),
        ],
        "shake": [
            *_head(0.5, 0.36),
            *_stroke(0.09, (0.26, 0.87), (0.74, 0.87)),
            np.array([(0.28, 0.73), (0.28, 1.0), (0.07, 0.87)]),
            np.array([(0.72, 0.73), (0.93, 0.87), (0.72, 1.0)]),
        ],
        OTHER_ACTION: [
            _star(0.42, 0.54, 0.42),
            _star(0.84, 0.2, 0.16),
        ],
        "wait": [
            *_stroke(0.09, (0.2, 0.07), (0.8, 0.07)),
            *_stroke(0.09, (0.2, 0.93), (0.8, 0.93)),
            np.array(
                [(0.25, 0.12), (0.75, 0.12), (0.54, 0.5), (0.75, 0.88), (0.25, 0.88), (0.46, 0.5)]
            ),
            _hole(np.array([(0.34, 0.18), (0.66, 0.18), (0.6, 0.28), (0.4, 0.28)])),
        ],
        "search": [
            _disc(0.41, 0.41, 0.35),
            _hole(_disc(0.41, 0.41, 0.24)),
            *_stroke(0.15, (0.68, 0.68), (0.88, 0.88)),
        ],
        "take": _person(low, near, *_flower(0.8, 0.42), x=0.34),
        "give": _person(
            low,
            near,
            *_flower(0.8, 0.16),
            np.array([(0.68, 0.66), (0.92, 0.66), (0.8, 0.84)]),
            x=0.34,
        ),
        "carry": _person(hanging, ((0.68, 0.5), (0.8, 0.4)), *_flower(0.84, 0.14)),
        "talk": [
            *_stroke(0.54, (0.32, 0.39), (0.68, 0.39)),
            np.array([(0.26, 0.58), (0.54, 0.62), (0.22, 0.93)]),
            *(_hole(_disc(x, 0.39, 0.06)) for x in (0.3, 0.5, 0.7)),
        ],
    }


@functools.cache
def icons() -> dict[str, list[Array]]:
    """Build all icons.

    Those in `ICON_COLOURS` are printed on faces, the others in instructions or on the screen.
    """
    return {
        **_actions(),
        "stand": [
            _disc(0.5, 0.155, 0.125),
            *_stroke(0.24, (0.5, 0.42), (0.5, 0.56)),
            *_stroke(0.1, (0.41, 0.36), (0.31, 0.5), (0.3, 0.64)),
            *_stroke(0.1, (0.59, 0.36), (0.69, 0.5), (0.7, 0.64)),
            *_stroke(0.115, (0.44, 0.6), (0.42, 0.92)),
            *_stroke(0.115, (0.56, 0.6), (0.58, 0.92)),
        ],
        "walk": [
            _disc(0.55, 0.145, 0.12),
            *_stroke(0.19, (0.53, 0.4), (0.5, 0.55)),
            *_stroke(0.095, (0.56, 0.36), (0.68, 0.5), (0.8, 0.53)),
            *_stroke(0.095, (0.5, 0.36), (0.36, 0.46), (0.31, 0.6)),
            *_stroke(0.115, (0.53, 0.58), (0.66, 0.73), (0.71, 0.93), (0.78, 0.93)),
            *_stroke(0.115, (0.48, 0.58), (0.42, 0.77), (0.25, 0.91)),
        ],
        "run": [
            _disc(0.68, 0.135, 0.115),
            *_stroke(0.185, (0.59, 0.37), (0.51, 0.52)),
            *_stroke(0.095, (0.63, 0.33), (0.75, 0.47), (0.89, 0.42)),
            *_stroke(0.095, (0.55, 0.32), (0.39, 0.34), (0.33, 0.48)),
            *_stroke(0.115, (0.53, 0.55), (0.7, 0.64), (0.66, 0.85), (0.73, 0.87)),
            *_stroke(0.115, (0.48, 0.55), (0.38, 0.74), (0.17, 0.76)),
            *_stroke(0.05, (0.07, 0.3), (0.24, 0.3)),
            *_stroke(0.05, (0.04, 0.45), (0.17, 0.45)),
            *_stroke(0.05, (0.04, 0.6), (0.24, 0.6)),
        ],
        "hop": [
            _arc(0.24, 0.8, 0.19, 0.1, 180, 360),
            _arc(0.62, 0.8, 0.19, 0.1, 180, 300),
            _disc(0.76, 0.42, 0.19),
        ],
        "turn": _turn(),
        "idle": [
            *_limb((0.36, 0.6, 0.14), (0.47, 0.57, 0.165), (0.58, 0.57, 0.145)),
            *_limb((0.61, 0.54, 0.12), (0.72, 0.36, 0.078), (0.79, 0.2, 0.07)),
            *_limb((0.8, 0.175, 0.085), (0.91, 0.2, 0.062)),
            *_limb((0.34, 0.61, 0.12), (0.2, 0.7, 0.075), (0.09, 0.68, 0.04), (0.04, 0.58, 0.018)),
            *_stroke(0.14, (0.35, 0.68), (0.34, 0.87)),
            *_stroke(0.14, (0.6, 0.66), (0.61, 0.87)),
            _hole(_disc(0.82, 0.165, 0.024)),
        ],
        "kiss": [_heart(0.42, 0.57, 0.78), _heart(0.85, 0.17, 0.27)],
        "shout": _shout(),
        "cut": [
            *_limb((0.3, 0.68, 0.05), (0.74, 0.08, 0.03)),
            *_limb((0.7, 0.68, 0.05), (0.26, 0.08, 0.03)),
            _disc(0.25, 0.78, 0.17),
            _hole(_disc(0.25, 0.78, 0.09)),
            _disc(0.75, 0.78, 0.17),
            _hole(_disc(0.75, 0.78, 0.09)),
        ],
        "fold": [
            np.array([(0.04, 0.62), (0.46, 0.62), (0.46, 0.96), (0.04, 0.96)]),
            *_stroke(0.06, (0.57, 0.65), (0.57, 0.93)),
            np.array([(0.66, 0.6), (0.96, 0.42), (0.96, 0.76), (0.66, 0.94)]),
            _arc(0.5, 0.52, 0.34, 0.09, 200, 300),
            np.array([(0.62, 0.08), (0.84, 0.3), (0.55, 0.38)]),
        ],
        "glue": [
            np.array([(0.43, 0.04), (0.57, 0.04), (0.64, 0.26), (0.36, 0.26)]),
            np.array(
                [(0.3, 0.3), (0.7, 0.3), (0.74, 0.4), (0.74, 0.96), (0.26, 0.96), (0.26, 0.4)]
            ),
            _hole(_heart(0.5, 0.66, 0.3)),
        ],
    }
