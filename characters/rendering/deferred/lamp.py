"""The key light as a lamp of some size at some distance, whose shadows are soft."""

from dataclasses import dataclass
from typing import Self

import numpy as np

from cubeling.characters.skeleton.pose import Array

LAMP_DISTANCE_M = 3.0
"""Distance of the lamp from the characters: a window or a ceiling light [m]."""

LAMP_WIDTH_M = 1.1
"""Width of the square lamp: from a desk it is about 20° across [m]."""

MIN_DROP_M = 0.1
"""Casters are at least so far below the lamp [m]."""

_SIGNS = np.array([(-1, -1), (-1, 1), (1, 1), (1, -1)])

CASTER_MARGIN = 0.02
"""Margin around the casters, as a share of their extent."""


@dataclass(frozen=True)
class Lamp:
    """A square lamp that looks at the characters.

    Its frame has the lamp as the origin and z towards the characters. Directions are tangents:
    x / z and y / z.
    """

    lamp_from_table: Array
    """(4, 4) [m]."""

    low: Array
    """Lowest tangents of what casts a shadow, (2,)."""

    high: Array
    """Highest tangents, (2,)."""

    nearest: float
    """Distance of the nearest caster along z [m]."""

    furthest: float
    """Distance of the furthest caster along z [m]."""

    width: float
    """Width of the lamp [m]."""

    @classmethod
    def over(
        cls,
        casters: Array,
        to_light: Array,
        distance: float = LAMP_DISTANCE_M,
        width: float = LAMP_WIDTH_M,
    ) -> Self:
        """Return the lamp in a direction (3,) over casters, points (n, 3) of the table frame [m].

        >>> lamp = Lamp.over(np.array([[-0.1, 0.0, 0.0], [0.1, 0.0, 0.0]]), np.array([0, 1.0, 0]))
        >>> (lamp.lamp_from_table @ [0.0, 0.5, 0.0, 1.0]).round(6).tolist()
        [0.0, 0.0, 2.5, 1.0]
        """
        middle = (casters.min(axis=0) + casters.max(axis=0)) / 2
        forward = -to_light / np.linalg.norm(to_light)
        across = np.eye(3)[np.abs(forward).argmin()]
        right = np.cross(across, forward)
        right /= np.linalg.norm(right)
        pose = np.eye(4)
        pose[:3, :3] = right, np.cross(forward, right), forward
        pose[:3, 3] = -pose[:3, :3] @ (middle - distance * forward)
        seen = casters @ pose[:3, :3].T + pose[:3, 3]
        depths = np.maximum(seen[:, 2], 1e-3 * distance)
        tangents = seen[:, :2] / depths[:, None]
        low, high = tangents.min(axis=0), tangents.max(axis=0)
        rim = CASTER_MARGIN * (high - low) + 1e-6
        return cls(pose, low - rim, high + rim, float(depths.min()), float(depths.max()), width)

    def shadow(self, casters: Array) -> Array:
        """Return lowest x and z, highest x and z of the shadow of casters on the table [m].

        Points (n, 3) of the table frame are projected from the corners of the lamp.

        >>> lamp = Lamp.over(np.array([[0.0, 0.3, 0.0]]), np.array([0, 1.0, 0]), 2.7, 0.9)
        >>> lamp.shadow(np.array([[0.0, 0.3, 0.0]])).round(6).tolist()
        [-0.05, -0.05, 0.05, 0.05]
        """
        table_from_lamp = np.linalg.inv(self.lamp_from_table)
        sides = 0.5 * self.width * table_from_lamp[:3, :2]
        corners = [table_from_lamp[:3, 3] + sides @ signs for signs in _SIGNS]
        ends = []
        for corner in corners:
            way = casters - corner
            share = corner[1] / np.maximum(corner[1] - np.maximum(casters[:, 1], 0.0), MIN_DROP_M)
            ends.append((corner + share[:, None] * way)[:, [0, 2]])
        reached = np.concatenate(ends)
        return np.concatenate([reached.min(axis=0), reached.max(axis=0)])

    @property
    def clip_from_table(self) -> Array:
        """Projection to a map of the tangents from `low` to `high`, (4, 4); depth is not kept."""
        scale = 2.0 / (self.high - self.low)
        clip = np.zeros((4, 4))
        clip[0, 0], clip[1, 1] = scale
        clip[:2, 2] = -scale * self.low - 1.0
        clip[3, 2] = 1.0
        return np.asarray(clip @ self.lamp_from_table)
