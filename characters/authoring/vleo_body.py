"""The clay of Vleo: its volumes from nose to tail, its open mouth, and its colours."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
from numpy.typing import NDArray

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
    smooth_minimum,
)
from characters.authoring.vleo_rig import BACK, NECK, TAIL

TEAL, BACK_TEAL, SPOT = rgb("#3fc4a4"), rgb("#27a893"), rgb("#14706f")
LASH = rgb("#0d3f42")
CREAM, CLAW, ORANGE, PINK = rgb("#f5efc6"), rgb("#fff3d6"), rgb("#ffad45"), rgb("#ff8a94")
MAROON, ROSE = rgb("#7a1428"), rgb("#f2667c")

SPINE = np.array(  # height, forward and radius from the tip of the tail to the nape [m]
    [
        [0.122, -0.262, 0.0070],
        [0.100, -0.243, 0.0108],
        [0.083, -0.212, 0.0148],
        [0.077, -0.176, 0.0202],
        [0.081, -0.140, 0.0272],
        [0.091, -0.104, 0.0365],
        [0.102, -0.066, 0.0495],
        [0.107, -0.028, 0.0580],
        [0.111, 0.010, 0.0560],
        [0.121, 0.044, 0.0470],
        [0.142, 0.066, 0.0368],
        [0.168, 0.078, 0.0303],
        [0.194, 0.085, 0.0278],
        [0.225, 0.092, 0.0268],
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
class Smile(Solid):
    """The cavity of the mouth: a wedge between the lips that rises to its corners."""

    corner: float = 0.1480
    """How far forward its corners are [m]."""

    def distance(self, points: Array) -> Array:
        """Return the signed distance, about, (n,) [m]."""
        height = points[:, 1] - lip_line(points)
        room = lip_gap(points, height > 0) - np.abs(height)
        slot = -smooth_minimum(room, points[:, 2] - self.corner, 0.004)
        hollow = Ellipsoid((0.0, 0.2180, 0.152), (0.026, 0.0085, 0.022)).distance(points)
        return smooth_minimum(slot, hollow, 0.006)

    def mirrored(self) -> "Smile":
        """Return itself."""
        return self


def lip_line(points: Array) -> Array:
    """Return the height between the lips above points (n, 3), (n,) [m]."""
    side, forward = points[:, 0], points[:, 2]
    return 0.2190 + 6.5 * side * side + 0.10 * np.maximum(0.0, 0.178 - forward)


def lip_gap(points: Array, upper: bool | NDArray[np.bool_]) -> Array:
    """Return how far the upper or the lower lip is from the line between them, (n,) [m]."""
    forward = np.clip((points[:, 2] - 0.134) / 0.055, 0, 1)
    middle = 1 - np.clip(np.abs(points[:, 0]) / 0.040, 0, 1) ** 2
    return np.asarray((0.0026 + 0.0056 * forward * middle) * np.where(upper, 0.45, 1.0))


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


TONGUE = Ellipsoid((0.0, 0.2088, 0.159), (0.0135, 0.0042, 0.0190), bones=("jaw",))
"""Lies in the mouth."""


@cache
def whole() -> Shape:
    """Return the body with its mouth shut: trunk, neck, tail, legs and head."""
    line = spine_line(25)
    bones = (*TAIL, *BACK, *NECK)
    trunk = chain(line[:, :3], tuple(line[:, 3]), ("",) * 24, TEAL)
    cones = (replace(cone, bones=bones) for cone in trunk.shapes if isinstance(cone, Cone))
    paunch = Ellipsoid((0.0, 0.094, -0.012), (0.058, 0.048, 0.066), bones=("belly",))
    body = Union((Union(tuple(cones)), paunch), 0.02)
    legs = Cut(Union((_leg("Front"), _leg("Hind"))), HalfSpace((0, 0.0005, 0), (0, 1, 0)), 0.006)
    return Union((body, Mirrored(legs), _head()), 0.024)


def _leg(which: str) -> Shape:
    """Return a left leg, a stout little pillar on a round foot."""
    bones = (f"Left{which}UpperLeg", f"Left{which}LowerLeg")
    if which == "Front":
        line, radii = (
            [(0.036, 0.090, 0.052), (0.041, 0.050, 0.050), (0.043, 0.02, 0.055)],
            (27, 23.5, 21.5),
        )
        sole: Vector = (0.043, 0.012, 0.060)
    else:
        line, radii = (
            [(0.036, 0.090, -0.050), (0.043, 0.052, -0.044), (0.045, 0.02, -0.054)],
            (34, 26.5, 22.5),
        )
        sole = (0.045, 0.012, -0.048)
    pillar = chain(np.array(line), tuple(r / 1000 for r in radii), bones, TEAL)
    foot = Ellipsoid(sole, (0.026, 0.0175, 0.0295), bones=(f"Left{which}Foot",))
    return Union((pillar, foot), 0.012)


def _head() -> Shape:
    """Return the head: a big skull, a soft snout, cheeks and two nostrils."""
    skull = Ellipsoid((0.0, 0.248, 0.112), (0.0590, 0.0525, 0.0540), bones=("head",))
    snout = Ellipsoid((0.0, 0.2265, 0.151), (0.0420, 0.0310, 0.0400), bones=("head",))
    cheek = Ellipsoid((0.030, 0.221, 0.142), (0.0225, 0.0225, 0.0225), bones=("head",))
    nostril = Ellipsoid((0.0125, 0.2445, 0.1840), (0.0075, 0.0075, 0.0075), bones=("head",))
    return Union((Union((skull, snout), 0.030), Mirrored(cheek), Mirrored(nostril)), 0.015)


@cache
def skin() -> Shape:
    """Return the body with its mouth open, and a tongue in it."""
    return Union((Cut(whole(), Smile(), 0.004), TONGUE), 0.004)
