"""The surface of a standing body, to keep the places of hands out of it."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

from cubeling.characters.ik.reaching.arms import scale_vector
from cubeling.characters.skeleton.scalar_quaternions import Vector, add, dot, length, subtract

_ROUNDS = 2


@dataclass(frozen=True)
class BodySurface:
    """Capsules in the character frame."""

    capsules: Sequence[tuple[Vector, Vector, float]]
    """Both ends of the axis of each, and its radius [m]."""

    clearance: float
    """How far from them a hand stays [m]."""

    @cached_property
    def _spheres(self) -> list[tuple[Vector, float]]:
        """A sphere about each capsule and its clearance: middle and squared radius [m, m²]."""
        spheres = []
        for start, end, radius in self.capsules:
            reach = 0.5 * length(subtract(end, start)) + radius + self.clearance
            spheres.append((scale_vector(add(start, end), 0.5), reach * reach))
        return spheres

    def outside(self, place: Vector) -> Vector:
        """Return a place; one in the body is moved out by the shortest way.

        A place on the very axis of a capsule is moved ahead.

        >>> BodySurface([((0, 0, 0), (0, 1, 0), 0.2)], 0.05).outside((0.1, 0.5, 0.0))
        (0.25, 0.5, 0.0)
        """
        for _ in range(_ROUNDS):  # out of one capsule may be into its neighbour
            before = place
            for capsule, (middle, square) in zip(self.capsules, self._spheres, strict=True):
                away = subtract(place, middle)
                if dot(away, away) < square:
                    start, end, radius = capsule
                    place = _push(place, start, end, radius + self.clearance)
            if place == before:
                break
        return place


def _push(place: Vector, start: Vector, end: Vector, radius: float) -> Vector:
    axis, offset = subtract(end, start), subtract(place, start)
    along = min(max(dot(offset, axis) / max(dot(axis, axis), 1e-12), 0.0), 1.0)
    nearest = add(start, scale_vector(axis, along))
    away = subtract(place, nearest)
    size = length(away)
    if size >= radius:
        return place
    if size < 1e-9:
        away, size = (0.0, 0.0, 1.0), 1.0
    return add(nearest, scale_vector(away, radius / size))
