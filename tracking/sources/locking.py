"""Exposure and focus, held still: an automatic that hunts moves and blurs the cube's edges."""

from dataclasses import dataclass

import cv2
import numpy as np

from tracking.sources.health import Setting
from tracking.sources.pictures import Picture
from tracking.sources.videocapture import VideoCapture

SETTLING = 30
"""Pictures in which the automatics find their values, before anything is locked."""

BETWEEN = 15
"""Pictures between two looks at a value: it has settled once two looks agree."""

HOPELESS = 150
"""A value that has not settled after so many pictures is left to its automatic."""

PROVING = 10
"""Pictures after which a locked exposure must still give the same brightness."""

CHANGED = 0.25
"""A brightness that is off by more than this share has changed."""

TOLERANCE = 0.05
"""A value that is read back within this share is the one that was set: drivers have steps."""

MANUAL, AUTOMATIC = 1.0, 3.0
"""Exposure modes of V4L2: V4L2_EXPOSURE_MANUAL, V4L2_EXPOSURE_APERTURE_PRIORITY."""

MS = 10.0
"""Units of V4L2's exposure in a millisecond: they are 100 µs long."""


@dataclass(frozen=True)
class Knob:
    """A setting with an automatic, as V4L2 has them."""

    name: str
    """ "exposure" or "focus"."""

    switch: int
    """OpenCV's property that turns the automatic on and off."""

    on: float
    """What turns it on."""

    off: float
    """What turns it off."""

    value: int
    """OpenCV's property of the value itself."""

    def words(self, value: float) -> str:
        """Return a value in words.

        >>> EXPOSURE.words(156.0), FOCUS.words(30.0)
        ('15.6 ms', '30')
        """
        return f"{value / MS:g} ms" if self.name == "exposure" else f"{value:g}"


EXPOSURE = Knob("exposure", cv2.CAP_PROP_AUTO_EXPOSURE, AUTOMATIC, MANUAL, cv2.CAP_PROP_EXPOSURE)
FOCUS = Knob("focus", cv2.CAP_PROP_AUTOFOCUS, 1.0, 0.0, cv2.CAP_PROP_FOCUS)


class Lock:
    """Locks one knob of a camera: at once at a given value, or at its own once that has settled.

    Each value is read back, as drivers refuse silently. Many cameras do not say what exposure
    their automatic has chosen, but an old or default one (opencv#5516): what was locked is
    therefore held against the brightness of the pictures, and undone if that changes.

    V4L2 keeps what is set after the camera is closed, so `release` turns the automatic on again,
    and so does the next start, in case the program was killed.

    Parameters
    ----------
    capture
        The open camera.
    knob
        What to lock.
    value
        In the driver's unit; None: the present one.
    """

    def __init__(self, capture: VideoCapture, knob: Knob, value: float | None = None) -> None:
        self._capture, self._knob = capture, knob
        self._seen = -1.0
        self._count = 0
        self._proof: tuple[int, float] | None = None
        self._done = False
        self.setting = Setting(knob.name, False, "still automatic")
        """What became of it."""
        present = capture.get(knob.switch)
        self._automatic = knob.on if present == knob.off else present
        if not self._supported():
            self._settle(False, "the camera has no such setting")
        elif value is not None:
            self._engage(value, "set to")
        else:
            self.release()

    def look(self, picture: Picture | bytes) -> None:
        """Take in the next picture, and do what is due."""
        self._count += 1
        if self._proof is not None:
            self._prove(picture)
        elif not self._done and self._count >= SETTLING and self._count % BETWEEN == 0:
            self._try(picture)

    def release(self) -> None:
        """Give the knob back to its automatic."""
        if self._supported() and self._capture.get(self._knob.switch) == self._knob.off:
            self._capture.set(self._knob.switch, self._automatic)

    def _try(self, picture: Picture | bytes) -> None:
        value = self._capture.get(self._knob.value)
        if value == self._seen:
            before = brightness(picture)
            if self._engage(value, "locked at") and self._knob is EXPOSURE:
                self._proof = self._count + PROVING, before
        elif self._count >= HOPELESS:
            self._settle(False, "left automatic: it does not come to rest")
        self._seen = value

    def _prove(self, picture: Picture | bytes) -> None:
        assert self._proof is not None  # asked by `look`
        due, before = self._proof
        if self._count < due:
            return
        self._proof = None
        if abs(brightness(picture) - before) > CHANGED * max(before, 1.0):
            self.release()
            self._settle(False, "left automatic: the camera does not tell the value it has chosen")

    def _engage(self, value: float, done: str) -> bool:
        knob, capture = self._knob, self._capture
        capture.set(knob.switch, knob.off)
        capture.set(knob.value, value)
        kept = capture.get(knob.value)
        if capture.get(knob.switch) != knob.off:
            self._settle(False, "refused: the camera keeps its automatic on")
        elif abs(kept - value) > TOLERANCE * max(abs(value), 1.0):
            self.release()
            self._settle(False, f"refused: the camera answers {knob.words(kept)}")
        else:
            self._settle(True, f"{done} {knob.words(kept)}")
        return self.setting.honoured

    def _supported(self) -> bool:
        # OpenCV answers −1 for a control that the driver does not have.
        return min(self._capture.get(self._knob.switch), self._capture.get(self._knob.value)) >= 0

    def _settle(self, honoured: bool, told: str) -> None:
        self.setting = Setting(self._knob.name, honoured, told)
        self._done = True


def brightness(picture: Picture | bytes) -> float:
    """Return the mean grey level, from an eighth of the picture's size."""
    if isinstance(picture, bytes):
        small = cv2.imdecode(np.frombuffer(picture, np.uint8), cv2.IMREAD_REDUCED_GRAYSCALE_8)
        return 0.0 if small is None else float(small.mean())
    return float(picture[::8, ::8].mean())
