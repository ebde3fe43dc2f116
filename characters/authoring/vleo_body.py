"""The clay of Vleo: its volumes from nose to tail, its open mouth, and its colours."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cache

import numpy as np

from characters.authoring.shapes import (
    Array,
    Cone,
    Cut,
    Ellipsoid,
    HalfSpace,
    Shape,
    Solid,
    Union,
    Vector,
    chain,
    rgb,
)
from characters.authoring.vleo_rig import BACK, EYE, NECK, TAIL

TEAL, BACK_TEAL, SPOT = rgb("#3fc4a4"), rgb("#27a893"), rgb("#14706f")
LASH = rgb("#0d3f42")
CREAM, CLAW, ORANGE, PINK = rgb("#f5efc6"), rgb("#fff3d6"), rgb("#ffad45"), rgb("#ff8a94")
MAROON, ROSE = rgb("#7a1428"), rgb("#f2667c")

EYE_RADIUS = 0.0255
"""Of an eyeball [m]."""
SIGHT = np.array([0.28, 0.09, 1.0]) / np.linalg.norm([0.28, 0.09, 1.0])
"""Where the left eye looks at rest."""
_LEFT = np.cross([0.0, 1.0, 0.0], SIGHT) / np.linalg.norm(np.cross([0.0, 1.0, 0.0], SIGHT))
EYE_AXES = np.stack([_LEFT, np.cross(SIGHT, _LEFT), SIGHT], axis=1)
"""Of the left eye: to its left, up and along its sight, as columns."""
OPENING = np.radians([46.0, 42.0, 38.0])
"""Of the lids, seen from the middle of the ball: half the width, up and down [rad]."""

SPINE = np.array(  # height, forward and radius from the tip of the tail to the nape [m]
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
class Mirrored(Solid):
    """A shape of the left half together with its image on the right, for the price of one."""

    left: Shape
    """The half at x > 0."""

    def distance(self, points: Array) -> Array:
        """Return the signed distance to the nearer of both, (n,) [m]."""
        return self.left.distance(np.abs(points) * [1, 0, 0] + points * [0, 1, 1])

    def solids(self) -> Iterator[Solid]:
        """Yield the solids of both sides."""
        yield from self.left.solids()
        yield from self.left.mirrored().solids()

    def mirrored(self) -> "Mirrored":
        """Return itself."""
        return self


@dataclass(frozen=True)
class Near(Solid):
    """A shape that is looked at closely only near the box that holds it: many times faster."""

    shape: Shape
    """What is in the box."""

    low: Vector
    """Its corner at the least of every coordinate [m]."""

    high: Vector
    """The opposite corner [m]."""

    margin: float = 0.03
    """How near is near; more than any fillet that the shape takes part in [m]."""

    def distance(self, points: Array) -> Array:
        """Return the distance to the shape, or to the box where that is far, (n,) [m]."""
        outside = np.maximum(np.maximum(self.low - points, points - self.high), 0.0)
        result: Array = np.sqrt(np.sum(outside * outside, axis=1))
        close = result < self.margin
        result[close] = self.shape.distance(points[close])
        return result

    def solids(self) -> Iterator[Solid]:
        """Yield what is in the box."""
        yield from self.shape.solids()

    def mirrored(self) -> "Near":
        """Return its image in the plane x = 0."""
        low, high = (-self.high[0], *self.low[1:]), (-self.low[0], *self.high[1:])
        return replace(self, shape=self.shape.mirrored(), low=low, high=high)


@dataclass(frozen=True)
class Hollow(Solid):
    """The room behind the mouth; its rim lies hidden under the skin about the lips."""

    def distance(self, points: Array) -> Array:
        """Return the signed distance, about, (n,) [m]."""
        side = around(points)
        height = points[:, 1] - lip_line(side)
        ahead = 1 - np.clip(np.abs(side) / 0.55, 0, 1) ** 2
        room = np.where(height > 0, 0.0042 + 0.0034 * ahead, 0.0086)
        up = room * (1 - np.clip(np.abs(side) / 0.86, 0, 1) ** 4)
        slot = np.maximum(np.abs(height) - up, 0.132 - points[:, 2])
        return np.asarray(slot)

    def mirrored(self) -> "Hollow":
        """Return itself."""
        return self


@dataclass(frozen=True)
class Socket(Solid):
    """What the left eyeball takes the place of: a cone from its middle, but for what is deep."""

    def distance(self, points: Array) -> Array:
        """Return the signed distance, about, (n,) [m]."""
        off = points - EYE
        away = np.maximum(np.linalg.norm(off, axis=1), 1e-6)
        wide = np.linalg.norm(eye_angles(off) / (1.16 * OPENING[:2]), axis=1)
        shell = np.maximum(0.94 * EYE_RADIUS - away, away - 1.15 * EYE_RADIUS)
        return np.asarray(np.maximum((wide - 1) * 0.8 * away, shell))

    def mirrored(self) -> "Socket":
        """Return itself: it is never drawn."""
        return self


def eye_angles(off: Array) -> Array:
    """Return how far to the left and up of its sight points (n, 3) from the left eye are [rad]."""
    x, y, z = (off @ EYE_AXES).T
    angle = np.arctan2(np.hypot(x, y), z)
    flat = np.maximum(np.hypot(x, y), 1e-9)
    return np.stack([x / flat * angle, y / flat * angle], axis=-1)


MIDDLE = 0.118
"""How far forward the upright through the head is from which its front is seen [m]."""


def around(points: Array) -> Array:
    """Return how far to the left of straight ahead points (n, 3) of the head are, (n,) [rad]."""
    return np.asarray(np.arctan2(points[:, 0], points[:, 2] - MIDDLE))


def lip_line(side: Array, smile: float = 0.0105, width: float = 0.70) -> Array:
    """Return the height between the closed lips, so far to the side [rad], (n,) [m].

    Parameters
    ----------
    smile : height of the corners above the middle [m]
    width : where the corners are [rad]
    """
    bent = np.minimum((side / width) ** 2, 1.0) + 0.8 * np.clip(np.abs(side) / width - 1, 0, 1)
    return np.asarray(0.2150 + smile * bent)


def spine_line(count: int) -> Array:
    """Return evenly spaced points of the spine, (count, 4): x, y, z and radius [m]."""
    knots = np.linspace(0.0, 1.0, len(SPINE))
    fine = np.stack([_spline(knots, column, np.linspace(0, 1, 400)) for column in SPINE.T], axis=1)
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
def whole() -> Shape:
    """Return the body with its mouth shut: trunk, neck, tail, legs and head."""
    line = spine_line(25)
    bones = (*TAIL, *BACK, *NECK)
    trunk = chain(line[:, :3], tuple(line[:, 3]), ("",) * 24, TEAL)
    cones = [replace(cone, bones=bones) for cone in trunk.shapes if isinstance(cone, Cone)]
    pieces = tuple(_near(cones[first : first + 4]) for first in range(0, len(cones), 4))
    paunch = Ellipsoid((0.0, 0.094, -0.012), (0.058, 0.048, 0.066), bones=("belly",))
    body = Union((Union(pieces), paunch), 0.02)
    ground = HalfSpace((0, 0.0005, 0), (0, 1, 0))
    legs = Near(
        Cut(Union((_leg("Front"), _leg("Hind"))), ground, 0.006),
        (0.0, 0.0, -0.09),
        (0.08, 0.13, 0.10),
    )
    face = Near(head(), (-0.065, 0.19, 0.05), (0.065, 0.31, 0.195))
    return Union((body, Mirrored(legs), face), 0.024)


def _near(cones: list[Cone]) -> Near:
    """Return cones in the box that holds them."""
    ends = np.array([[cone.a, cone.b] for cone in cones]).reshape(-1, 3)
    reach = max(max(cone.ra, cone.rb) for cone in cones)
    low, high = (ends.min(axis=0) - reach).tolist(), (ends.max(axis=0) + reach).tolist()
    return Near(Union(tuple(cones)), (low[0], low[1], low[2]), (high[0], high[1], high[2]))


def _leg(which: str) -> Shape:
    """Return a left leg, a stout little pillar on a round foot."""
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
    pillar = chain(np.array(line), tuple(r / 1000 for r in radii), bones, TEAL)
    foot = Ellipsoid(sole, (0.0275, 0.0170, 0.0305), bones=(f"Left{which}Foot",))
    return Union((pillar, foot), 0.009)


@cache
def head() -> Shape:
    """Return the head: a big skull, a soft snout, cheeks and two nostrils."""
    skull = Ellipsoid((0.0, 0.2530, 0.110), (0.0600, 0.0535, 0.0545), bones=("head",))
    snout = Ellipsoid((0.0, 0.2225, 0.149), (0.0400, 0.0275, 0.0395), bones=("head",))
    cheek = Ellipsoid((0.030, 0.2190, 0.138), (0.0225, 0.0215, 0.0225), bones=("head",))
    nostril = Ellipsoid((0.0125, 0.2385, 0.1800), (0.0075, 0.0065, 0.0075), bones=("head",))
    mound = Ellipsoid((EYE[0], EYE[1], EYE[2]), (1.01 * EYE_RADIUS,) * 3, bones=("head",))
    front = Union((Union((skull, snout), 0.018), Mirrored(cheek), Mirrored(nostril)), 0.014)
    return Union((front, Mirrored(mound)), 0.012)


@cache
def skin() -> Shape:
    """Return the body with room where eyes and mouth are put in."""
    return Cut(Cut(whole(), Hollow(), 0.002), Mirrored(Socket()), 0.001)
