"""Vleo's body: one soft skin from nose to tail, finer where the face is."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
from numpy.typing import NDArray

from characters.authoring.sculpt import skin_weights
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
from characters.authoring.surface import normals_of, polygonise
from characters.authoring.vleo_rig import BACK, NECK, TAIL
from characters.pose import Skeleton

TEAL, BACK_TEAL, SPOT = rgb("#3fc4a4"), rgb("#27a893"), rgb("#14706f")
CREAM, CLAW, ORANGE, PINK = rgb("#f5efc6"), rgb("#fff3d6"), rgb("#ffad45"), rgb("#ff8a94")
MAROON, TONGUE = rgb("#7a1428"), rgb("#f2667c")

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
TRUNK_CELL, FACE_CELL = (0.0086, 0.0106, 0.0108), (0.0056, 0.0044, 0.0047)
"""Edges of a grid cell far from the mouth and about it, along x, y, z [m]."""
MOUTH_BOX = ((-0.044, 0.044), (0.192, 0.246), (0.134, 0.300))
"""Where the cells are small, along x, y, z [m]."""
CORNER_REACH = 0.018
"""How far a corner of the mouth pulls the skin about it [m]."""


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
        forward = np.clip((points[:, 2] - 0.134) / 0.055, 0, 1)
        middle = 1 - np.clip(np.abs(points[:, 0]) / 0.040, 0, 1) ** 2
        half = (0.0026 + 0.0056 * forward * middle) * np.where(height > 0, 0.45, 1.0)
        slot = -smooth_minimum(half - np.abs(height), points[:, 2] - self.corner, 0.004)
        hollow = Ellipsoid((0.0, 0.2180, 0.152), (0.026, 0.0085, 0.022)).distance(points)
        return smooth_minimum(slot, hollow, 0.006)

    def mirrored(self) -> "Smile":
        """Return itself."""
        return self


def lip_line(points: Array) -> Array:
    """Return the height between the lips above points (n, 3), (n,) [m]."""
    side, forward = points[:, 0], points[:, 2]
    return 0.2190 + 6.5 * side * side + 0.10 * np.maximum(0.0, 0.178 - forward)


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
    tongue = Ellipsoid((0.0, 0.2088, 0.159), (0.0135, 0.0042, 0.0190), bones=("jaw",))
    return Union((Cut(whole(), Smile(), 0.004), tongue), 0.004)


@dataclass(frozen=True)
class Body:
    """The skin as a mesh, in arrays."""

    points: Array
    """(n, 3) [m]."""

    normals: Array
    """(n, 3)."""

    triangles: NDArray[np.int64]
    """(m, 3)."""

    weights: Array
    """Of every joint, (n, joints)."""

    colors: Array
    """Linear RGB, (n, 3)."""


def body(bound: Skeleton) -> Body:
    """Return the skin with its weights and colours."""
    points, triangles = _surface()
    solids = list(skin().solids())
    distances = np.stack([solid.distance(points) for solid in solids], axis=1)
    weights = skin_weights(points, triangles, solids, distances, bound, 0.022)
    weights = _with_face(points, _with_firm_feet(points, weights, bound), bound)
    normals = normals_of(skin().distance, points, 0.003)
    return Body(points, normals, triangles, weights, _painted(points, normals))


def _surface() -> tuple[Array, NDArray[np.int64]]:
    """Return the mesh, its grid stretched so that the cells are small on the face."""
    spans = {0: (-0.09, 0.09), 1: (-0.012, 0.32), 2: (-0.285, 0.215)}
    lines = []
    for axis, (low, high) in spans.items():
        line = np.linspace(low, high, 2000)
        near_low, near_high = MOUTH_BOX[axis]
        small = _ease((line - near_low) / 0.02 + 1) * _ease((near_high - line) / 0.02 + 1)
        edge = TRUNK_CELL[axis] + (FACE_CELL[axis] - TRUNK_CELL[axis]) * small
        lines.append((line, np.concatenate([[0.0], np.cumsum(np.diff(line) / edge[1:])])))

    def unstretched(cells: Array) -> Array:
        columns = [np.interp(cells[:, i], lines[i][1], lines[i][0]) for i in range(3)]
        return np.stack(columns, axis=1)

    end = np.array([counted[-1] for _, counted in lines])
    points, triangles = polygonise(
        lambda cells: skin().distance(unstretched(cells)), np.zeros(3), end, 1.0
    )
    return unstretched(points), triangles


def _with_firm_feet(points: Array, weights: Array, bound: Skeleton) -> Array:
    """Return the weights with soles that belong to their feet alone, so that they do not slide."""
    sole = _ease((0.034 - points[:, 1]) / 0.020)[:, None]
    own = np.zeros_like(weights)
    front, left = points[:, 2] > 0.0, points[:, 0] > 0
    for which, is_front in (("Front", True), ("Hind", False)):
        for side, is_left in (("Left", True), ("Right", False)):
            mine = (front == is_front) & (left == is_left)
            own[mine, bound.index(f"{side}{which}Foot")] = 1.0
    return weights * (1 - sole) + own * sole


def jaw_share(points: Array) -> Array:
    """Return how much of the head's hold on points (n, 3) is the jaw's, (n,), 0…1."""
    below = lip_line(points) - points[:, 1]
    soft = 0.0012 + 0.7 * np.maximum(0.0, 0.1535 - points[:, 2])
    ahead = (points[:, 2] - 0.100 + 0.35 * (points[:, 1] - 0.2235)) / 0.035
    return _ease(0.5 + 0.5 * below / soft) * _ease(ahead)


def face_weights(points: Array, bound: Skeleton) -> Array:
    """Return how head, jaw and corners of the mouth share points of the face, (n, joints)."""
    weights, jaw = np.zeros((len(points), len(bound))), jaw_share(points)
    weights[:, bound.index("head")], weights[:, bound.index("jaw")] = 1 - jaw, jaw
    for name in ("LeftMouthCorner", "RightMouthCorner"):
        joint = bound.index(name)
        away = points - bound.rest.globals(bound)[joint, :3, 3]
        hold = 0.9 * np.exp(-np.sum(away * away, axis=1) / CORNER_REACH**2)
        weights *= 1 - hold[:, None]
        weights[:, joint] += hold
    return weights


def _with_face(points: Array, weights: Array, bound: Skeleton) -> Array:
    """Return the weights with the head's share divided among the joints of the face."""
    face = weights[:, bound.index("head")] + weights[:, bound.index("jaw")]
    weights = weights.copy()
    weights[:, [bound.index("head"), bound.index("jaw")]] = 0.0
    return weights + face[:, None] * face_weights(points, bound)


def _painted(points: Array, normals: Array) -> Array:
    """Return the colours: teal, darker above, cream below, and a red mouth."""
    colors = np.tile(TEAL, (len(points), 1))
    colors = _coat(colors, BACK_TEAL, 0.7 * _ease((normals[:, 1] - 0.1) / 0.8))
    legs = whole().solids()
    leg = np.min([s.distance(points) for s in legs if s.bones[0][-3:] in ("Leg", "oot")], axis=0)
    under = _ease((_underside(points) - 0.46) / 0.16) * _ease((0.208 - points[:, 1]) / 0.012)
    colors = _coat(colors, CREAM, under * _ease((leg - 0.001) / 0.009))
    chin = Ellipsoid((0.0, 0.200, 0.150), (0.052, 0.030, 0.046)).distance(points)
    lower = _ease((lip_line(points) - 0.003 - points[:, 1]) / 0.004)
    colors = _coat(colors, CREAM, lower * _ease(0.5 - chin / 0.012))
    inside = -np.maximum(whole().distance(points) + 0.0004, Smile().distance(points) - 0.0018)
    colors = _coat(colors, MAROON, _ease(0.5 + inside / 0.0012))
    tongue = Ellipsoid((0.0, 0.2088, 0.159), (0.0135, 0.0042, 0.0190)).distance(points)
    return _coat(colors, TONGUE, _ease(1 - tongue / 0.0012))


def _underside(points: Array) -> Array:
    """Return the cosine between the direction from the spine and straight under it, (n,)."""
    line = spine_line(60)[:, :3]
    along = np.gradient(line, axis=0)
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    nearest = np.argmin(np.linalg.norm(points[:, None] - line, axis=2), axis=1)
    out = points - line[nearest]
    down = np.stack([np.zeros(60), -along[:, 2], along[:, 1]], axis=1)[nearest]
    return np.asarray(np.sum(out * down, axis=1) / np.linalg.norm(out, axis=1))


def _coat(colors: Array, color: Vector, cover: Array) -> Array:
    return colors + (np.array(color) - colors) * cover[:, None]


def _ease(u: Array) -> Array:
    """Return a smooth step of u from 0 to 1."""
    u = np.clip(u, 0.0, 1.0)
    return u * u * (3 - 2 * u)
