"""The key light as a lamp of some size at some distance, whose shadows are soft."""

from dataclasses import dataclass
from typing import Self

import numpy as np

from characters.skeleton.pose import Array

LAMP_DISTANCE_M = 3.0
"""Distance of the lamp from the characters: a window or a ceiling light [m]."""

LAMP_WIDTH_M = 1.1
"""Width of the square lamp: from a desk it is about 20° across [m]."""

MARGIN = 0.02
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
        rim = MARGIN * (high - low) + 1e-6
        return cls(pose, low - rim, high + rim, float(depths.min()), float(depths.max()), width)

    def spread(self, receivers: Array) -> float:
        """Return how much further than in parallel light a shadow reaches on receivers [m].

        Rays from the lamp spread by its width and by that of the casters. `receivers` are points
        (n, 3) of the table frame.
        """
        furthest = (
            float((receivers @ self.lamp_from_table[2, :3]).max()) + self.lamp_from_table[2, 3]
        )
        casters = float((self.high - self.low).max()) * self.furthest
        return float(
            max(furthest - self.nearest, 0.0) * (0.5 * self.width + casters) / self.nearest
        )

    @property
    def clip_from_table(self) -> Array:
        """Projection to a map of the tangents from `low` to `high`, (4, 4); depth is not kept."""
        scale = 2.0 / (self.high - self.low)
        clip = np.zeros((4, 4))
        clip[0, 0], clip[1, 1] = scale
        clip[:2, 2] = -scale * self.low - 1.0
        clip[3, 2] = 1.0
        return np.asarray(clip @ self.lamp_from_table)
