"""Where a character that reaches for the cube stands, goes and looks; all in the table frame."""

import math

import numpy as np
from numpy.typing import NDArray

from cubeling.app.pipeline.table.props import PosedBody
from cubeling.characters import past_circle
from cubeling.characters.motion import ARRIVAL_DISTANCE_M

Point = NDArray[np.float64]

AVOIDED_M = 0.075
"""It walks round the centre of the cube at this distance, if it is in the way [m]."""

INSIDE_EDGES = 0.7
"""A body this near to the middle of the cube is in it, in edges of the cube: just at a corner."""

LOOK_M, LOOK_HEIGHTS_M = 0.4, (0.05, 0.22)
"""How far away the points are that it looks at while it looks about, and how high [m]."""

LOOKS_RAD = (0.9, -0.9, -0.4, 0.5)
"""Their directions in turn, to its left [rad]."""


def nearest_point_of_cube(table_from_cube: Point, edge: float, point: Point) -> Point:
    """Return the point of a cube's surface, (3,) [m], that is nearest to a point outside.

    >>> nearest_point_of_cube(np.eye(4), 0.06, np.array([0.1, 0.02, 0.0])).tolist()
    [0.03, 0.02, 0.0]
    """
    rotation, centre = table_from_cube[:3, :3], table_from_cube[:3, 3]
    inside = np.clip((point - centre) @ rotation, -edge / 2, edge / 2)
    return np.asarray(centre + rotation @ inside)


def sides_of_cube(
    table_from_cube: Point, edge: float, left: Point
) -> tuple[tuple[Point, Point], tuple[Point, Point]]:
    """Return the middles of a cube's left and right side, (3,) [m], and the ways out of it there.

    `left` is the direction (3,) that is the left of who looks at it.

    >>> (place, out), _ = sides_of_cube(np.eye(4), 0.06, np.array([-0.9, 0.1, 0.2]))
    >>> place.tolist(), out.tolist()
    ([-0.03, 0.0, 0.0], [-1.0, 0.0, 0.0])
    """
    along = left @ table_from_cube[:3, :3]
    number = int(np.abs(along).argmax())
    out = table_from_cube[:3, number] * np.sign(along[number])
    centre = table_from_cube[:3, 3]
    return (centre + edge / 2 * out, out + 0.0), (centre - edge / 2 * out, 0.0 - out)


def gap(here: Point, goal: Point, distance: float) -> float:
    """Return how far `here` is from standing at a distance from a goal [m]; 0 if it is nearer."""
    return max(math.dist(here[[0, 2]], goal[[0, 2]]) - distance, 0.0)


def way_to(here: Point, goal: Point, distance: float, *, walks: bool) -> Point:
    """Return the target of a `LocomotionIntent`, (x, z), to stand at a distance from a goal [m].

    Who walks stops `ARRIVAL_DISTANCE_M` before a target.
    """
    offset = here[[0, 2]] - goal[[0, 2]]
    length = max(float(np.linalg.norm(offset)), 1e-9)
    stop = min(distance, length) - (ARRIVAL_DISTANCE_M if walks else 0.0)
    return np.asarray(goal[[0, 2]] + offset * (stop / length))


def around(here: Point, target: Point, cube: Point) -> Point:
    """Return a target (x, z), or a point to pass first if the cube is on the way to it.

    >>> around(np.array([-0.3, 0, 0]), np.array([-0.2, 0.0]), np.zeros(3)).tolist()
    [-0.2, 0.0]
    >>> bool(around(np.array([-0.3, 0, 0]), np.array([0.3, 0.1]), np.zeros(3))[1] > 0.03)
    True
    """
    return past_circle(here[[0, 2]], target, cube[[0, 2]], AVOIDED_M)


def out_of(here: Point, cube: Point, edge: float) -> Point | None:
    """Return where to go, (3,) [m], out of a cube that was put down on it; None if it was not.

    >>> out_of(np.array([0.0, 0, 0.01]), np.array([0.0, 0.03, 0.0]), 0.06).tolist()
    [0.0, 0.0, 0.06]
    >>> out_of(np.array([0.0, 0, 0.05]), np.array([0.0, 0.03, 0.0]), 0.06)
    """
    offset = here - cube
    offset[1] = 0.0
    distance = float(np.linalg.norm(offset))
    if distance > INSIDE_EDGES * edge or cube[1] > edge:
        return None
    out = offset / distance if distance > 1e-6 else np.array([0.0, 0.0, 1.0])
    return np.asarray(cube * [1.0, 0.0, 1.0] + edge * out)


def look_about(body: PosedBody, number: int) -> Point:
    """Return a point to look at, (3,) [m], the `number`-th of those around it."""
    placed = body.posed.table_from_character
    angle = LOOKS_RAD[number % len(LOOKS_RAD)]
    scale = float(placed[1, 1])
    ahead = (placed[:3, 2] * math.cos(angle) + placed[:3, 0] * math.sin(angle)) / scale
    return np.asarray(body.place + LOOK_M * ahead + [0.0, LOOK_HEIGHTS_M[number % 2], 0.0])


def in_front(body: PosedBody, left: float, up: float, ahead: float) -> Point:
    """Return a point before a character, (3,) [m], by shares of its height."""
    placed, tall = body.posed.table_from_character, body.character.height
    return np.asarray((placed @ [left * tall, up * tall, ahead * tall, 1.0])[:3])
