"""Paper as people fold it: askew, with faces that bulge, and tape and lines by the markers."""

from dataclasses import replace

import cv2
import numpy as np
from numpy.typing import NDArray

from tests.bench.tracking.paper import AXES, BenchmarkCube, Relief, Side

FOLD_M = 0.00015
"""Standard deviation of each corner of the cube along each axis: faces tilt by about 0.4°."""

BULGE_M = (0.0001, 0.0003)
"""Bounds of how far the middle of a face stands out or in."""

FINE = 20
"""Squares into which a square of a face is cut, so that tape can be drawn."""


def worn(cube: BenchmarkCube, random: np.random.Generator) -> BenchmarkCube:
    """Fold `cube` a little askew, bend its faces, and put tape and lines beside its markers."""
    shifts = random.normal(0, FOLD_M, (2, 2, 2, 3))
    sides = [_bent(_taped(side, cube.edge, random), cube.edge, shifts, random)
             for side in cube.sides]  # fmt: skip
    return replace(cube, sides=tuple(sides))


def patched(cube: BenchmarkCube, share: float, random: np.random.Generator) -> BenchmarkCube:
    """Cover one corner of every marker with a square of about `share` of the marker's edge."""
    return replace(cube, sides=tuple(_patched(side, cube.edge, share, random)
                                     for side in cube.sides))  # fmt: skip


def _bent(
    side: Side, edge: float, shifts: NDArray[np.float64], random: np.random.Generator
) -> Side:
    """Lay the face along the shifted corners of the cube; paper bends, but does not stretch."""
    right, up, normal = AXES[side.name]
    u, v = np.array([-1, 1, 1, -1]), np.array([-1, -1, 1, 1])
    signs = normal + u[:, None] * right - v[:, None] * up
    x, y, z = (signs > 0).astype(int).T
    corners = signs * edge / 2 + shifts[x, y, z]
    # The corners are middle + u · along + v · down + u · v · twist.
    middle, along, down, twist = np.stack([np.ones(4), u, v, u * v]) @ corners / 4
    out = np.cross(down, along)
    out /= np.linalg.norm(out)
    along *= edge / 2 / np.linalg.norm(along)
    down = np.cross(along, out)
    count = len(side.albedo)
    first = middle + (along + down) * (1 / count - 1)
    place = np.stack([along * 2 / count, down * 2 / count, first], axis=1)
    bulge = random.uniform(*BULGE_M) * random.choice([-1, 1])
    lean = (float(random.uniform(-0.7, 0.7)), float(random.uniform(-0.7, 0.7)))
    relief = Relief(float(twist @ out), float(bulge), lean)
    return replace(side, place=place, normal=out, relief=relief)


def _finer(side: Side) -> Side:
    albedo = np.kron(side.albedo, np.ones((FINE, FINE), np.float32))
    place = side.place.copy()
    place[:, :2] /= FINE
    # The middle of the first of the smaller squares.
    place[:, 2] += (place[:, 0] + place[:, 1]) * (1 - FINE) / 2
    return replace(side, albedo=albedo, place=place)


def _border(side: Side, edge: float) -> float:
    """Width of the white border [squares]."""
    marker = float(np.linalg.norm(side.corners[1] - side.corners[0]))
    return (edge - marker) / 2 / edge * len(side.albedo)


def _taped(side: Side, edge: float, random: np.random.Generator) -> Side:
    """Lay strips of tape and print lines on the white border of some of the face's edges."""
    side = _finer(side)
    border = _border(side, edge)
    for turn in range(4):
        upper = np.rot90(side.albedo, turn)  # a view: drawing on it draws on the face
        if random.random() < 0.4:
            _lay_tape(upper, border, random)
        if random.random() < 0.3:
            _print_line(upper, border, random)
    return side


def _stretch(count: int, random: np.random.Generator) -> slice:
    """Columns of a strip that often goes from end to end."""
    first, last = random.uniform(-0.4, 0.4), random.uniform(0.6, 1.4)
    return slice(int(max(first, 0) * count), int(min(last, 1) * count))


def _lay_tape(upper: NDArray[np.float32], border: float, random: np.random.Generator) -> None:
    """Lay tape over the upper edge: darker than paper, or glossy; its cut edge shows as a line."""
    columns = _stretch(len(upper), random)
    rows = int(random.uniform(0.3, 0.95) * border)
    upper[:rows, columns] *= random.uniform(0.5, 0.92) if random.random() < 0.7 else 1.12
    upper[rows - 1 : rows + 1, columns] *= random.uniform(0.75, 1.05)


def _print_line(upper: NDArray[np.float32], border: float, random: np.random.Generator) -> None:
    """Print a line of 0.2 to 0.5 mm parallel to the upper edge, as for cutting or folding."""
    first = int(random.uniform(0, 0.8) * border)
    wide = int(random.integers(1, 4))
    upper[first : first + wide, _stretch(len(upper), random)] = random.uniform(0.06, 0.5)


def _patched(side: Side, edge: float, share: float, random: np.random.Generator) -> Side:
    count, border = len(side.albedo), _border(side, edge)
    marker = count - 2 * border
    inwards, outwards = share * random.uniform(0.85, 1.15), random.uniform(0.05, 0.16)
    square = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) * (inwards + outwards) * marker / 2
    square += (inwards - outwards) * marker / 2
    turn = np.deg2rad(random.uniform(-20, 20))
    square = square @ np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    patch = np.zeros((count, count), np.float32)
    cv2.fillConvexPoly(patch, np.rint(square + border - 0.5).astype(np.int32), 1.0)
    return replace(side, patch=np.rot90(patch, int(random.integers(4))).copy())
