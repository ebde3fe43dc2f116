"""Locking exposure and focus: automatic controls that hunt move and blur the cube's edges."""

from dataclasses import dataclass

import cv2
import numpy as np

from cubeling.tracking.geometry.arrays import Image
from cubeling.tracking.sources.device import DeviceSetting, is_decodable
from cubeling.tracking.sources.webcam.video_device import VideoCapture

SETTLING_IMAGES = 30
"""Number of images before anything is locked, so that the automatic controls can settle."""

POLL_IMAGES = 15
"""Number of images between two readings of a value; it has settled if two readings agree."""

MAX_SETTLING_IMAGES = 150
"""A value that has not settled after this number of images stays automatic."""

PROOF_IMAGES = 10
"""Number of images after which a locked exposure must still give the same brightness."""

MAX_BRIGHTNESS_CHANGE = 0.25
"""Relative change of brightness that counts as unchanged."""

READ_BACK_TOLERANCE = 0.05
"""Relative difference between a value set and the same value read back: drivers have steps."""


@dataclass(frozen=True)
class CameraControl:
    """A control with an automatic mode, as V4L2 has them."""

    name: str
    """ "exposure" or "focus"."""

    mode: int
    """OpenCV's property that switches the automatic mode."""

    automatic: float
    """Its value for automatic."""

    manual: float
    """Its value for manual."""

    value: int
    """OpenCV's property of the value itself."""

    units: float = 1.0
    """Units of the value in one unit that a person reads."""

    suffix: str = ""
    """Unit that a person reads."""

    def text(self, value: float) -> str:
        """Return a value as text.

        >>> EXPOSURE.text(156.0), FOCUS.text(30.0)
        ('15.6 ms', '30')
        """
        return f"{value / self.units:g}{self.suffix}"


EXPOSURE = CameraControl(
    "exposure",
    mode=cv2.CAP_PROP_AUTO_EXPOSURE,
    automatic=3.0,  # V4L2_EXPOSURE_APERTURE_PRIORITY
    manual=1.0,  # V4L2_EXPOSURE_MANUAL
    value=cv2.CAP_PROP_EXPOSURE,
    units=10.0,  # V4L2 measures exposure in units of 100 µs
    suffix=" ms",
)
FOCUS = CameraControl("focus", cv2.CAP_PROP_AUTOFOCUS, 1.0, 0.0, cv2.CAP_PROP_FOCUS)


class ControlLock:
    """Locks one control of a camera: at a given `value` (in the driver's unit), or once settled.

    Each value is read back, as drivers refuse silently. Many cameras do not report the exposure
    that their automatic mode has chosen, but an old or default one (opencv#5516). A locked exposure
    is therefore verified by the brightness of the images, and undone if that changes.

    V4L2 keeps settings after the camera is closed, so `release` switches to automatic again, and so
    does the next start, in case the program was killed.
    """

    def __init__(
        self, capture: VideoCapture, control: CameraControl, value: float | None = None
    ) -> None:
        self._capture, self._control = capture, control
        self._last_value = -1.0
        self._count = 0
        self._proof: tuple[int, float] | None = None
        self._done = False
        self.setting = DeviceSetting(control.name, False, "still automatic")
        """The result."""
        mode = capture.get(control.mode)
        self._automatic = control.automatic if mode == control.manual else mode
        if not self._is_supported():
            self._finish(False, "the camera has no such setting")
        elif value is not None:
            self._lock(value, "set to")
        else:
            self.release()

    def update(self, image: Image | bytes) -> None:
        """Take the next image, and lock or verify if it is time to."""
        self._count += 1
        if self._proof is not None:
            self._verify(image, *self._proof)
        elif not self._done and self._count >= SETTLING_IMAGES and self._count % POLL_IMAGES == 0:
            self._lock_if_settled(image)

    def release(self) -> None:
        """Switch the control to automatic again."""
        if self._is_supported() and self._capture.get(self._control.mode) == self._control.manual:
            self._capture.set(self._control.mode, self._automatic)

    def _lock_if_settled(self, image: Image | bytes) -> None:
        value = self._capture.get(self._control.value)
        if value == self._last_value:
            before = brightness(image)
            if self._lock(value, "locked at") and self._control is EXPOSURE:
                self._proof = self._count + PROOF_IMAGES, before
        elif self._count >= MAX_SETTLING_IMAGES:
            self._finish(False, "left automatic: it does not settle")
        self._last_value = value

    def _verify(self, image: Image | bytes, due: int, before: float) -> None:
        if self._count < due:
            return
        self._proof = None
        if abs(brightness(image) - before) > MAX_BRIGHTNESS_CHANGE * max(before, 1.0):
            self.release()
            self._finish(False, "left automatic: the camera does not report the value it chose")

    def _lock(self, value: float, verb: str) -> bool:
        control, capture = self._control, self._capture
        # The mode first: in automatic mode drivers ignore a value, or take it and change it again.
        capture.set(control.mode, control.manual)
        capture.set(control.value, value)
        actual = capture.get(control.value)
        if capture.get(control.mode) != control.manual:
            self._finish(False, "refused: the camera stays automatic")
        elif abs(actual - value) > READ_BACK_TOLERANCE * max(abs(value), 1.0):
            self.release()
            self._finish(False, f"refused: the camera reports {control.text(actual)}")
        else:
            self._finish(True, f"{verb} {control.text(actual)}")
        return self.setting.applied

    def _is_supported(self) -> bool:
        # OpenCV returns −1 for a control that the driver does not have.
        control = self._control
        return min(self._capture.get(control.mode), self._capture.get(control.value)) >= 0

    def _finish(self, applied: bool, detail: str) -> None:
        self.setting = DeviceSetting(self._control.name, applied, detail)
        self._done = True


def brightness(image: Image | bytes) -> float:
    """Return the mean grey level, from an eighth of the image's size."""
    if isinstance(image, bytes):
        if not is_decodable(image):
            return 0.0
        small = cv2.imdecode(np.frombuffer(image, np.uint8), cv2.IMREAD_REDUCED_GRAYSCALE_8)
        return 0.0 if small is None else float(small.mean())
    return float(image[::8, ::8].mean())
