"""Options of the synthetic camera: `synthetic:NAME?key=value&key=value`."""

from dataclasses import dataclass
from typing import ClassVar

from cubeling.tracking.sources.webcam.options import UriOptions


@dataclass(frozen=True)
class SyntheticOptions(UriOptions):
    """How the camera sees and how the script runs."""

    LIMITS: ClassVar = {
        "rate": (1.0, 240.0),
        "width": (64, 4096),
        "height": (64, 4096),
        "blur": (0.0, 0.1),
        "noise": (0.0, 50.0),
        "defocus": (0.0, 10.0),
        "distortion": (-2.0, 2.0),
        "speed": (0.01, 3.0),
        "fold": (0.0, 3.0),
        "frames": (0, 1_000_000),
    }
    PAIRS: ClassVar = {"size": ("width", "height")}

    seed: int = 1
    """Seed of everything random."""

    frames: int = 0
    """Number of frames; 0 for the script's own length."""

    rate: float = 30.0
    """Frame rate [frames/s]."""

    width: int = 1280
    """Width of the image [px]."""

    height: int = 720
    """Height of the image [px]."""

    blur: float = 0.008
    """Exposure time [s]."""

    noise: float = 1.5
    """Standard deviation of the sensor noise at middle grey [grey levels]."""

    defocus: float = 0.6
    """Standard deviation of the lens blur [px]."""

    distortion: float = 1.0
    """Strength of the lens distortion: 0 none, 1 that of a webcam."""

    clutter: bool = True
    """Whether objects lie on the desk."""

    hand: bool = True
    """Whether the hand that moves the cube is visible."""

    shadow: bool = True
    """Whether cube and hand cast shadows, and a person's shadow moves over the desk."""

    speed: float = 0.5
    """Peak speed of the script "sweep" [m/s]."""

    fold: float = 0.0
    """Folding error: each face is off by up to this many millimetres along each axis, and by as
    many degrees about each."""
