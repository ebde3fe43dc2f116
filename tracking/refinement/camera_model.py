"""Exposure time and tone curve of a camera, estimated from how it blurs a moving cube."""

from collections import deque
from dataclasses import dataclass

import numpy as np

from cubeling.tracking.geometry.arrays import Array, Floats
from cubeling.tracking.refinement.photometry.photometric_fit import Alignment
from cubeling.tracking.refinement.readout import ReadoutEstimator

FIRST_EXPOSURE_S, MAX_EXPOSURE_S = 0.010, 0.05
"""Exposure that is assumed before it is measured, that of a webcam indoors, and the longest."""

FIRST_EXPONENT, MIN_EXPONENT, MAX_EXPONENT = 2.2, 1.0, 2.6
"""Light is the grey value to this power: in nearly every camera (sRGB), and the plausible range."""

EXPOSURE_SAMPLES, EXPONENT_SAMPLES = 15, 9
"""Exposure and exponent are the medians of this many measurements."""

MIN_MOTION_INFORMATION = 100.0
"""Information about the blur motion along the velocity, relative to its square, from which on a
measurement counts: ten standard deviations."""

MIN_EXPONENT_STEP = 0.15
"""The exponent changes only by more than this: a new table moves poses by hundredths of a mm."""

MIN_BLUR_CELLS, MIN_BLUR_PX = 0.2, 3.5
"""Least blur of an edge that is used to estimate the camera: an unknown lens blurs as much."""

MAX_STUDIES = 60
"""Sharp frames that are aligned as blurred ones at most, only to learn the camera from them."""


@dataclass(frozen=True)
class CameraModel:
    """What is known of a camera at one moment."""

    exposure: float
    """Exposure time [s]; 0 where blur ran backwards."""

    exposure_known: bool
    """Whether it was measured often enough."""

    tone: Floats
    """Light for each grey value, (256,)."""

    worth_studying: bool
    """Whether a sharp frame is worth being aligned to learn more."""

    readout: float = 0.0
    """Time that a rolling shutter takes from the first row to the last [s]; 0 while unknown."""

    @property
    def readout_share(self) -> float:
        """That time in exposure times; 0 where the exposure is 0."""
        return self.readout / self.exposure if self.exposure > 0 else 0.0

    @property
    def sought_exposure(self) -> float:
        """Exposure with which an image is studied [s]: with 0 none would show any blur."""
        return self.exposure or FIRST_EXPOSURE_S


@dataclass(frozen=True)
class BlurObservation:
    """Measurements of the camera from the blurred image of one cube."""

    aligned: Alignment
    """The pose and the motion that explain the image."""

    velocity: Array
    """Velocity of the cube by its track, (6,)."""

    blur_extent: float
    """How far an edge moved during the exposure [cells]."""

    pixels_per_cell: float
    """Size of a marker's cell [px]."""


def shows_exposure(blur_extent: float, pixels_per_cell: float) -> bool:
    """Whether a cube whose edges cross this many cells is blurred enough to tell anything."""
    return blur_extent >= MIN_BLUR_CELLS and blur_extent * pixels_per_cell >= MIN_BLUR_PX


class CameraModelEstimator:
    """Estimates exposure and tone curve of one camera from images of a blurred cube."""

    def __init__(self) -> None:
        self.exposure = ExposureEstimator()
        self.tone_curve = ToneCurve()
        self.readout = ReadoutEstimator()
        self._studies = 0

    @property
    def model(self) -> CameraModel:
        """What is known so far."""
        known = self.exposure.known and self.tone_curve.known
        return CameraModel(
            self.exposure.exposure,
            self.exposure.known,
            self.tone_curve.table,
            not known and self._studies < MAX_STUDIES,
            self.readout.seconds,
        )

    def learn(self, blur: BlurObservation | None, studied: bool) -> None:
        """Learn from the blur of one frame; `studied` if a sharp image was aligned for this."""
        self._studies += studied
        if blur is None or blur.blur_extent * blur.pixels_per_cell < MIN_BLUR_PX:
            return
        self.exposure.learn(*blur.aligned.motion_information, blur.velocity)
        if blur.blur_extent > MIN_BLUR_CELLS:
            self.tone_curve.learn(blur.aligned.mixture_bend, blur.aligned.black_level)


class ExposureEstimator:
    """The exposure time τ of one camera: a cube with velocity v moves by v·τ during it.

    Each direction is weighted by how well the blur determines it.
    """

    def __init__(self) -> None:
        self._samples: deque[float] = deque(maxlen=EXPOSURE_SAMPLES)
        self.exposure = FIRST_EXPOSURE_S
        """The best estimate [s]."""

    @property
    def known(self) -> bool:
        """Whether it was measured often enough."""
        return len(self._samples) > EXPOSURE_SAMPLES // 2

    def learn(self, weighted_motion: Array, information: Array, velocity: Array) -> None:
        """Learn from `Alignment.motion_information` of a cube with a known velocity, (6,)."""
        strength = float(velocity @ information @ velocity)
        # From 0, no measurement would ever count.
        if strength * (self.exposure or FIRST_EXPOSURE_S) ** 2 < MIN_MOTION_INFORMATION:
            return
        sample = np.clip(velocity @ weighted_motion / strength, 0.0, MAX_EXPOSURE_S)
        self._samples.append(float(sample))
        self.exposure = float(np.median(self._samples))


class ToneCurve:
    """The tone curve of one camera, as a power of the grey value.

    Blur mixes light, not grey values: else every blurred edge seems to lie too far in the black.
    """

    def __init__(self) -> None:
        self.exponent = FIRST_EXPONENT
        """Light is the grey value to this power."""
        self.table = _table(FIRST_EXPONENT)
        """Light for each grey value, 0…255, (256,)."""
        self._samples: deque[float] = deque(maxlen=EXPONENT_SAMPLES)

    @property
    def known(self) -> bool:
        """Whether it was measured often enough."""
        return len(self._samples) == EXPONENT_SAMPLES

    def learn(self, bend: float, black: float) -> None:
        """Learn from by how much the middle between black and white is too bright for a mixture.

        The light of a mixture with a share m of white is a + b·m + c·m(1 − m): `bend` is c/b, and
        `black` a/(a + b), the light of black over that of white.
        """
        measured = _exponent(self.exponent, bend, black)
        self._samples.append(np.clip(measured, MIN_EXPONENT, MAX_EXPONENT).item())
        exponent = float(np.median(self._samples))
        if self.known and abs(exponent - self.exponent) > MIN_EXPONENT_STEP:
            self.exponent = exponent
            self.table = _table(exponent)


def _table(exponent: float) -> Floats:
    return np.asarray(255 * (np.arange(256) / 255) ** exponent, np.float32)


def _exponent(used: float, bend: float, black: float) -> float:
    """Exponent that makes a mixture of half black and half white the middle of the two.

    With the exponent used, the middle reads as h = (1 + black)/2 + bend (1 − black)/4 of white. The
    grey values of black, middle and white are their `used`-th roots; this exponent e makes
    2 middle^e = black^e + 1.
    """
    black = min(max(black, 1e-3), 0.9)
    middle = (1 + black) / 2 + bend * (1 - black) / 4
    dark, grey = black ** (1 / used), min(max(middle, 1e-3), 0.999) ** (1 / used)
    tried = np.linspace(0.6, 3.2, 105)
    return float(tried[np.argmin(np.abs(2 * grey**tried - dark**tried - 1))])
