"""Light on the benchmark's cube: a lamp, a sky, and edges of shadow, all in linear units."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

UP = np.array([0.0, -0.82, -0.57])
"""Where the sky is, in the camera frame: the camera looks down on a table."""


@dataclass(frozen=True, eq=False)
class Shadow:
    """A straight edge between the lamp and the cube."""

    plane: NDArray[np.float64]
    """Plane of the edge and the lamp: n · x + d, (4,), in the camera frame, negative in shadow."""

    softness: float
    """Width of the penumbra [m]."""

    depth: float
    """Share of the lamp's light that is lost in the shadow, 0…1."""

    def lit(self, side: NDArray[np.float32]) -> NDArray[np.float32]:
        """Share of the lamp's light at signed distances `side` from the plane [m]."""
        s = np.clip(side * np.float32(1 / self.softness) + np.float32(0.5), 0, 1)
        return np.asarray(1 - self.depth * (1 - s * s * (3 - 2 * s)), np.float32)


@dataclass(frozen=True, eq=False)
class Light:
    """What falls on a surface: 0.9 to 1 on one that looks into the lamp."""

    lamp: NDArray[np.float64]
    """Unit direction to the lamp, in the camera frame, (3,)."""

    power: float = 0.62
    """Light of the lamp on a surface that looks at it."""

    sky: float = 0.30
    """Light of the sky on a surface that looks at it; half of it on one that stands upright."""

    bounce: float = 0.10
    """Light from everywhere."""

    slope: NDArray[np.float64] | None = None
    """How all light grows along the camera's axes [1/m], (3,), from 1 at `PIVOT`; even if None."""

    shadows: tuple[Shadow, ...] = ()
    """Edges of shadow, one after another."""

    def even(self, normal: NDArray[np.float64]) -> tuple[float, float]:
        """Light of the lamp, and all other light, on a surface with `normal`, without shadows."""
        lamp = self.power * max(0.0, float(normal @ self.lamp))
        return lamp, self.bounce + self.sky * (0.5 + 0.5 * float(normal @ UP))

    @property
    def is_even(self) -> bool:
        """Whether the light is the same all over a flat surface."""
        return self.slope is None and not self.shadows

    def on(
        self, normal: NDArray[np.float64], place: NDArray[np.float64], grid: NDArray[np.float32]
    ) -> NDArray[np.float32]:
        """Light at points of a plane, (...).

        Parameters
        ----------
        normal
            Normal of the surface in the camera frame, (3,).
        place
            Point in the camera frame [m] of (column, row, 1), (3, 3).
        grid
            Columns and rows of the points, (..., 2).
        """
        lamp, rest = self.even(normal)
        falling = np.full(grid.shape[:-1], lamp, np.float32)
        for shadow in self.shadows:
            a, b, c = shadow.plane[:3] @ place + np.array([0, 0, shadow.plane[3]])
            side = grid[..., 0] * np.float32(a) + grid[..., 1] * np.float32(b) + np.float32(c)
            falling *= shadow.lit(side)
        falling += np.float32(rest)
        if self.slope is not None:
            a, b, c = self.slope @ place + np.array([0, 0, 1 - self.slope @ SLOPE_ORIGIN_M])
            more = grid[..., 0] * np.float32(a) + grid[..., 1] * np.float32(b) + np.float32(c)
            falling *= np.maximum(more, np.float32(0.1))
        return falling


SLOPE_ORIGIN_M = np.array([0.0, 0.0, 0.5])
"""Where a sloping light is as strong as an even one, in the camera frame [m]."""


def random_lamp(random: np.random.Generator) -> Light:
    """Draw a lamp above and behind the camera."""
    towards = np.array([-0.45, -0.7, -0.75]) + random.uniform(-0.3, 0.3, 3)
    return Light(towards / np.linalg.norm(towards))


def with_shadows(light: Light, place: NDArray[np.float64], random: np.random.Generator) -> Light:
    """Let one hard and one soft edge of shadow fall near `place` (3,) [m], on a slope of light."""
    shadows = []
    for softness, depth in ((0.002, 0.85), (0.035, 0.6)):
        edge = np.array([np.cos(a := random.uniform(0, np.pi)), np.sin(a), random.normal(0, 0.3)])
        normal = np.cross(light.lamp, edge)
        normal /= np.linalg.norm(normal)
        near = place + random.uniform(-0.012, 0.012, 3)
        shadows.append(Shadow(np.append(normal, -normal @ near), softness, depth))
    return replace(
        light, power=1.0, sky=0.2, slope=random.uniform(-1.2, 1.2, 3), shadows=tuple(shadows)
    )
