"""The bundled explorer's head under hair and features: the surface on which the face is drawn."""

from functools import cache

import numpy as np

from tools.authoring.modelling.sculpt import PaintCoat
from tools.authoring.modelling.shapes import Array, Difference, Ellipsoid, Shape, Union, linear_rgb
from tools.authoring.modelling.surface import normals_of

SKIN = linear_rgb("#f4b98c")
BLUSH = linear_rgb("#ea7560")
MAROON = linear_rgb("#5a1420")
EYE_WHITE = linear_rgb("#f6f4f2")

EYE_HOLLOW = Ellipsoid((0.085, 1.452, 0.185), (0.060, 0.077, 0.046), (0.0, 0.35, 0.0))
"""The volume cut out for the left eye."""

MOUTH_HOLLOW = Ellipsoid((0, 1.304, 0.18), (0.07, 0.036, 0.06))
"""The volume cut out for the mouth."""

_BONES = ("head",)


@cache
def bare_skull() -> Shape:
    """Return the face without nose, ears and hollows, on which lids and lips lie."""
    skull = Ellipsoid((0, 1.482, -0.006), (0.207, 0.199, 0.197), bones=_BONES, color=SKIN)
    jowls = Ellipsoid((0, 1.366, 0.037), (0.178, 0.122, 0.152), bones=_BONES, color=SKIN)
    return Union((skull, jowls), 0.09)


@cache
def skin_shape() -> Shape:
    """Return the head with nose and ears."""
    nose = Ellipsoid((0, 1.391, 0.206), (0.024, 0.0195, 0.023), bones=_BONES, color=SKIN)
    ear = Ellipsoid((0.209, 1.41, -0.012), (0.030, 0.052, 0.040), bones=_BONES, color=SKIN)
    return Union((Union((bare_skull(), nose), 0.022), ear, ear.mirrored()), 0.017)


def head_shape() -> Shape:
    """Return the head with nose and ears, and hollows for eyes and mouth."""
    hollows = Union((EYE_HOLLOW, EYE_HOLLOW.mirrored(), MOUTH_HOLLOW))
    return Difference(skin_shape(), hollows, 0.008)


def complexion() -> tuple[PaintCoat, ...]:
    """Return the red of the cheeks."""
    blush = Ellipsoid((0.125, 1.362, 0.15), (0.045, 0.03, 0.062))
    return (PaintCoat(Union((blush, blush.mirrored())), BLUSH, 0.035, 0.55),)


def lining() -> tuple[PaintCoat, ...]:
    """Return the colours of the hollows behind the eyes and the lips."""
    eyes = Union((EYE_HOLLOW, EYE_HOLLOW.mirrored()))
    return (PaintCoat(eyes, EYE_WHITE, 0.008), PaintCoat(MOUTH_HOLLOW, MAROON, 0.008))


def on_face(x: Array, y: Array) -> Array:
    """Return the points on the front of the bare face at x, y, (…, 3)."""
    x, y = np.broadcast_arrays(np.asarray(x, float), np.asarray(y, float))
    flat = np.stack([x.ravel(), y.ravel()], axis=-1)
    low, high = np.zeros(len(flat)), np.full(len(flat), 0.4)
    for _ in range(9):
        middle = (low + high) / 2
        inside = bare_skull().distance(np.column_stack([flat, middle])) < 0
        low, high = np.where(inside, middle, low), np.where(inside, high, middle)
    # Over the remaining millimetre the distance is nearly linear.
    inner, outer = (bare_skull().distance(np.column_stack([flat, z])) for z in (low, high))
    share = np.clip(-inner / np.maximum(outer - inner, 1e-9), 0.0, 1.0)
    low = low + (high - low) * share
    return np.asarray(np.column_stack([flat, low]).reshape(*x.shape, 3))


def face_normals(points: Array) -> Array:
    """Return the normals of the bare face at points (n, 3)."""
    return normals_of(bare_skull().distance, points, 0.02)


def skin_normals(points: Array) -> Array:
    """Return the normals of the head without hollows at points (n, 3).

    Pieces of skin that overlap have them where they meet, so that no line shows there.
    """
    return normals_of(skin_shape().distance, points, 0.02)
