"""Vleo's volumes from nose to tail, and its colours."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cache

import numpy as np

from tools.authoring.modelling.shapes import (
    Array,
    Difference,
    Ellipsoid,
    HalfSpace,
    RoundCone,
    Shape,
    Solid,
    Union,
    Vector,
    cone_chain,
    linear_rgb,
)
from tools.authoring.vleo.head import EyeSocket, MouthCavity, SymmetricShape, head_shape
from tools.authoring.vleo.rig import BACK, NECK, TAIL

TEAL, BACK_TEAL, SPOT = linear_rgb("#3fc4a4"), linear_rgb("#27a893"), linear_rgb("#14706f")
LASH = linear_rgb("#0d3f42")
CREAM, CLAW, ORANGE, PINK = (
    linear_rgb("#f5efc6"),
    linear_rgb("#fff3d6"),
    linear_rgb("#ffad45"),
    linear_rgb("#ff8a94"),
)
MAROON, ROSE = linear_rgb("#7a1428"), linear_rgb("#f2667c")

SPINE_PROFILE_M = np.array(  # height, forward and radius from the tip of the tail to the nape [m]
    [
        [0.124, -0.262, 0.0082],
        [0.101, -0.244, 0.0112],
        [0.083, -0.212, 0.0148],
        [0.077, -0.176, 0.0202],
        [0.081, -0.140, 0.0272],
        [0.091, -0.104, 0.0365],
        [0.102, -0.066, 0.0495],
        [0.107, -0.028, 0.0580],
        [0.111, 0.010, 0.0560],
        [0.121, 0.044, 0.0470],
        [0.142, 0.066, 0.0352],
        [0.168, 0.078, 0.0284],
        [0.194, 0.085, 0.0258],
        [0.225, 0.092, 0.0256],
    ]
)


@dataclass(frozen=True)
class BoundedShape(Solid):
    """A shape evaluated only near its bounding box, which is many times as fast."""

    shape: Shape
    """The shape in the box."""

    low: Vector
    """Minimum corner of the box [m]."""

    high: Vector
    """Maximum corner of the box [m]."""

    margin: float = 0.03
    """Distance from the box up to which the shape is evaluated; more than any fillet [m]."""

    def distance(self, points: Array) -> Array:
        """Return the distance to the shape, or to the box where it is far, (n,) [m]."""
        outside = np.maximum(np.maximum(self.low - points, points - self.high), 0.0)
        result: Array = np.sqrt(np.sum(outside * outside, axis=1))
        close = result < self.margin
        result[close] = self.shape.distance(points[close])
        return result

    def solids(self) -> Iterator[Solid]:
        """Yield the solids of the shape."""
        yield from self.shape.solids()

    def mirrored(self) -> "BoundedShape":
        """Return its mirror image."""
        low, high = (-self.high[0], *self.low[1:]), (-self.low[0], *self.high[1:])
        return replace(self, shape=self.shape.mirrored(), low=low, high=high)


def spine_line(count: int) -> Array:
    """Return evenly spaced points of the spine, (count, 4): x, y, z and radius [m]."""
    knots = np.linspace(0.0, 1.0, len(SPINE_PROFILE_M))
    fine = np.stack(
        [_spline(knots, column, np.linspace(0, 1, 400)) for column in SPINE_PROFILE_M.T], axis=1
    )
    steps = np.linalg.norm(np.diff(fine[:, :2], axis=0), axis=1)
    length = np.concatenate([[0.0], np.cumsum(steps)])
    even = np.linspace(0.0, length[-1], count)
    columns = [np.interp(even, length, column) for column in fine.T]
    return np.stack([np.zeros(count), *columns], axis=1)


def _spline(knots: Array, values: Array, at: Array) -> Array:
    """Return a Catmull-Rom curve through evenly spaced knots."""
    slope = np.gradient(values)
    place = at * (len(knots) - 1)
    i = np.minimum(place.astype(int), len(knots) - 2)
    u = place - i
    a, b = values[i], values[i + 1]
    curve: Array = (
        (2 * u**3 - 3 * u**2 + 1) * a
        + (u**3 - 2 * u**2 + u) * slope[i]
        + (3 * u**2 - 2 * u**3) * b
        + (u**3 - u**2) * slope[i + 1]
    )
    return curve


@cache
def body_shape() -> Shape:
    """Return the body with a closed mouth: trunk, neck, tail, legs and head."""
    line = spine_line(25)
    bones = (*TAIL, *BACK, *NECK)
    trunk = cone_chain(line[:, :3], tuple(line[:, 3]), ("",) * 24, TEAL)
    cones = [replace(cone, bones=bones) for cone in trunk.shapes if isinstance(cone, RoundCone)]
    pieces = tuple(_bounded_cones(cones[first : first + 4]) for first in range(0, len(cones), 4))
    paunch = Ellipsoid((0.0, 0.094, -0.012), (0.058, 0.048, 0.066), bones=("belly",))
    body = Union((Union(pieces), paunch), 0.02)
    ground = HalfSpace((0, 0.0005, 0), (0, 1, 0))
    legs = BoundedShape(
        Difference(Union((_leg("Front"), _leg("Hind"))), ground, 0.006),
        (0.0, 0.0, -0.09),
        (0.08, 0.13, 0.10),
    )
    face = BoundedShape(head_shape(), (-0.065, 0.19, 0.05), (0.065, 0.31, 0.195))
    return Union((body, SymmetricShape(legs), face), 0.024)


def _bounded_cones(cones: list[RoundCone]) -> BoundedShape:
    """Return cones in their bounding box."""
    ends = np.array([[cone.a, cone.b] for cone in cones]).reshape(-1, 3)
    reach = max(max(cone.ra, cone.rb) for cone in cones)
    low, high = (ends.min(axis=0) - reach).tolist(), (ends.max(axis=0) + reach).tolist()
    return BoundedShape(Union(tuple(cones)), (low[0], low[1], low[2]), (high[0], high[1], high[2]))


def _leg(which: str) -> Shape:
    """Return a left leg, a pillar on a round foot."""
    bones = (f"Left{which}UpperLeg", f"Left{which}LowerLeg")
    if which == "Front":
        line, radii = (
            [(0.036, 0.090, 0.052), (0.042, 0.053, 0.045), (0.043, 0.022, 0.055)],
            (28.5, 22.0, 19.0),
        )
        sole: Vector = (0.043, 0.012, 0.060)
    else:
        line, radii = (
            [(0.037, 0.089, -0.050), (0.044, 0.053, -0.040), (0.045, 0.022, -0.055)],
            (36.0, 24.5, 19.5),
        )
        sole = (0.045, 0.012, -0.048)
    pillar = cone_chain(np.array(line), tuple(r / 1000 for r in radii), bones, TEAL)
    foot = Ellipsoid(sole, (0.0275, 0.0170, 0.0305), bones=(f"Left{which}Foot",))
    return Union((pillar, foot), 0.009)


@cache
def skin_shape() -> Shape:
    """Return the body with hollows for eyes and mouth."""
    return Difference(
        Difference(body_shape(), MouthCavity(), 0.002), SymmetricShape(EyeSocket()), 0.001
    )
