"""The surface of a standing body, to keep the places of hands out of it."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from characters.skeleton.scalar_quaternions import Vector, dot, subtract

_ROUNDS = 2


@dataclass(frozen=True)
class BodySurface:
    """Capsules in the character frame."""

    capsules: Sequence[tuple[Vector, Vector, float]]
    """Both ends of the axis of each, and its radius [m]."""

    clearance: float
    """How far from them a hand stays [m]."""

    def outside(self, place: Vector) -> Vector:
        """Return a place; one in the body is moved out by the shortest way.

        A place on the very axis of a capsule is moved ahead.

        >>> BodySurface([((0, 0, 0), (0, 1, 0), 0.2)], 0.05).outside((0.1, 0.5, 0.0))
        (0.25, 0.5, 0.0)
        """
        for _ in range(_ROUNDS):  # out of one capsule may be into its neighbour
            before = place
            for start, end, radius in self.capsules:
                place = _pushed(place, start, end, radius + self.clearance)
            if place == before:
                break
        return place


def _pushed(place: Vector, start: Vector, end: Vector, radius: float) -> Vector:
    axis, offset = subtract(end, start), subtract(place, start)
    along = min(max(dot(offset, axis) / max(dot(axis, axis), 1e-12), 0.0), 1.0)
    x, y, z = (o - along * a for o, a in zip(offset, axis, strict=True))
    square = x * x + y * y + z * z
    if square >= radius * radius:
        return place
    size = math.sqrt(square)
    if size < 1e-9:
        (x, y, z), size = (0.0, 0.0, 1.0), 1.0
    scale = radius / size
    nearest = (s + along * a for s, a in zip(start, axis, strict=True))
    px, py, pz = nearest
    return px + x * scale, py + y * scale, pz + z * scale
