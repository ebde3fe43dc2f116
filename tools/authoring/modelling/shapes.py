"""Rounded volumes as signed distance functions, with bones and colours.

Distances are negative inside. They are exact for cones, spheres and half-spaces, and elsewhere
only near the surface: the polygoniser projects every vertex onto the zero set.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cache
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]
Vector = tuple[float, float, float]

WHITE = (1.0, 1.0, 1.0)


def linear_rgb(code: str) -> Vector:
    """Return the linear RGB of an sRGB code such as ``"#ff8800"`` (IEC 61966-2-1).

    >>> linear_rgb("#ffffff")
    (1.0, 1.0, 1.0)
    """
    srgb = np.array([int(code[i : i + 2], 16) for i in (1, 3, 5)]) / 255.0
    linear = np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)
    r, g, b = linear.tolist()
    return r, g, b


def mirrored_name(name: str) -> str:
    """Return the name of a joint's mirror image.

    >>> [mirrored_name(name) for name in ("LeftArm", "RightFoot", "hips")]
    ['RightArm', 'LeftFoot', 'hips']
    """
    if name.startswith("Left"):
        return "Right" + name[4:]
    return "Left" + name[5:] if name.startswith("Right") else name


def _flip(point: Vector) -> Vector:
    return -point[0], point[1], point[2]


class Shape(Protocol):
    """A volume given by a signed distance function."""

    def distance(self, points: Array) -> Array:
        """Return the signed distance of points (n, 3) to the surface, (n,) [m]."""

    def solids(self) -> "Iterator[Solid]":
        """Yield its coloured volumes."""

    def mirrored(self) -> "Shape":
        """Return its mirror image in the plane x = 0, with the bones of the other side."""


@dataclass(frozen=True, kw_only=True)
class Solid:
    """Bones and colour of a single volume."""

    bones: tuple[str, ...] = ()
    """Joints that move it; each vertex belongs to the nearest."""

    color: Vector = WHITE
    """Linear RGB."""

    def distance(self, points: Array) -> Array:
        """Return the signed distance of points (n, 3), (n,) [m]."""
        raise TypeError(f"{type(self).__name__} has no surface; use one of its subclasses")

    def solids(self) -> "Iterator[Solid]":
        """Yield itself."""
        yield self

    def mirrored(self) -> "Shape":
        """Return its mirror image: itself for a symmetric shape."""
        return self

    def _other_bones(self) -> tuple[str, ...]:
        return tuple(mirrored_name(bone) for bone in self.bones)


@dataclass(frozen=True)
class RoundCone(Solid):
    """A round cone: the convex hull of two spheres; a capsule if the radii are equal."""

    a: Vector
    """Centre of one sphere [m]."""

    b: Vector
    """Centre of the other [m]."""

    ra: float
    """Radius at `a` [m]."""

    rb: float
    """Radius at `b` [m]."""

    squash: Vector = WHITE
    """Scale of the cross-section along x, y, z; (1, 1, 0.7) is flatter front to back."""

    def distance(self, points: Array) -> Array:
        """Return the signed distance (Quilez, "Round Cone"), (n,) [m]."""
        squash = np.array(self.squash)
        ba = (np.array(self.b) - self.a) / squash
        pa = (points - self.a) / squash
        l2 = max(float(ba @ ba), 1e-12)
        rr = self.ra - self.rb
        a2 = l2 - rr * rr
        if a2 <= 0:  # one sphere swallows the other
            center, radius = (0 * ba, self.ra) if rr > 0 else (ba, self.rb)
            return _scaled(np.linalg.norm(pa - center, axis=1) - radius, squash)
        y = pa @ ba
        z = y - l2
        x2 = np.sum((pa * l2 - ba * y[:, None]) ** 2, axis=1)
        y2, z2 = y * y * l2, z * z * l2
        k = np.sign(rr) * rr * rr * x2
        side = (np.sqrt(x2 * a2 / l2) + y * rr) / l2 - self.ra
        end_b = np.sqrt(x2 + z2) / l2 - self.rb
        end_a = np.sqrt(x2 + y2) / l2 - self.ra
        at_a = np.sign(y) * a2 * y2 < k
        result = np.where(np.sign(z) * a2 * z2 > k, end_b, np.where(at_a, end_a, side))
        return _scaled(result, squash)

    def mirrored(self) -> "RoundCone":
        """Return its mirror image."""
        return replace(self, a=_flip(self.a), b=_flip(self.b), bones=self._other_bones())


@dataclass(frozen=True)
class Ellipsoid(Solid):
    """A superellipsoid: an ellipsoid, or a rounded box."""

    center: Vector
    """Its centre [m]."""

    radii: Vector
    """Half its extent along its own axes [m]."""

    turn: Vector = (0.0, 0.0, 0.0)
    """Rotation about x, then y, then z of the character frame [rad]."""

    power: float = 2.0
    """Exponent: 2 ellipsoid, 3…6 increasingly boxy."""

    def distance(self, points: Array) -> Array:
        """Return the distance to first order: the implicit value over its slope, (n,) [m]."""
        local = (points - self.center) @ _axes(self.turn)  # transposed twice: into its own axes
        scaled = np.abs(local) / self.radii
        level = np.sum(scaled**self.power, axis=1) ** (1 / self.power)
        slope = scaled ** (self.power - 1) / self.radii
        steep = np.linalg.norm(slope, axis=1) / np.maximum(level, 1e-9) ** (self.power - 1)
        near = (level - 1.0) / np.maximum(steep, 1e-9)
        return np.where(level > 1e-6, near, -min(self.radii))

    def mirrored(self) -> "Ellipsoid":
        """Return its mirror image."""
        x, y, z = self.turn
        bones = self._other_bones()
        return replace(self, center=_flip(self.center), turn=(x, -y, -z), bones=bones)


@dataclass(frozen=True)
class HalfSpace(Solid):
    """Everything behind a plane."""

    point: Vector
    """A point on the plane [m]."""

    normal: Vector
    """Direction away from the inside; any length."""

    def distance(self, points: Array) -> Array:
        """Return the signed distance, (n,) [m]."""
        normal = np.array(self.normal) / np.linalg.norm(self.normal)
        return np.asarray((points - self.point) @ normal)

    def mirrored(self) -> "HalfSpace":
        """Return its mirror image."""
        bones = self._other_bones()
        return replace(self, point=_flip(self.point), normal=_flip(self.normal), bones=bones)


@dataclass(frozen=True)
class Union:
    """The smooth union of several shapes."""

    shapes: tuple[Shape, ...]
    """The shapes, in the order of joining."""

    blend: float = 0.0
    """Radius of the fillets between them [m]."""

    def distance(self, points: Array) -> Array:
        """Return the smooth minimum of the distances, (n,) [m]."""
        result = self.shapes[0].distance(points)
        for shape in self.shapes[1:]:
            result = smooth_minimum(result, shape.distance(points), self.blend)
        return result

    def solids(self) -> Iterator[Solid]:
        """Yield the volumes of all of them."""
        for shape in self.shapes:
            yield from shape.solids()

    def mirrored(self) -> "Union":
        """Return its mirror image."""
        return replace(self, shapes=tuple(shape.mirrored() for shape in self.shapes))


@dataclass(frozen=True)
class Difference:
    """The smooth difference of two shapes."""

    body: Shape
    """The shape to cut from."""

    tool: Shape
    """The volume to subtract; its bones and colours are ignored."""

    blend: float = 0.0
    """Radius of the rounded edge [m]."""

    def distance(self, points: Array) -> Array:
        """Return the smooth maximum of the body and the outside of the tool, (n,) [m]."""
        body, tool = self.body.distance(points), self.tool.distance(points)
        return -smooth_minimum(-body, tool, self.blend)

    def solids(self) -> Iterator[Solid]:
        """Yield the volumes of the body."""
        yield from self.body.solids()

    def mirrored(self) -> "Difference":
        """Return its mirror image."""
        return replace(self, body=self.body.mirrored(), tool=self.tool.mirrored())


def cone_chain(
    points: ArrayLike,
    radii: tuple[float, ...],
    bones: tuple[str, ...],
    color: Vector,
    blend: float = 0.0,
    squash: Vector = WHITE,
) -> Union:
    """Return a limb, neck or tail: round cones along a line, one bone each.

    Parameters
    ----------
    points : (n, 3) [m]
    radii : n radii [m]
    bones : n − 1 joints, one a cone
    """
    line = np.asarray(points, float).tolist()
    cones = [
        RoundCone(
            (a[0], a[1], a[2]), (b[0], b[1], b[2]), ra, rb, squash, bones=(bone,), color=color
        )
        for a, b, ra, rb, bone in zip(line, line[1:], radii, radii[1:], bones, strict=False)
    ]
    return Union(tuple(cones), blend)


def smooth_minimum(a: Array, b: Array, blend: float) -> Array:
    """Return the smooth minimum with radius `blend` (Quilez, quadratic polynomial)."""
    if blend <= 0:
        return np.minimum(a, b)
    h = np.maximum(blend - np.abs(a - b), 0.0) / blend
    return np.minimum(a, b) - h * h * blend / 4


def euler(turn: Vector) -> Array:
    """Return the rotation matrix about x, then y, then z, (3, 3)."""
    matrix = np.eye(3)
    for axis, angle in enumerate(turn):
        c, s = np.cos(angle), np.sin(angle)
        i, j = (axis + 1) % 3, (axis + 2) % 3
        step = np.eye(3)
        step[i, i], step[j, j], step[i, j], step[j, i] = c, c, -s, s
        matrix = step @ matrix
    return matrix


@cache
def _axes(turn: Vector) -> Array:
    """Return `euler`, cached for repeated distance queries."""
    matrix = euler(turn)
    matrix.setflags(write=False)
    return matrix


def _scaled(distance: Array, squash: Array) -> Array:
    return distance * float(squash.min())
