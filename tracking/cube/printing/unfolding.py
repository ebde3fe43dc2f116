"""The net of the cube on paper: its squares and its glue tabs.

The printed side of the paper becomes the outside of the cube. All lengths are metres. The paper has
x to the right, y up, and its origin in the middle of `front`.
"""

from dataclasses import dataclass

import numpy as np

from cubeling.tracking.geometry.arrays import Array

SIDE_DIRECTIONS = {"right": (1, 0), "up": (0, 1), "left": (-1, 0), "down": (0, -1)}
"""The sides of a square on paper, counter-clockwise, with their outward directions."""

HINGES = {
    "top": ("front", "up"),
    "bottom": ("front", "down"),
    "left": ("front", "left"),
    "right": ("front", "right"),
    "back": ("right", "right"),
}
"""For each face except `front`: the face that it is joined to, and the side of that face."""

TABS = {
    ("left", "up"): "top",
    ("right", "up"): "top",
    ("back", "up"): "top",
    ("left", "down"): "bottom",
    ("right", "down"): "bottom",
    ("back", "down"): "bottom",
    ("back", "right"): "left",
}
"""The glue tabs, (face, side), and the face that each is glued under.

All but one are in the free space next to the arms: the net is 4 edges and one tab by 3 edges.
"""

TAB_DEPTH = 0.18
"""Depth of a tab as a share of the edge."""

TAB_SLANT = 1.12
"""How far a tab narrows at each end, as a share of its depth.

With 1 (45°) tabs that meet under a face would touch; thick paper and scissors need more room.
"""


@dataclass(frozen=True)
class Tab:
    """A glue tab: a trapezoid that folds under another face."""

    face: str
    """The face that it is joined to."""

    side: str
    """The side of that face, one of `SIDE_DIRECTIONS`."""

    under: str
    """The face it is glued under."""

    corners: Array
    """On paper, counter-clockwise, the first and the last on the fold, (4, 2) [m]."""


@dataclass(frozen=True)
class Unfolding:
    """The six squares of a cube laid out as a cross around `front`."""

    edge: float
    """Edge of the cube [m]."""

    def centre(self, face: str) -> Array:
        """Middle of a face on paper, (2,) [m]."""
        if face == "front":
            return np.zeros(2)
        parent, side = HINGES[face]
        return self.centre(parent) + self.edge * np.array(SIDE_DIRECTIONS[side])

    def square(self, face: str) -> Array:
        """Corners of a face on paper, counter-clockwise from the bottom right, (4, 2) [m]."""
        half = self.edge / 2
        return self.centre(face) + half * np.array([(1, -1), (1, 1), (-1, 1), (-1, -1)])

    def tabs(self) -> tuple[Tab, ...]:
        """Return the glue tabs, one for each edge of the cube that is cut open."""
        return tuple(
            Tab(face, side, under, self._tab(face, side)) for (face, side), under in TABS.items()
        )

    def folds(self) -> tuple[tuple[Array, Array], ...]:
        """Return the ends of every line to fold, on paper, two (2,) [m] each."""
        return tuple(self._side(face, side) for face, side in (*HINGES.values(), *TABS))

    def outline(self) -> Array:
        """Return the line to cut along, closed and counter-clockwise, (N, 2) [m]."""
        tabs = {(tab.face, tab.side): tab for tab in self.tabs()}
        hinged = set(HINGES.values()) | {
            (face, _OPPOSITE[side]) for face, (_, side) in HINGES.items()
        }
        following: dict[tuple[int, int], Array] = {}
        for face in ("front", *HINGES):
            for side in SIDE_DIRECTIONS:
                if (face, side) in hinged:
                    continue
                tab = tabs.get((face, side))
                line = tab.corners if tab else np.array(self._side(face, side))
                following[_micrometres(line[0])] = line
        start = line = next(iter(following.values()))
        points = [line[:-1]]
        while _micrometres(line[-1]) != _micrometres(start[0]):
            line = following[_micrometres(line[-1])]
            points.append(line[:-1])
        return np.concatenate(points)

    def size(self) -> tuple[float, float]:
        """Width and height that the net takes on paper [m]."""
        width, height = np.ptp(self.outline(), axis=0)
        return float(width), float(height)

    def _side(self, face: str, side: str) -> tuple[Array, Array]:
        """Return the ends of a face's side in counter-clockwise order."""
        square, number = self.square(face), list(SIDE_DIRECTIONS).index(side)
        return square[number], square[(number + 1) % 4]

    def _tab(self, face: str, side: str) -> Array:
        first, last = self._side(face, side)
        depth = TAB_DEPTH * self.edge
        outwards = depth * np.array(SIDE_DIRECTIONS[side])
        along = TAB_SLANT * depth * (last - first) / self.edge
        return np.array([first, first + outwards + along, last + outwards - along, last])


_OPPOSITE = {"right": "left", "left": "right", "up": "down", "down": "up"}


def _micrometres(point: Array) -> tuple[int, int]:
    """Return a key for a corner, by which the two faces that meet there find each other."""
    x, y = np.rint(point * 1e6).astype(int)
    return int(x), int(y)
