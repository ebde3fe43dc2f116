"""Where a body may stand between obstacles: out of their way, and seen from a viewpoint."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.locomotion.obstacles import DIRECTIONS, STANDING, Obstacle, TableView

Array = NDArray[np.float64]

CROWDED_M = 1.0
"""What a way aside may be longer not to lead through another character [m]."""

BLOCKED_M, TURNED_M, BEHIND_M, BESIDE_M = 0.15, 0.02, 0.01, 0.06
"""What a way aside may be longer, not to end in another obstacle, not to turn back from the last
way, to lead to the viewer's side, and not to leave the picture [m]."""

HIDDEN_M, KEPT_M = 0.4, 0.03
"""What a way to another place may be longer, to be all seen there instead of not at all, and by how
much another must be better than the present one [m]."""

FRONT = 0.05
"""How much longer the way to a place may be for each metre that it is nearer to the viewer."""

RINGS_M = (0.03, 0.06, 0.09, 0.12, 0.16, 0.20)
"""How far away places are that are looked at [m]."""

MAX_HIDDEN_SHARE = 0.2
"""Share of a body that may be hidden at a better place."""

PLACE_ROOM_M = 0.012
"""Room that is kept to obstacles at a better place [m]."""

FEW_POINTS = 60
"""By how many points of a body it is told how much of it is hidden."""

DETOUR_M = 0.15
"""How far ahead it aims while it walks round something [m]; further than where a walker stops."""

BODY_M, WIDE_M = 0.033, 0.1
"""Half the width of a body [m]; an obstacle whose corners are further from its middle than the
second is not walked round [m]."""

WAY_SHARES = np.array([0.25, 0.5, 0.75, 1.0])
"""Where on a way it is looked for other characters, as shares of its length."""

_RINGS = np.concatenate([np.zeros((1, 2)), *(each * DIRECTIONS[:, ::2].T for each in RINGS_M)])
_ALONG = DIRECTIONS.T @ DIRECTIONS


@dataclass(frozen=True)
class WayOut:
    """How to get out of the way of what comes."""

    direction: Array
    """Over the table, (2,)."""

    distance: float
    """[m]."""

    within: float
    """In what time it must have begun at the latest: when the body would be touched [s]."""


def way_out(
    points: Array,
    obstacles: Sequence[Obstacle],
    times: Sequence[float],
    rooms: Sequence[float],
    view: TableView | None = None,
    last: Array | None = None,
    going: Array = STANDING,
) -> WayOut | None:
    """Return the best way out of what obstacles will sweep; None if they come no nearer.

    Parameters
    ----------
    points
        The body, (n, 3) in the table frame [m].
    obstacles, rooms
        What comes, and the room to be kept to each [m].
    times
        Moments from now on at which it is looked [s].
    view
        How the table is seen: the viewer's side is preferred.
    last
        Direction of the last way, (2,): it is preferred to others.
    going
        Velocity of the body over the table, (2,) [m/s].
    """
    needed = np.stack(
        [
            each.needed_moves(points, times, room, going)
            for each, room in zip(obstacles, rooms, strict=True)
        ]
    )
    touched = needed.min(axis=2) > 0.0
    if not touched.any():
        return None
    distances = needed[touched].max(axis=0)
    # Where each way ends it may be in another obstacle, or in the same one at another time.
    left = needed[:, -1][:, None, :] - distances[:, None] * _ALONG
    blocked = (left.min(axis=2) > 1e-9).any(axis=0)
    costs = distances + BLOCKED_M * blocked
    alive = [number for number, each in enumerate(obstacles) if each.alive]
    if alive:
        costs = costs + CROWDED_M * _through(needed[alive][:, [0, -1]], distances)
    if last is not None:
        costs = costs + TURNED_M * (1.0 - last @ DIRECTIONS)
    if view is not None:
        costs = costs + BEHIND_M * (1.0 - _toward(view, points) @ DIRECTIONS)
        moved = points[:, None, [0, 2]].mean(axis=0) + (distances * DIRECTIONS).T
        floor = np.insert(moved, 1, 0.0, axis=1)
        costs = costs + BESIDE_M * view.misses(floor, ())
    best = int(np.argmin(costs))
    first = int(np.argmax(touched.any(axis=0)))
    return WayOut(DIRECTIONS[:, best], float(distances[best]), float(times[first]))


def _through(needed: Array, distances: Array) -> NDArray[np.bool_]:
    """Return which ways lead through one of some bodies, (24,), now or at another time.

    `needed` are (bodies, times, 24) and `distances` of the ways (24,) [m].
    """
    left = needed[:, :, None, None, :] - WAY_SHARES[:, None, None] * distances[:, None] * _ALONG
    return np.asarray((left.min(axis=-1) > 1e-9).any(axis=(0, 1, 2)))


def hidden_share(points: Array, obstacles: Sequence[Obstacle], view: TableView) -> float:
    """Return how much of a body, points (n, 3), is not seen, 0…1."""
    return float(view.misses(_few(points), obstacles).mean())


def is_good(points: Array, obstacles: Sequence[Obstacle], view: TableView | None) -> bool:
    """Return whether a body, points (n, 3), is clear of obstacles and seen."""
    clear = all(
        float(each.needed_moves(points, (0.0,), PLACE_ROOM_M).min()) <= 0.0 for each in obstacles
    )
    return clear and (view is None or hidden_share(points, obstacles, view) <= MAX_HIDDEN_SHARE)


def better_place(
    points: Array,
    obstacles: Sequence[Obstacle],
    view: TableView | None,
    kept: Array = STANDING,
    straight: bool = False,
) -> Array | None:
    """Return the best way of a body to a place that is clear and seen, (2,) [m]; None for none.

    The way that is `kept` is only given up for one that is much better. With `straight`, nothing
    may be in the way there.
    """
    every = np.concatenate([kept[None], _RINGS])
    needed = np.stack([each.needed_moves(points, (0.0,), PLACE_ROOM_M)[0] for each in obstacles])

    def is_clear(ways: Array) -> NDArray[np.bool_]:
        left = needed[:, None, :] - ways @ DIRECTIONS
        return np.asarray((left.min(axis=2) <= 0.0).all(axis=0))

    good = is_clear(every)
    if straight:
        for share in (0.33, 0.66):
            good &= is_clear(share * every)
    ways = every[good]
    if view is None or not len(ways):
        return ways[0] if len(ways) else None
    moved = _few(points) + np.insert(ways, 1, 0.0, axis=1)[:, None]
    hidden = view.misses(moved, obstacles).mean(axis=1)
    costs = np.linalg.norm(ways, axis=1) - FRONT * (ways @ _toward(view, points))
    costs += HIDDEN_M * np.maximum(hidden - MAX_HIDDEN_SHARE, 0.0)
    costs -= KEPT_M * (ways == kept).all(axis=1)
    return np.asarray(ways[int(np.argmin(costs))])


def _few(points: Array) -> Array:
    return points[:: -(-len(points) // FEW_POINTS)]


def _toward(view: TableView, points: Array) -> Array:
    """Return the direction from a body to the viewer over the table, (2,)."""
    way = view.eye[[0, 2]] - points[:, [0, 2]].mean(axis=0)
    return np.asarray(way / max(float(np.linalg.norm(way)), 1e-9))


def detour(here: Array, target: Array, obstacle: Obstacle, tall: float) -> Array:
    """Return a target (x, z), or a point to pass first if an obstacle is on the way to it.

    `here` is (2,), and `tall` the height of the body [m]: what is above it is in nobody's way.

    >>> box = Obstacle(np.eye(4), np.full(3, 0.06), np.zeros(3))
    >>> detour(np.array([-0.3, 0]), np.array([-0.2, 0.0]), box, 0.2).tolist()
    [-0.2, 0.0]
    >>> bool(detour(np.array([-0.3, 0]), np.array([0.3, 0.1]), box, 0.2)[1] > 0.03)
    True
    """
    corners = obstacle.corners
    centre = obstacle.table_from_box[[0, 2], 3]
    radius = float(np.linalg.norm(corners[:, [0, 2]] - centre, axis=1).max())
    if radius > WIDE_M or corners[:, 1].min() > tall:
        return target
    avoided = radius + BODY_M
    if float(np.linalg.norm(target - centre)) < avoided:  # it goes to the obstacle itself
        return target
    return past_circle(here, target, centre, avoided)


def past_circle(here: Array, target: Array, centre: Array, radius: float) -> Array:
    """Return a target (x, z), or a point to pass first if a circle is on the way to it.

    All places are (x, z) on the table [m].
    """
    way, offset = target - here, centre - here
    length, distance = float(np.linalg.norm(way)), float(np.linalg.norm(offset))
    if min(length, distance) < 1e-6:
        return target
    along = float(offset @ way) / length
    aside = float(offset[0] * way[1] - offset[1] * way[0]) / length
    if not 0.0 < along < length or abs(aside) >= radius:
        return target
    # Along the tangent of the circle that it does not enter, on the side of the target.
    angle = math.copysign(math.asin(min(radius / distance, 1.0)), aside)
    sine, cosine = math.sin(angle), math.cos(angle)
    ahead = np.array([[cosine, -sine], [sine, cosine]]) @ offset / distance
    return np.asarray(here + DETOUR_M * ahead)
