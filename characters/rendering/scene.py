"""What a picture shows: the camera's view, the characters in it, and the paths on the floor."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.control.command import PosedCharacter
from cubeling.characters.model.mesh import Mesh
from cubeling.characters.skeleton.pose import Array, Skeleton

RIM_SHARE, WALL_SHARE = 0.055, 0.025
"""Width of the rim that an open wall of a cube keeps, and thickness of the walls, as shares of the
cube's edge; in `cube_window.frag` too. The rim lies within the white border around a marker."""


@dataclass(frozen=True)
class Box:
    """A real cube in the camera's picture. It hides what is behind it."""

    camera_from_box: Array
    """Its pose, (4, 4) [m]; the origin is its centre."""

    edge: float
    """Length of its edges [m]."""

    opening: float = 0.0
    """How far the walls that look at the camera are open, 0…1: through them its inside is seen."""

    @property
    def is_open(self) -> bool:
        """Whether its inside is seen."""
        return self.opening > 0.0


class HandInFront(Protocol):
    """What is in front of a real cube, as the hand that holds it. It hides what is behind it."""

    @property
    def x(self) -> int:
        """First column of the camera's frame that `share` is of [px]."""

    @property
    def y(self) -> int:
        """First row of the camera's frame that `share` is of [px]."""

    @property
    def share(self) -> NDArray[np.uint8]:
        """Share of each square of pixels that is covered, (height, width), 0…255."""

    @property
    def behind(self) -> Array:
        """A point of the nearest surface behind it, in the camera's frame, (3,) [m]."""

    @property
    def scale(self) -> int:
        """Side of these squares [px]."""

    @property
    def slope(self) -> float:
        """How steeply a share rises at an edge, relative to what is interpolated of squares."""


class RoomLight(Protocol):
    """The light in the room, as it falls on something known in the camera's picture."""

    @property
    def to_light(self) -> Array:
        """Unit vector towards the key light, in the camera's frame, (3,)."""

    @property
    def key(self) -> Array:
        """Light from there on a surface that faces it, (3,) linear RGB; 1 makes white white."""

    @property
    def ambient(self) -> Array:
        """Light from all around, (3,) linear RGB."""

    @property
    def certainty(self) -> float:
        """How certain its direction is, 0…1: an uncertain light does not replace the usual one."""


class RoomMap(Protocol):
    """The light from all directions, as it comes to one point over the table."""

    @property
    def planes(self) -> NDArray[np.uint8]:
        """A cube map in the table frame, (3 · 6 · 64, 64), sRGB.

        Red, then green, then blue of the faces +x, −x, +y, −y, +z, −z, turned as OpenGL has them.
        """

    @property
    def centre(self) -> Array:
        """The point, in the table frame, (3,) [m]."""

    @property
    def reach(self) -> float:
        """How far the table reaches from there, and how far all else is [m]."""


class Softness(Protocol):
    """How soft, noisy and hazy the camera's picture is; what is drawn becomes so too."""

    @property
    def blur(self) -> float:
        """Standard deviation of the blur of lens and sensor [px of the frame]."""

    @property
    def noise(self) -> float:
        """Standard deviation of the noise of a pixel, in values of 0…255."""

    @property
    def haze(self) -> float:
        """Share of the light of white paper that glare in lens and air adds to everything."""

    @property
    def paper(self) -> float:
        """Light of that paper, linear; it stays as it is, and all that is darker comes nearer."""


@dataclass(frozen=True)
class Focus:
    """Which depths the camera shows sharp, and how much its lens blurs the others."""

    nearest: float
    """Least depth along the camera's axis that is sharp [m]."""

    furthest: float
    """Greatest depth that is sharp [m]."""

    aperture: float
    """Diameter of the lens's opening [m]; about 0.002 in a webcam."""

    def radius(self, depth: float) -> float:
        """Return the radius of the circle of confusion at a depth, as a tangent.

        At a distance d from the nearest sharp depth f, it is d / depth of that of what is
        infinitely far, which is half of the aperture over f (Huang 2013, eq. 12.1.1).

        >>> Focus(0.5, 0.5, 0.002).radius(1.0)
        0.001
        """
        off = max(1.0 / depth - 1.0 / self.nearest, 1.0 / self.furthest - 1.0 / depth, 0.0)
        return 0.5 * self.aperture * off


@dataclass(frozen=True)
class CameraView:
    """The camera's picture and what is known about the scene in it."""

    image: NDArray[np.uint8] | None
    """The camera's frame as captured, (height, width, 3) BGR; None for a plain backdrop."""

    matrix: Array
    """Pinhole matrix of the frame, (3, 3) [px]. Pixel centres have integer coordinates, as in
    OpenCV."""

    distortion: Array
    """Distortion coefficients as in OpenCV, (n,); n = 0, 4, 5, 8, 12 or 14."""

    camera_from_table: Array | None
    """The table frame, (4, 4) [m], +y up. If it is None, nothing is drawn on the frame."""

    occluders: tuple[Box, ...] = ()
    """Real cubes that hide what is behind them."""

    hand: HandInFront | None = None
    """The hand in front of the cube, if it is known."""

    light: RoomLight | None = None
    """The light in the room, if it was measured; left out, it is estimated from the picture."""

    softness: Softness | None = None
    """Blur and noise of the frame, if they were measured; left out, characters are drawn sharp."""

    room: RoomMap | None = None
    """The light from all around, if it was measured; left out, it has one colour from above and one
    from below. One object is one map: a new one is faded in."""

    timestamp: float = 0.0
    """Time of the frame [s], by which that is done."""

    focus: Focus | None = None
    """Which depths are sharp; left out, all are. Only deferred shading blurs the others."""

    part: tuple[float, float, float, float] | None = None
    """What of the frame is in the picture, magnified: columns and rows from the first to one after
    the last, left, top, right, bottom [px]; None for all of it."""


class Drawable(Protocol):
    """The part of a character that drawing needs."""

    @property
    def meshes(self) -> Sequence[Mesh]:
        """Meshes that follow the joints of `skeleton`."""

    @property
    def skeleton(self) -> Skeleton:
        """The joints that move them."""

    @property
    def morphs(self) -> Sequence[str]:
        """Names of the morph targets, in the order of the weights `Pose.morphs`."""


@dataclass(frozen=True)
class SceneCharacter:
    """A posed character in the scene."""

    character: Drawable
    """Its meshes and skeleton; uploaded to the graphics card when first drawn."""

    posed: PosedCharacter
    """Its pose and its place on the table."""

    wrinkles: bool = True
    """Whether its skin wrinkles as its face moves, if the character has maps for it."""

    blood: float = 0.0
    """Blood in the skin of its face: -1 pale … 1 flushed, if the character has a map for it."""

    inside: Box | None = None
    """The open cube that it stands in: nothing of it is drawn outside, and its shadow falls on the
    floor in there. None for a character on the table."""


@dataclass(frozen=True)
class FloorPath:
    """A polyline painted on the table: a disc at each point, dashes between them."""

    points: Array
    """(n, 2): x and z in the table frame [m]."""

    closed: bool = False
    """Whether a dashed line leads from the last point back to the first."""

    color: tuple[float, float, float] = (1.0, 0.93, 0.72)
    """sRGB, each 0…1."""

    highlight: int | None = None
    """Index of the point that is drawn larger and with a ring, or None."""


@dataclass(frozen=True)
class Scene:
    """Everything that one picture shows."""

    view: CameraView
    """The camera's frame, and the real cubes in it."""

    characters: Sequence[SceneCharacter]
    """The characters on the table."""

    floor: Sequence[FloorPath] = ()
    """What is painted on the table."""
