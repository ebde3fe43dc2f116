"""Building blocks of the robot: cups, panels, servo caps and lamps, and their colours."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from cubeling.characters.model.mesh import Mesh
from cubeling.characters.skeleton.pose import Skeleton
from tools.authoring.modelling.lathe import frame_toward, lathe
from tools.authoring.modelling.meshes import bound_mesh
from tools.authoring.modelling.shapes import Array, Shape, Solid, Vector, linear_rgb
from tools.authoring.modelling.surface import normals_of, project

SHELL, PANEL, TRIM = linear_rgb("#f3efe6"), linear_rgb("#6d84c4"), linear_rgb("#4a5f9e")
RUBBER, GLASS, STEEL = linear_rgb("#272d3d"), linear_rgb("#3d4454"), linear_rgb("#aab2c2")
MAROON, ROSE = linear_rgb("#5d1830"), linear_rgb("#ef7d8e")
_PANEL_CORNERS = 22
"""Corners of a plate."""


@dataclass(frozen=True)
class Complement(Solid):
    """The complement of a shape; subtracting it keeps the inside of the shape."""

    shape: Shape
    """The shape."""

    def distance(self, points: Array) -> Array:
        """Return the signed distance, (n,) [m]."""
        return -self.shape.distance(points)

    def solids(self) -> Iterator[Solid]:
        """Yield nothing: it is only subtracted."""
        return iter(())

    def mirrored(self) -> "Complement":
        """Return its mirror image."""
        return Complement(self.shape.mirrored())


def cup(
    a: Sequence[float] | Array,
    b: Sequence[float] | Array,
    radii: tuple[float, float],
    color: Vector,
    joint: str,
    bound: Skeleton,
    segments: int = 16,
    dome: bool = False,
) -> Mesh:
    """Return a rigid link of a limb from a to b with rounded rims.

    With `dome` it ends at b in a hemisphere.
    """
    start, end = np.asarray(a, float), np.asarray(b, float)
    length, bevel = float(np.linalg.norm(end - start)), 0.0026
    low, high = radii
    middle = 0.5 * (low + high) + 0.0008
    profile = [[0, 0], [low - bevel, 0], [low, bevel], [middle, length / 2]]
    profile += [[high, length - bevel], [high - bevel, length], [0, length]]
    if dome:
        profile[4:] = [[high, length], [0.78 * high, length + 0.7 * high], [0, length + high]]
    place = frame_toward(end - start, start)
    return lathe(np.array(profile), [color] * 6, place, joint, bound, segments)


def panel(
    shape: Shape,
    place: Array,
    half: tuple[float, float],
    color: Vector,
    joint: str,
    bound: Skeleton,
    lift: float = 0.0018,
) -> Mesh:
    """Return a raised plate with rounded corners and a crisp seam on a shape.

    Parameters
    ----------
    shape : the shape under it
    place : (4, 4), the frame of its centre, +z outward, +y along the shape
    half : half its extent along x and y [m]
    color : linear RGB
    joint : the joint that moves it
    bound : the skeleton
    lift : height above the shape [m]
    """
    angle = np.linspace(0, 2 * np.pi, _PANEL_CORNERS, endpoint=False)
    round_ = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    square = round_ / np.sum(np.abs(round_) ** 3.4, axis=1, keepdims=True) ** (1 / 3.4)
    rings = np.array([[0.0, 1], [0.33, 1], [0.66, 1], [0.95, 1], [1.0, 0.6], [1.02, -1.2]])
    flat = (rings[:, :1, None] * square * half).reshape(-1, 2)
    near = place[:3, 3] + flat @ place[:3, :2].T
    points = project(shape.distance, near, 0.05, 10)
    normals = normals_of(shape.distance, points, 0.004)
    out = points + lift * np.repeat(rings[:, 1], _PANEL_CORNERS)[:, None] * normals
    edge = np.repeat([0.0, 0.0, 0.0, 0.5, 1.6, 1.6], _PANEL_CORNERS)[:, None]
    leaning = normals + edge * np.tile(square @ place[:3, :2].T, (len(rings), 1))
    leaning /= np.linalg.norm(leaning, axis=1, keepdims=True)
    bones = np.zeros((len(out), len(bound)))
    bones[:, bound.index(joint)] = 1.0
    paint = np.tile(np.array(color), (len(out), 1))
    paint[-2 * _PANEL_CORNERS :] = RUBBER  # the seam
    i = np.arange(_PANEL_CORNERS)
    j = (i + 1) % _PANEL_CORNERS
    quads = np.stack(
        [i, i + _PANEL_CORNERS, j + _PANEL_CORNERS, i, j + _PANEL_CORNERS, j], axis=1
    ).reshape(-1, 3)
    triangles = np.concatenate([quads + _PANEL_CORNERS * ring for ring in range(len(rings) - 1)])
    return bound_mesh(out, leaning, triangles, bones, paint, bound)


def servo_cap(
    place: Array, radius: float, joint: str, bound: Skeleton, face: Vector = STEEL
) -> Mesh:
    """Return the cap of a servo, a plate with a screw in a dark ring, facing +z."""
    profile = np.array([[0, -8], [10, -8], [10, 2.2], [7.6, 2.6], [7.6, 2.2], [2.4, 2.2], [0, 1.2]])
    scaled = profile * [radius / 10, 1.0] * [1.0, 1e-3]
    return lathe(scaled, [RUBBER, RUBBER, RUBBER, face, face, RUBBER], place, joint, bound, 16)


def socket(place: Array, radius: float, joint: str, bound: Skeleton) -> Mesh:
    """Return the dark ring and the dull glass of an unlit lamp, facing +z."""
    ring = [[0, -6], [12, -6], [12, 1.4], [10.6, 2.6], [9.2, 1.6]]
    glass = [[7.6, 2.0], [4.6, 2.8], [0, 3.2]]
    profile = np.array(ring + glass) * [radius / 12, 1.0] * [1.0, 1e-3]
    return lathe(profile, [RUBBER] * 4 + [GLASS] * 3, place, joint, bound, 20)


def lens(place: Array, radius: float, color: Vector, joint: str, bound: Skeleton) -> Mesh:
    """Return the domed glass of a lit lamp with a bright centre, facing +z."""
    profile = np.array([[0, 0], [9.5, 1.2], [6.6, 4.0], [3.6, 5.0], [0, 5.3]])
    scaled = profile * [radius / 12, 1.0] * [1.0, 1e-3]
    core = tuple(np.clip(0.16 + 0.95 * np.array(color), 0, 1).tolist())
    bright = (core[0], core[1], core[2])
    return lathe(scaled, [color, color, bright, bright], place, joint, bound, 20)
