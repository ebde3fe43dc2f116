"""The benchmark's cameras."""

from dataclasses import dataclass, field, replace

import numpy as np

from tests.bench.tracking.optics import LensModel, Sensor


@dataclass(frozen=True, eq=False)
class Camera:
    """A lens and a sensor."""

    lens: LensModel
    """Draws the pictures, in the sensor's full size."""

    sensor: Sensor = field(default_factory=Sensor)
    """Turns light to numbers."""

    @property
    def seen_lens(self) -> LensModel:
        """The lens in pixels of the pictures that the camera gives."""
        return self.lens.halved() if self.sensor.halved else self.lens


LENS = LensModel(
    np.array([[902.3, 0.0, 645.2], [0.0, 900.8, 355.7], [0.0, 0.0, 1.0]]),
    np.array([-0.11, 0.06, 0.0006, -0.0004, -0.01]),
    (1280, 720),
)
"""71° from left to right, a barrel of a few pixels."""

WEBCAM_LENS = LensModel(
    np.array([[601.7, 0.0, 322.4], [0.0, 600.9, 236.8], [0.0, 0.0, 1.0]]),
    np.array([0.13, -0.01, 0.0004, -0.0006, 0.0]),
    (640, 480),
    gauss=0.65,
    disk=0.0,
    focus=0.4,
    aperture=0.4,
)
"""56° from left to right, a cushion of 20 px in the corners; f/2.2 with a focal length of 3 mm.

The sensor's curve brightens the middle of a blurred edge, so white grows over black: by 0.31 px in
focus, and by 0.41 px at 0.2 m.
"""

PHONE_LENS = LensModel(
    np.array([[739.6, 0.0, 242.1], [0.0, 738.7, 424.0], [0.0, 0.0, 1.0]]),
    np.zeros(5),
    (480, 854),
)
"""An upright phone, 60° from top to bottom, which bends nothing."""

WIDE_ANGLE_LENS = LensModel(
    np.array([[402.9, 0.0, 481.8], [0.0, 402.4, 267.1], [0.0, 0.0, 1.0]]),
    np.zeros(5),
    (960, 540),
)
"""100° from left to right; the camera itself takes out what its lens bends."""

WIDE = Camera(LENS)
PHONE, WIDE_ANGLE = Camera(PHONE_LENS), Camera(WIDE_ANGLE_LENS)
WEBCAM = Camera(WEBCAM_LENS, Sensor(electrons=3000.0, quality=85))
WEBCAM_HALF = replace(WEBCAM, sensor=replace(WEBCAM.sensor, halved=True))
