"""Wrinkles for a head with ARKit's shapes that has no face maps of its own.

The shapes tell where a face is: what closes an eye moves its lid, what smiles moves a corner of the
mouth most. Grooves are laid between such landmarks, across the pull of each muscle (Duchenne 1862;
Ekman and Friesen 1978), and drawn in the texture coordinates of the head. They are shallow: no
expression is to age a face.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from cubeling.characters.model.face_maps import LAYER_NAMES, WRINKLE_LAYERS
from cubeling.characters.model.mesh import FaceMaps, Mesh, Morph

Array = NDArray[np.float64]

LANDMARK_SHAPES: Mapping[str, tuple[str, float]] = {
    "eye": ("eyeblink", 0.5),
    "brow": ("browouterup", 0.5),
    "corner": ("mouthsmile", 0.8),
    "wing": ("nosesneer", 0.7),
}
"""The shape that moves each landmark, without its side, and the share of its greatest displacement
above which a vertex belongs to it."""

MAP_SIDE_PX = 512
"""Width and height of the maps."""

DEPTH = 0.035
"""Height of 1, relative to the distance of the eyes: 2 mm of an adult's face, of which the grooves
have a third to two thirds."""

HEAD_RADIUS = 1.25
"""Radius of a head at its eyes, relative to their distance: grooves are laid around it."""

MAX_TURN_RAD = 1.6
"""Skin further around the head than this has no wrinkles [rad]."""

MIN_RADIUS = 0.85
"""Distance from the axis of the head, relative to the least of a landmark, from which on something
is skin: the inside of the mouth is nearer."""

MAX_SHARED = 0.1
"""Share of texels up to which the left and the right of a face may share them."""

REACH = 4.0
"""Distance from its line up to which a groove is drawn, in its widths."""

BULGE, BULGE_AT, BULGE_WIDTH = 0.3, 2.4, 1.0
"""Height of the skin beside a groove as a share of its depth; its distance and width, in widths of
the groove."""


@dataclass(frozen=True)
class _Groove:
    """A line in the skin; all lengths are relative to the distance of the eyes."""

    line: tuple[tuple[str, float, float], ...]
    """Points: a landmark, and how far outwards of it and above it they are. "middle" is between
    the brows, outwards of which is to the left."""

    depth: float
    width: float = 0.055


def _forehead(height: float, depth: float) -> _Groove:
    across = ((-0.62, -0.05), (-0.3, 0.01), (0.0, -0.02), (0.3, 0.01), (0.62, -0.05))
    return _Groove(tuple(("middle", x, height + y) for x, y in across), depth)


def _arch(height: float, depth: float) -> _Groove:
    beside = ((-0.2, 0.0), (0.1, 0.03), (0.4, -0.06), (0.6, -0.2))
    return _Groove(tuple(("brow", x, height + y) for x, y in beside), depth)


GROOVES: Mapping[int, tuple[_Groove, ...]] = {
    1: (_forehead(0.34, 0.5), _forehead(0.52, 0.6), _forehead(0.70, 0.45)),
    2: (_arch(0.26, 0.45), _arch(0.42, 0.5), _arch(0.57, 0.4)),
    4: (
        _Groove((("middle", 0.13, -0.16), ("middle", 0.11, 0.05), ("middle", 0.15, 0.24)), 0.7),
        _Groove((("middle", -0.13, -0.15), ("middle", -0.11, 0.06), ("middle", -0.14, 0.22)), 0.65),
    ),
    6: (
        _Groove((("eye", 0.36, 0.03), ("eye", 0.46, 0.08), ("eye", 0.56, 0.16)), 0.3, 0.045),
        _Groove((("eye", 0.37, -0.04), ("eye", 0.48, -0.05), ("eye", 0.58, -0.04)), 0.35, 0.045),
        _Groove((("eye", 0.35, -0.11), ("eye", 0.45, -0.17), ("eye", 0.53, -0.23)), 0.25, 0.045),
    ),
    10: (_Groove((("wing", 0.08, 0.06), ("wing", 0.18, -0.06), ("wing", 0.26, -0.24)), 0.4, 0.08),),
    12: (
        _Groove(
            (("wing", 0.10, 0.02), ("wing", 0.24, -0.14), ("corner", 0.20, 0.12),
             ("corner", 0.20, -0.08)),
            0.45, 0.09,
        ),
    ),
    20: (
        _Groove((("corner", 0.12, 0.14), ("corner", 0.16, 0.0), ("corner", 0.11, -0.16)), 0.35),
    ),
}  # fmt: skip
"""Grooves of each action unit; those with a layer for each side are of the left one."""


def with_generic_wrinkles(meshes: Sequence[Mesh]) -> tuple[Mesh, ...]:
    """Return meshes of which the one with a face has wrinkles, where ARKit's shapes tell it."""
    moved = [_moved_by_smile(mesh) for mesh in meshes]
    if not any(moved):
        return tuple(meshes)
    chosen = int(np.argmax(moved))
    maps = generic_face_maps(meshes[chosen])
    if maps is None:
        return tuple(meshes)
    face = meshes[chosen]
    face = replace(face, material=replace(face.material, face=maps))
    return (*meshes[:chosen], face, *meshes[chosen + 1 :])


def generic_face_maps(mesh: Mesh) -> FaceMaps | None:
    """Return wrinkles for a head in the bind pose; None where its shapes do not tell a face.

    Where the left and the right side share their texture, there are none: wrinkles of one side
    would show on the other.
    """
    shapes = {_plain(morph.name): morph for morph in mesh.morphs}
    marks = _landmarks(mesh, shapes)
    if marks is None or mesh.uvs is None:
        return None
    apart = float(np.linalg.norm(marks["eye", 0] - marks["eye", 1]))
    middle = 0.5 * (marks["eye", 0] + marks["eye", 1])
    axis = middle - [0.0, 0.0, HEAD_RADIUS * apart]
    points = _around(mesh.positions.astype(float), axis, apart)
    places = {key: _around(mark[None], axis, apart)[0] for key, mark in marks.items()}
    away, least = _radii(mesh.positions, axis), _radii(np.array([*marks.values()]), axis).min()
    texels = _texel_places(points, away > MIN_RADIUS * least, mesh)
    if texels is None:
        return None
    heights = np.zeros((len(LAYER_NAMES), MAP_SIDE_PX, MAP_SIDE_PX), np.float32)
    for unit, layers in WRINKLE_LAYERS.items():
        for side, layer in enumerate(layers):
            for groove in GROOVES[unit]:
                _draw(heights[layer], texels, _line(groove, places, side), groove)
    blood = np.zeros((MAP_SIDE_PX, MAP_SIDE_PX), np.float32)
    return FaceMaps(heights, blood, DEPTH * apart)


def _plain(name: str) -> str:
    """Return a shape's name in lower case without punctuation, its side spelt out.

    >>> _plain("mouthSmile_L")
    'mouthsmileleft'
    """
    for ending, side in (("_l", "left"), ("_r", "right")):
        if name.lower().endswith(ending):
            return name[:-2].lower().replace("_", "") + side
    return name.lower().replace("_", "")


def _moved_by_smile(mesh: Mesh) -> int:
    """Return how many vertices of a mesh a smile moves."""
    smiles = (each for each in mesh.morphs if _plain(each.name) == "mouthsmileleft")
    return 0 if mesh.uvs is None else sum(len(each.vertices) for each in smiles)


def _landmarks(mesh: Mesh, shapes: Mapping[str, Morph]) -> dict[tuple[str, int], Array] | None:
    """Return where the landmarks are, (3,) [m], by name and side: left 0, right 1."""
    marks: dict[tuple[str, int], Array] = {}
    for name, (shape, least) in LANDMARK_SHAPES.items():
        for side, ending in enumerate(("left", "right")):
            morph = shapes.get(shape + ending)
            if morph is None or not len(morph.vertices):
                return None
            size = np.linalg.norm(morph.displacements.astype(float), axis=1)
            weight = np.where(size > least * size.max(), size, 0.0)
            if not weight.any():
                return None
            marks[name, side] = weight @ mesh.positions[morph.vertices] / weight.sum()
    left, right = marks["eye", 0], marks["eye", 1]
    upright = marks["corner", 0][1] < left[1] and left[0] > right[0]
    return marks if upright and np.linalg.norm(left - right) > 0.0 else None


def _around(points: Array, axis: Array, apart: float) -> Array:
    """Return how far points (n, 3) are around an upright axis to the left, and above it, (n, 2).

    Both are relative to the distance of the eyes.
    """
    x, y, z = (points - axis).T
    return np.stack([HEAD_RADIUS * np.arctan2(x, z), y / apart], axis=-1)


def _radii(points: NDArray[np.floating[Any]], axis: Array) -> Array:
    """Return how far points (n, 3) are from the upright axis of the head, (n,) [m]."""
    return np.asarray(np.hypot(points[:, 0] - axis[0], points[:, 2] - axis[2]), np.float64)


def _texel_places(
    points: Array, is_skin: NDArray[np.bool_], mesh: Mesh
) -> NDArray[np.float32] | None:
    """Return the place on the face (`_around`) of each texel, (side, side, 2); NaN without one.

    `points` (n, 2) are those of the vertices.
    """
    assert mesh.uvs is not None
    is_skin = is_skin & (np.abs(points[:, 0]) < HEAD_RADIUS * MAX_TURN_RAD)
    corners = mesh.triangles[is_skin[mesh.triangles].all(axis=1)]
    at = mesh.uvs[corners].astype(float) * MAP_SIDE_PX
    edges = np.abs(at - np.roll(at, 1, axis=1)).max(axis=(1, 2))
    steps = np.clip(np.ceil(1.5 * edges), 1, MAP_SIDE_PX).astype(int)
    sums = np.zeros((MAP_SIDE_PX * MAP_SIDE_PX, 4))
    for step in np.unique(steps).tolist():
        these = steps == step
        rows, columns = np.indices((step + 1, step + 1)).reshape(2, -1)
        inside = rows + columns <= step
        shares = np.stack([rows, columns, step - rows - columns], axis=-1)[inside] / step
        texels = np.floor(np.einsum("sk,nkc->nsc", shares, at[these])).astype(int)
        places = np.einsum("sk,nkc->nsc", shares, points[corners[these]])
        kept = ((texels >= 0) & (texels < MAP_SIDE_PX)).all(axis=-1)
        number = texels[..., 1][kept] * MAP_SIDE_PX + texels[..., 0][kept]
        for column, values in enumerate(
            (np.ones(len(number)), *places[kept].T, places[kept][:, 0] ** 2)
        ):
            sums[:, column] += np.bincount(number, values, minlength=len(sums))
    known = sums[:, 0] > 0
    if not known.any():
        return None
    means = sums[known, 1:] / sums[known, :1]
    spread = np.sqrt(np.maximum(means[:, 2] - means[:, 0] ** 2, 0.0))
    if np.mean(spread > 0.1) > MAX_SHARED:
        return None
    found = np.full((MAP_SIDE_PX * MAP_SIDE_PX, 2), np.nan, np.float32)
    found[known] = means[:, :2]
    return _grown(found.reshape(MAP_SIDE_PX, MAP_SIDE_PX, 2))


def _grown(places: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return places with the texels beside known ones, so that no seam shows."""
    known = np.isfinite(places[..., 0])
    share = cv2.blur(known.astype(np.float32), (5, 5))
    mean = cv2.blur(np.where(known[..., None], places, np.float32(0)), (5, 5))
    beside = ~known & (share > 0)
    places[beside] = mean[beside] / share[beside, None]
    return places


def _line(groove: _Groove, places: Mapping[tuple[str, int], Array], side: int) -> Array:
    """Return points along a groove on one side of a face, (n, 2)."""
    sign = 1.0 if side == 0 else -1.0
    brows = 0.5 * (places["brow", 0] + places["brow", 1])
    knots = np.array(
        [
            (brows if mark == "middle" else places[mark, side]) + [sign * x, y]
            for mark, x, y in groove.line
        ]
    )
    at = np.linspace(0.0, len(knots) - 1.0, 40)
    fits = [np.polyfit(np.arange(len(knots)), each, min(len(knots) - 1, 3)) for each in knots.T]
    return np.stack([np.polyval(fit, at) for fit in fits], axis=-1)


def _draw(
    layer: NDArray[np.float32], texels: NDArray[np.float32], line: Array, groove: _Groove
) -> None:
    """Add a groove along a line, (n, 2), to a layer of heights in place."""
    reach = REACH * groove.width
    low, high = line.min(axis=0) - reach, line.max(axis=0) + reach
    near = ((texels > low) & (texels < high)).all(axis=-1)
    apart = np.linalg.norm(texels[near][:, None] - line.astype(np.float32), axis=-1)
    nearest = apart.argmin(axis=1)
    across = apart.min(axis=1) / groove.width
    taper = np.sin(np.pi * (nearest + 0.5) / len(line)) ** 0.6
    bulge = BULGE * np.exp(-(((across - BULGE_AT) / BULGE_WIDTH) ** 2))
    height = groove.depth * taper * (bulge - np.exp(-0.5 * across**2))
    layer[near] += np.where(np.abs(height) < 0.004, 0.0, height).astype(np.float32)
