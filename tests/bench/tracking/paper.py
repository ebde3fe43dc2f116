"""The benchmark's cube, read from its TOML file by independent code."""

from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from cubeling.toml_file import bundled

CUBES = Path(__file__).resolve().parents[3] / "tracking" / "cubes"

SMALL_CUBE = str(Path(__file__).with_name("small.toml"))
"""File of `locomotion` with an edge of 30 mm."""

PAPER_ALBEDO, INK_ALBEDO = 0.85, 0.06
"""Reflected share of light."""

_X, _Y, _Z = np.eye(3)
AXES = {
    "front": (_X, _Y, _Z),
    "back": (-_X, _Y, -_Z),
    "right": (-_Z, _Y, _X),
    "left": (_Z, _Y, -_X),
    "top": (_X, -_Z, _Y),
    "bottom": (_X, _Z, -_Y),
}
"""Of each face as one looks at it: what points right, what points up, and its normal."""


@dataclass(frozen=True, eq=False)
class Relief:
    """How a face strays from a flat square.

    u and v run from -1 to 1 along its columns and rows.
    """

    twist: float
    """Height at u = v = 1 of its twist, which is u · v times that [m]."""

    bulge: float
    """Height of its middle [m]; 0 at the edges."""

    lean: tuple[float, float]
    """How much more it bulges towards its right and lower edge, each -1…1."""

    def met(
        self, grid: NDArray[np.float32], slope: NDArray[np.float32], count: int
    ) -> NDArray[np.float32]:
        """Columns and rows (h, w, 2) where rays meet the face of `count` squares a side.

        Parameters
        ----------
        grid
            Where they meet the flat square.
        slope
            How far they go along columns and rows while they rise by 1 m.
        """
        found = grid
        for _ in range(3):  # The face is nearly flat: each round makes the error ten times less.
            at = (found + np.float32(0.5)) * np.float32(2 / count) - 1
            u, v = np.clip(at[..., 0], -1.1, 1.1), np.clip(at[..., 1], -1.1, 1.1)
            height = self.bulge * (1 - u * u) * (1 - v * v)
            height *= 1 + self.lean[0] * u + self.lean[1] * v
            height += self.twist * u * v
            found = grid + height[..., None] * slope
        return np.asarray(found, np.float32)


@dataclass(frozen=True, eq=False)
class Side:
    """One face: a grid of black and white squares, in space."""

    name: str
    """front, back, left, right, top or bottom."""

    marker_id: int
    """Number of its marker in the cube's dictionary."""

    albedo: NDArray[np.float32]
    """Share of light thrown back by each square of the grid, (n, n), the upper row first."""

    place: NDArray[np.float64]
    """Point [m] in the cube frame of (column, row, 1) in `albedo`, (3, 3).

    Whole numbers are the middles of squares.
    """

    normal: NDArray[np.float64]
    """Outward unit normal in the cube frame, (3,)."""

    corners: NDArray[np.float64]
    """Corners of the black square [m], (4, 3), from the marker's own top left on clockwise."""

    relief: Relief | None = None
    """How it strays from a flat square; None if it does not."""

    patch: NDArray[np.float32] | None = None
    """Share of each square that is covered by a hand or a sticker, (n, n); None if none is."""


@dataclass(frozen=True, eq=False)
class BenchmarkCube:
    """A cube of paper."""

    dictionary: str
    """Name of OpenCV's dictionary."""

    edge: float
    """Edge [m]."""

    sides: tuple[Side, ...]
    """The faces that carry a marker; a face without one is not drawn."""

    @classmethod
    def load(cls, name: str) -> "BenchmarkCube":
        """Read the bundled cube `name`, or the file of another."""
        path = Path(name) if name.endswith(".toml") else CUBES / f"{name}.toml"
        document = bundled(path)
        edge, marker = document["edge_mm"] / 1000, document["marker_mm"] / 1000
        sides = tuple(
            _side(table, document["dictionary"], edge, marker) for table in document["face"]
        )
        return cls(document["dictionary"], edge, sides)

    @property
    def vertices(self) -> NDArray[np.float64]:
        """The eight corners of the cube [m], (8, 3)."""
        signs = np.array(np.meshgrid([-1, 1], [-1, 1], [-1, 1])).reshape(3, 8).T
        return np.asarray(signs * (self.edge / 2))


def marker_cells(dictionary: str, marker_id: int) -> NDArray[np.bool_]:
    """White cells of a marker with its black border, (n, n)."""
    known = cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, dictionary))
    cells = known.markerSize + 2
    return cv2.aruco.generateImageMarker(known, marker_id, cells) > 127


def _side(table: dict[str, object], dictionary: str, edge: float, marker: float) -> Side:
    name, marker_id, turns = (
        str(table["name"]),
        int(str(table["marker_id"])),
        int(str(table.get("roll_deg", 0))) // 90,
    )
    if "corners_mm" in table:
        raise ValueError(f"face '{name}' has measured corners; this renderer draws true cubes")
    right, up, normal = AXES[name]
    pattern = np.rot90(marker_cells(dictionary, marker_id), -turns)
    # The grid is as fine as it must be for the white border to be a whole number of squares.
    border = Fraction((edge - marker) / 2 / (marker / len(pattern))).limit_denominator(50)
    pattern = np.kron(pattern, np.ones((border.denominator,) * 2, bool))
    pattern = np.pad(pattern, border.numerator, constant_values=True)
    step = edge / len(pattern)
    first = (edge / 2) * normal + (step - edge) / 2 * right + (edge - step) / 2 * up
    place = np.stack([right * step, -up * step, first], axis=1)
    corners = np.array([m * right + n * up for m, n in ((-1, 1), (1, 1), (1, -1), (-1, -1))])
    corners = np.roll(corners * marker / 2 + normal * edge / 2, -turns, axis=0)
    albedo = np.where(pattern, PAPER_ALBEDO, INK_ALBEDO).astype(np.float32)
    return Side(name, marker_id, albedo, place, normal, corners)
