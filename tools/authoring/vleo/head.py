"""Vleo's head, and the hollows in it for eyes and mouth."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache

import numpy as np

from tools.authoring.modelling.shapes import Array, Ellipsoid, Shape, Solid, Union
from tools.authoring.vleo.rig import EYE_CENTRE_M

EYE_RADIUS_M = 0.0255
"""Of an eyeball [m]."""
REST_GAZE = np.array([0.28, 0.09, 1.0]) / np.linalg.norm([0.28, 0.09, 1.0])
"""Direction of the left eye's gaze at rest."""
_LEFT = np.cross([0.0, 1.0, 0.0], REST_GAZE) / np.linalg.norm(np.cross([0.0, 1.0, 0.0], REST_GAZE))
EYE_AXES = np.stack([_LEFT, np.cross(REST_GAZE, _LEFT), REST_GAZE], axis=1)
"""Axes of the left eye as columns: to its left, up and along its gaze."""
LID_OPENING_RAD = np.radians([46.0, 42.0, 38.0])
"""Half width, upward and downward extent of the lid opening, from the eyeball's centre [rad]."""


@dataclass(frozen=True)
class SymmetricShape(Solid):
    """A shape and its mirror image, at the cost of one evaluation."""

    left: Shape
    """The shape at x > 0."""

    def distance(self, points: Array) -> Array:
        """Return the signed distance to the nearer of the two, (n,) [m]."""
        return self.left.distance(np.abs(points) * [1, 0, 0] + points * [0, 1, 1])

    def solids(self) -> Iterator[Solid]:
        """Yield the solids of both sides."""
        yield from self.left.solids()
        yield from self.left.mirrored().solids()


@dataclass(frozen=True)
class MouthCavity(Solid):
    """The cavity behind the mouth; its rim is hidden under the skin around the lips."""

    def distance(self, points: Array) -> Array:
        """Return the approximate signed distance, (n,) [m]."""
        side = azimuth(points)
        height = points[:, 1] - lip_line(side)
        ahead = 1 - np.clip(np.abs(side) / 0.55, 0, 1) ** 2
        room = np.where(height > 0, 0.0042 + 0.0034 * ahead, 0.0086)
        up = room * (1 - np.clip(np.abs(side) / 0.86, 0, 1) ** 4)
        slot = np.maximum(np.abs(height) - up, 0.132 - points[:, 2])
        return np.asarray(slot)


@dataclass(frozen=True)
class EyeSocket(Solid):
    """The volume that the left eyeball replaces: a cone from its centre, without its depth."""

    def distance(self, points: Array) -> Array:
        """Return the approximate signed distance, (n,) [m]."""
        off = points - EYE_CENTRE_M
        away = np.maximum(np.linalg.norm(off, axis=1), 1e-6)
        wide = np.linalg.norm(eye_angles(off) / (1.16 * LID_OPENING_RAD[:2]), axis=1)
        shell = np.maximum(0.94 * EYE_RADIUS_M - away, away - 1.15 * EYE_RADIUS_M)
        return np.asarray(np.maximum((wide - 1) * 0.8 * away, shell))


def eye_angles(off: Array) -> Array:
    """Return the angles left and up of the gaze of points (n, 3) from the left eye [rad]."""
    x, y, z = (off @ EYE_AXES).T
    angle = np.arctan2(np.hypot(x, y), z)
    flat = np.maximum(np.hypot(x, y), 1e-9)
    return np.stack([x / flat * angle, y / flat * angle], axis=-1)


HEAD_AXIS_Z_M = 0.118
"""z of the vertical axis of the azimuths of the head [m]."""


def azimuth(points: Array) -> Array:
    """Return the azimuths of points (n, 3) of the head, left of straight ahead, (n,) [rad]."""
    return np.asarray(np.arctan2(points[:, 0], points[:, 2] - HEAD_AXIS_Z_M))


def lip_line(side: Array, smile: float = 0.0105, width: float = 0.70) -> Array:
    """Return the height of the line between the closed lips at azimuths [rad], (n,) [m].

    Parameters
    ----------
    smile : height of the corners above the middle [m]
    width : azimuth of the corners [rad]
    """
    bent = np.minimum((side / width) ** 2, 1.0) + 0.8 * np.clip(np.abs(side) / width - 1, 0, 1)
    return np.asarray(0.2150 + smile * bent)


@cache
def head_shape() -> Shape:
    """Return the head: a big skull, a soft snout, cheeks and two nostrils."""
    skull = Ellipsoid((0.0, 0.2530, 0.110), (0.0600, 0.0535, 0.0545), bones=("head",))
    snout = Ellipsoid((0.0, 0.2225, 0.149), (0.0400, 0.0275, 0.0395), bones=("head",))
    cheek = Ellipsoid((0.030, 0.2190, 0.138), (0.0225, 0.0215, 0.0225), bones=("head",))
    nostril = Ellipsoid((0.0125, 0.2385, 0.1800), (0.0075, 0.0065, 0.0075), bones=("head",))
    mound = Ellipsoid(
        (EYE_CENTRE_M[0], EYE_CENTRE_M[1], EYE_CENTRE_M[2]),
        (1.01 * EYE_RADIUS_M,) * 3,
        bones=("head",),
    )
    front = Union(
        (Union((skull, snout), 0.018), SymmetricShape(cheek), SymmetricShape(nostril)), 0.014
    )
    return Union((front, SymmetricShape(mound)), 0.012)
