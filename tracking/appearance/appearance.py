"""What the picture of a frame tells beside the cube's pose, as values."""

from dataclasses import dataclass, replace

import numpy as np

from cubeling.tracking.appearance.hand.mask import HandMask
from cubeling.tracking.geometry.arrays import Array, Image

ENVIRONMENT_PX = 64
"""Side of a face of an environment map [texels]."""


@dataclass(frozen=True)
class MeasuredLight:
    """Light from one direction, and from all around."""

    to_light: Array
    """Unit vector towards the key light, in the camera's frame, (3,)."""

    key: Array
    """Irradiance from it on a surface that faces it, linear RGB, (3,); 1 makes a white surface just
    white."""

    ambient: Array
    """Irradiance from all around, linear RGB, (3,)."""

    certainty: float
    """How well the faces seen so far determine the direction, 0…1.

    One less the spread of the directions that explain the paper, as a share of the spread before
    anything was seen. At 0.5 that is about 30°, and `to_light` is half a guess.
    """


@dataclass(frozen=True)
class PictureQuality:
    """How soft, noisy and hazy a picture is."""

    blur: float
    """Standard deviation of the blur that lens and sensor add to sharp edges [px]."""

    noise: float
    """Standard deviation of the noise of each pixel, in grey values of 0…255."""

    haze: float = 0.0
    """Share of the light of paper that glare in lens and air adds to everything."""

    paper: float = 1.0
    """Light of the paper, linear; 1 is the brightest white."""


@dataclass(frozen=True)
class EnvironmentMap:
    """The light from all directions, as it comes to one point over the table.

    Raises
    ------
    ValueError
        The planes are not of six faces of `ENVIRONMENT_PX`, or the point is none.
    """

    planes: Image
    """Red, then green, then blue of the faces +x, −x, +y, −y, +z, −z of a cube map in the table
    frame, turned as OpenGL has them, (3 · 6 · 64, 64), sRGB: 255 is the brightest white of the
    picture."""

    centre: Array
    """The point, in the table frame, (3,) [m]."""

    reach: float
    """How far the table reaches from there, and how far all else is [m]."""

    timestamp: float
    """Time of the picture that it was made of [s]: earlier than that of the frame where nothing
    has changed since."""

    def __post_init__(self) -> None:
        if self.planes.shape != (18 * ENVIRONMENT_PX, ENVIRONMENT_PX):
            raise ValueError(f"an environment map has no {self.planes.shape} texels")
        if np.shape(self.centre) != (3,) or not np.isfinite([*self.centre, self.reach]).all():
            raise ValueError("an environment map has no place")


@dataclass(frozen=True)
class Appearance:
    """What the picture of a frame tells beside the cube's pose."""

    hand: HandMask | None
    """The hand in front of the cube; None where there is none, or it is not looked for."""

    light: MeasuredLight | None
    """The light in the room; None until any paper was measured."""

    softness: PictureQuality | None
    """Blur, noise and haze of the picture; None until a still cube was measured."""

    timestamp: float
    """Time of the frame [s]."""

    room: EnvironmentMap | None = None
    """The light from all directions; None until a table was seen."""

    def news(self) -> "Appearance":
        """Return what a recording holds: a map of the room only in the frame that it was made of.

        It is larger than all else, and mostly that of the frame before.
        """
        known = self.room is not None and self.room.timestamp != self.timestamp
        return replace(self, room=None) if known else self

    def after(self, before: "Appearance | None") -> "Appearance":
        """Return what a recording meant by this, after the message before."""
        kept = None if before is None else before.room
        return replace(self, room=kept) if self.room is None and kept is not None else self
