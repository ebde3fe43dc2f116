"""What the picture of a frame tells beside the cube's pose, as values."""

from dataclasses import dataclass

from cubeling.tracking.appearance.hand.mask import HandMask
from cubeling.tracking.geometry.arrays import Array


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
