"""What a picture is made of: the camera's view and what stands in it."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from characters.control.command import PosedCharacter
from characters.model.mesh import Mesh
from characters.skeleton.pose import Skeleton

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Box:
    """A real cube in the camera's picture, which hides what is behind it."""

    camera_from_box: Array
    """Its pose, (4, 4) [m]; the origin is its centre."""

    edge: float
    """Length of its edges [m]."""


@dataclass(frozen=True)
class View:
    """The camera's picture and what is known about the room in it."""

    image: NDArray[np.uint8] | None
    """The camera's frame as it came, (height, width, 3) BGR; None for a plain backdrop."""

    matrix: Array
    """Pinhole matrix of the frame, (3, 3) [px], centres of pixels at whole numbers as in OpenCV."""

    distortion: Array
    """Distortion of the lens as OpenCV takes it, (n,); n = 0, 4, 5, 8, 12 or 14."""

    camera_from_table: Array | None
    """The table's frame, (4, 4) [m], +y up; None where it is not known: nothing is drawn then."""

    occluders: tuple[Box, ...] = ()
    """Real cubes that hide what is behind them."""


class Drawable(Protocol):
    """What is asked of a character in order to draw it."""

    @property
    def meshes(self) -> Sequence[Mesh]:
        """Its skinned surfaces."""

    @property
    def skeleton(self) -> Skeleton:
        """The joints that move them."""

    @property
    def morphs(self) -> Sequence[str]:
        """Names of the morphs that `Pose.morphs` turns on, in its order."""


@dataclass(frozen=True)
class SceneCharacter:
    """A character in a pose, on the table."""

    character: Drawable
    """Its meshes and skeleton; sent to the graphics card when first drawn."""

    posed: PosedCharacter
    """Its pose and place."""


@dataclass(frozen=True)
class FloorPath:
    """A line of points painted on the table: a disc for each, dashes between them."""

    points: Array
    """(n, 2): x and z in the table frame [m]."""

    closed: bool = False
    """Whether a dashed line leads from the last point back to the first."""

    color: tuple[float, float, float] = (1.0, 0.93, 0.72)
    """sRGB, each 0…1."""

    highlight: int | None = None
    """Number of the point that is larger and has a ring around it, or None."""


@dataclass(frozen=True)
class Rectangle:
    """A part of the picture in whole pixels."""

    x: int
    """Left column."""

    y: int
    """Top row."""

    width: int
    """Columns."""

    height: int
    """Rows."""

    @property
    def rows_and_columns(self) -> tuple[slice, slice]:
        """Index of the part in an image array."""
        return slice(self.y, self.y + self.height), slice(self.x, self.x + self.width)

    @property
    def area(self) -> int:
        """Number of pixels."""
        return self.width * self.height

    @property
    def sides(self) -> tuple[int, int, int, int]:
        """Left column, top row, columns and rows."""
        return self.x, self.y, self.width, self.height

    def seen_from(self, other: "Rectangle") -> "Rectangle":
        """Return the same rectangle with rows and columns counted from another's corner."""
        return Rectangle(self.x - other.x, self.y - other.y, self.width, self.height)

    def meets(self, other: "Rectangle") -> bool:
        """Return whether both have a pixel in common.

        >>> Rectangle(0, 0, 2, 2).meets(Rectangle(1, 1, 5, 5))
        True
        >>> Rectangle(0, 0, 2, 2).meets(Rectangle(2, 0, 5, 5))
        False
        """
        across = max(self.x, other.x) < min(self.x + self.width, other.x + other.width)
        down = max(self.y, other.y) < min(self.y + self.height, other.y + other.height)
        return across and down

    def joined(self, other: "Rectangle") -> "Rectangle":
        """Return the smallest rectangle that holds both.

        >>> Rectangle(0, 0, 2, 2).joined(Rectangle(3, 1, 1, 4))
        Rectangle(x=0, y=0, width=4, height=5)
        """
        x, y = min(self.x, other.x), min(self.y, other.y)
        right = max(self.x + self.width, other.x + other.width)
        foot = max(self.y + self.height, other.y + other.height)
        return Rectangle(x, y, right - x, foot - y)
