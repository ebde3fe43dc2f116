"""The bundled explorer's face map: texture coordinates of its skin, wrinkle layers, and blood.

The map is a cylinder around the head, cut at the back: across is the direction from the middle of
the head, down is the height. Wrinkles are sums of Gaussian grooves along curves, with bulges of the
skin between them, drawn from anatomy: they run across the pull of the muscle (Duchenne 1862; Ekman
and Friesen 1978). Their places are those of the face's own brows, eyes, nose and mouth.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from cubeling.characters.model.face_maps import BLOOD_NAME, LAYER_NAMES, SUFFIX
from cubeling.characters.model.mesh import Mesh
from tools.authoring.human.skull import on_face
from tools.authoring.modelling.curves import smoothstep
from tools.authoring.modelling.shapes import Array

MAP_SIZE_PX = (640, 320)
"""Width and height of the pictures [px]: about 1.3 mm of the head a pixel."""

MAP_RANGE_RAD = np.deg2rad(120.0)
"""Directions to both sides that the map has; what is further back is skin under hair."""

MAP_BOTTOM_M, MAP_TOP_M = 1.24, 1.66
"""Heights that the map has [m]."""

MAX_REACH = 6.0
"""Distance from its line up to which a groove is drawn, in its widths; its bulges end there."""

SEED = 2013
"""Of the small irregularities of the lines."""


@dataclass(frozen=True)
class Groove:
    """A line in the skin: a narrow groove between two low bulges."""

    line: tuple[tuple[float, float], ...]
    """Points x, y on the face, from the front [m]; a smooth curve leads along them."""

    width: float = 0.0042
    """Standard deviation of the groove [m]."""

    depth: float = 1.0
    """Depth in its middle, 0…1; it runs out at both ends."""

    cross: float = 0.35
    """Height of the bulges at its sides, as a share of the depth."""


FOREHEAD = (1.577, 1.558, 1.538)
"""Heights of the lines across the forehead in the middle [m]."""

_AU1 = tuple(
    Groove(((-0.062, y - 0.006), (-0.030, y + 0.002), (0.0, y - 0.002), (0.030, y + 0.002),
            (0.062, y - 0.006)), depth=d)
    for y, d in zip(FOREHEAD, (0.50, 0.66, 0.53), strict=True)
)  # fmt: skip
_AU2 = tuple(
    Groove(((0.054, y), (0.085, y + 0.003), (0.118, y - 0.010), (0.140, y - 0.030)), depth=d)
    for y, d in ((1.566, 0.45), (1.546, 0.66), (1.527, 0.53))
)
_AU4 = (
    Groove(((0.0125, 1.490), (0.0105, 1.512), (0.0155, 1.550)), depth=0.90),
    Groove(((-0.0125, 1.492), (-0.0105, 1.513), (-0.0145, 1.546)), depth=0.80),
    Groove(((-0.021, 1.484), (0.0, 1.480), (0.021, 1.484)), depth=0.45),
)
_AU6 = (
    Groove(((0.152, 1.453), (0.163, 1.463), (0.171, 1.475)), 0.0042, 0.18),
    Groove(((0.154, 1.440), (0.167, 1.442), (0.178, 1.447)), 0.0042, 0.22),
    Groove(((0.151, 1.426), (0.163, 1.419), (0.174, 1.415)), 0.0042, 0.16),
)
_AU10 = (Groove(((0.034, 1.408), (0.050, 1.399), (0.064, 1.386), (0.074, 1.372)), 0.0080, 0.45),)
_AU12 = (Groove(((0.040, 1.398), (0.066, 1.394), (0.092, 1.382), (0.114, 1.362)), 0.0105, 0.32),)
"""Laughter lines are wide and low: a smile must not make a face old."""

_AU20 = (
    Groove(((0.089, 1.349), (0.093, 1.333), (0.088, 1.313)), 0.0038, 0.60),
    Groove(((0.104, 1.349), (0.109, 1.332), (0.103, 1.309)), 0.0042, 0.42),
)

GROOVES = {"au1": _AU1, "au2": _AU2, "au4": _AU4, "au6": _AU6, "au10": _AU10, "au12": _AU12,
           "au20": _AU20}  # fmt: skip
"""Grooves of each action unit; those with a layer for each side are of the left one."""

BLOOD_SPOTS = (
    # x, y, half width and height [m], strength: cheeks, nose, ears, a little of forehead and chin
    (0.122, 1.366, 0.060, 0.042, 1.0),
    (0.0, 1.392, 0.030, 0.024, 0.65),
    (0.216, 1.415, 0.050, 0.070, 0.9),
    (0.0, 1.545, 0.150, 0.060, 0.30),
    (0.0, 1.285, 0.060, 0.030, 0.30),
)
"""Where the vessels of the face are widest, on the left side (Jimenez et al. 2010, figure 2)."""


def mapped(mesh: Mesh) -> Mesh:
    """Return a piece of skin with its texture coordinates."""
    return replace(mesh, uvs=face_uvs(mesh.positions.astype(float)).astype(np.float32))


def face_uvs(points: Array) -> Array:
    """Return the texture coordinates of points of the head, (n, 3) to (n, 2).

    Behind the map, skin lies on its border: there is no cut with triangles across the whole map.
    """
    direction = np.arctan2(points[:, 0], points[:, 2])
    u = 0.5 + 0.5 * np.clip(direction / MAP_RANGE_RAD, -1.0, 1.0)
    v = np.clip((MAP_TOP_M - points[:, 1]) / (MAP_TOP_M - MAP_BOTTOM_M), 0.0, 1.0)
    behind = (np.abs(direction) - MAP_RANGE_RAD) / (np.pi - MAP_RANGE_RAD)
    return np.stack([u, v * (1.0 - smoothstep(behind))], axis=-1)


def save_face_maps(folder: Path) -> list[Path]:
    """Write all pictures of the map and return their paths."""
    folder.mkdir(exist_ok=True)
    written = []
    for name, picture in (*wrinkle_pictures(), (BLOOD_NAME, blood_picture())):
        written.append(folder / f"{name}{SUFFIX}")
        cv2.imwrite(str(written[-1]), picture, [cv2.IMWRITE_PNG_COMPRESSION, 9])
    return written


def wrinkle_pictures() -> Iterator[tuple[str, NDArray[np.uint8]]]:
    """Yield name and picture of each layer: 128 is flat, darker is deeper."""
    random = np.random.default_rng(SEED)
    for name in LAYER_NAMES:
        unit, _, side = name.partition("_")
        grooves = [
            _irregular(groove, random) if side != "right" else groove for groove in GROOVES[unit]
        ]
        height = sum(_height(groove) for groove in grooves)
        picture = np.clip(np.round(128.0 + 127.0 * np.asarray(height)), 0, 255).astype(np.uint8)
        yield name, picture if side != "right" else picture[:, ::-1]


def blood_picture() -> NDArray[np.uint8]:
    """Return where blood shows: 255 most."""
    total = np.zeros(MAP_SIZE_PX[::-1])
    for x, y, wide, high, strength in BLOOD_SPOTS:
        for sign in (1.0, -1.0):
            column, row = _pixels(_at(np.array([[x, y]])))[0]
            if sign < 0:
                column = MAP_SIZE_PX[0] - 1 - column
            rows, columns = np.mgrid[: MAP_SIZE_PX[1], : MAP_SIZE_PX[0]]
            apart = np.hypot(
                (columns - column) * _PIXEL_M[0] / wide, (rows - row) * _PIXEL_M[1] / high
            )
            total = np.maximum(total, strength * np.exp(-(apart**2)))
    return np.round(255.0 * np.where(total < 0.012, 0.0, total)).astype(np.uint8)


_HEAD_RADIUS_M = 0.205
_PIXEL_M = (
    2 * MAP_RANGE_RAD * _HEAD_RADIUS_M / MAP_SIZE_PX[0],
    (MAP_TOP_M - MAP_BOTTOM_M) / MAP_SIZE_PX[1],
)
"""Width and height of a pixel of the map on the head [m]."""


def _height(groove: Groove) -> Array:
    """Return the height of a groove over the map, -1…1, (height, width)."""
    line = _pixels(_at(_smooth(np.array(groove.line))))
    taper = np.sin(np.pi * np.linspace(0.0, 1.0, len(line))) ** 0.6
    reach = MAX_REACH * groove.width / np.array(_PIXEL_M)
    low = np.clip(np.floor(line.min(axis=0) - reach), 0, MAP_SIZE_PX).astype(int)
    high = np.clip(np.ceil(line.max(axis=0) + reach), 0, MAP_SIZE_PX).astype(int)
    rows, columns = np.mgrid[low[1] : high[1], low[0] : high[0]]
    apart = np.hypot(
        (columns[..., None] - line[:, 0]) * _PIXEL_M[0],
        (rows[..., None] - line[:, 1]) * _PIXEL_M[1],
    )
    nearest = apart.argmin(axis=-1)
    across = apart.min(axis=-1) / groove.width
    bulge = groove.cross * np.exp(-(((across - 2.4) / 1.1) ** 2))
    height = groove.depth * taper[nearest] * (bulge - np.exp(-0.5 * across**2))
    whole = np.zeros(MAP_SIZE_PX[::-1])
    whole[low[1] : high[1], low[0] : high[0]] = np.where(np.abs(height) < 0.004, 0.0, height)
    return whole


def _irregular(groove: Groove, random: np.random.Generator) -> Groove:
    """Return a groove with a slightly irregular line: no line in a face is even."""
    line = np.array(groove.line) + random.normal(0.0, 0.0009, (len(groove.line), 2))
    return replace(groove, line=tuple((float(x), float(y)) for x, y in line))


def _smooth(points: Array, count: int = 120) -> Array:
    """Return points on a smooth curve through others, (count, 2)."""
    knots = np.arange(len(points))
    at = np.linspace(0.0, len(points) - 1.0, count)
    degree = min(len(points) - 1, 3)
    return np.stack(
        [np.polyval(np.polyfit(knots, column, degree), at) for column in points.T], axis=-1
    )


def _at(flat: Array) -> Array:
    return on_face(flat[:, 0], flat[:, 1])


def _pixels(points: Array) -> Array:
    """Return columns and rows of the map at points of the face, (n, 2)."""
    return face_uvs(points) * MAP_SIZE_PX - 0.5
