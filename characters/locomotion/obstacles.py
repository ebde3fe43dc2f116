"""What a character keeps out of: boxes that move, where they are from above, what they hide."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_ANGLES = np.linspace(0.0, 2.0 * np.pi, 24, endpoint=False)

DIRECTIONS = np.stack([np.sin(_ANGLES), np.cos(_ANGLES)])
"""Directions over the table in which bodies are kept apart, (2, 24): x and z of unit vectors."""

STANDING = np.zeros(2)
"""The velocity of a body that stands [m/s]."""

STILL_M_S = 0.02
"""Speed up to which an obstacle is at rest [m/s]."""

OWN_S = 0.12
"""How far ahead it is looked where a body itself goes [s]."""

_SIGNS = (np.arange(8)[:, None] >> np.arange(3) & 1) - 0.5


@dataclass(frozen=True)
class Obstacle:
    """A box on or above the table that a character keeps out of."""

    table_from_box: Array
    """Its pose, (4, 4) [m]; the origin is its centre."""

    size: Array
    """Lengths of its edges, (3,) [m]."""

    velocity: Array
    """Velocity of its centre, (3,) in the table frame [m/s]."""

    alive: bool = False
    """Whether it is another character, through which no way out leads."""

    @property
    def corners(self) -> Array:
        """Its corners, (8, 3) in the table frame [m]."""
        pose = self.table_from_box
        corners: Array = (_SIGNS * self.size) @ pose[:3, :3].T + pose[:3, 3]
        return corners

    @property
    def moves(self) -> bool:
        """Whether it moves, more than a tracker's noise."""
        return float(np.linalg.norm(self.velocity)) > STILL_M_S

    def holds(self, points: Array) -> bool:
        """Return whether any of points, (n, 3), is in it."""
        pose = self.table_from_box
        inside = np.abs((points - pose[:3, 3]) @ pose[:3, :3]) < self.size / 2
        return bool(inside.all(axis=1).any())

    def distance(self, place: Array) -> float:
        """Return how far a place (x, z) is from it over the table [m]; 0 above or below it."""
        pose = self.table_from_box
        offset = np.array([place[0], pose[1, 3], place[1]]) - pose[:3, 3]
        inside = np.abs(offset @ pose[:3, :3]) - self.size / 2
        return float(np.linalg.norm(np.maximum(inside, 0.0)))

    def hides(self, points: Array, eye: Array) -> NDArray[np.bool_]:
        """Return which points, (…, 3), are in it or behind it as seen from an eye, (3,).

        >>> box = Obstacle(np.eye(4), np.full(3, 2.0), np.zeros(3))
        >>> points = np.array([[-3.0, 0.5, 0.0], [0.0, 0.0, 0.0], [3.0, 0.5, 0.0]])
        >>> box.hides(points, np.array([9.0, 0.0, 0.0])).tolist()
        [True, True, False]
        """
        pose = self.table_from_box
        start, way = (eye - pose[:3, 3]) @ pose[:3, :3], (points - eye) @ pose[:3, :3]
        way = np.where(np.abs(way) < 1e-12, 1e-12, way)
        one, other = (-self.size / 2 - start) / way, (self.size / 2 - start) / way
        first, last = np.minimum(one, other).max(axis=-1), np.maximum(one, other).min(axis=-1)
        return np.asarray((first < last) & (first < 1.0) & (last > 0.0))

    def needed_moves(
        self, points: Array, times: Sequence[float], room: float, going: Array = STANDING
    ) -> Array:
        """Return how far a body must move to be apart from it at some times, (times, 24) [m].

        There is a value for each of `DIRECTIONS`; the least of a time is what the body must move at
        least. −inf where nothing of the body is at the height of the box.

        Parameters
        ----------
        points
            Points whose hulls are the body, (n, 3) in the table frame [m].
        times
            From now on [s]; the box goes on as it does now.
        room
            Distance that is kept [m].
        going
            Velocity of the body over the table, (2,) [m/s]. It stops before what it goes to, so it
            is looked ahead for `OWN_S` only.
        """
        corners = self.corners
        along = points[:, [0, 2]] @ DIRECTIONS
        reach = (corners[:, [0, 2]] @ DIRECTIONS).max(axis=0)
        drift, own = self.velocity[[0, 2]] @ DIRECTIONS, going @ DIRECTIONS
        low, high = float(corners[:, 1].min()), float(corners[:, 1].max())
        found = np.full((len(times), DIRECTIONS.shape[1]), -np.inf)
        for row, time in enumerate(times):
            rise = float(self.velocity[1]) * time
            level = (points[:, 1] > low + rise - room) & (points[:, 1] < high + rise + room)
            if level.any():
                found[row] = (
                    room + reach + drift * time - own * min(time, OWN_S) - along[level].min(axis=0)
                )
        return found


@dataclass(frozen=True)
class TableView:
    """From where and how far the table is seen."""

    eye: Array
    """Where the camera is, (3,) in the table frame [m]."""

    edges: Array
    """Planes through it along the edges of the picture, (n, 4): what is seen has no negative
    product with any of them, as (x, y, z, 1)."""

    def misses(self, points: Array, obstacles: Sequence[Obstacle]) -> NDArray[np.bool_]:
        """Return which points, (…, 3), are beside the picture or hidden by an obstacle."""
        beside = (points @ self.edges[:, :3].T + self.edges[:, 3] < 0.0).any(axis=-1)
        for each in obstacles:
            beside |= each.hides(points, self.eye)
        return np.asarray(beside)
