"""Encoding the pictures for the pages, on a thread of its own."""

import threading
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field

import cv2
import numpy as np
from numpy.typing import NDArray

from cubeling.app.ui.web.client import Look
from cubeling.app.ui.web.fineness import FINENESSES, Fineness

Picture = NDArray[np.uint8]


@dataclass(frozen=True)
class PagePicture:
    """A picture of one step for the pages; see `client.ShownPicture`."""

    number: int
    """Of the picture, from 1; a page names it when it has shown it."""

    page: str
    """The page whose camera has taken its frame; "" for another camera."""

    page_time: float
    """When, by the clock of that page [s]."""

    encoded: dict[Look, bytes] = field(default_factory=dict)
    """It, by how somebody looks at it."""

    def data(self, look: Look) -> bytes | None:
        """Return it encoded, if need be in another fineness; None if nobody wanted that kind."""
        same = (data for (kind, _), data in self.encoded.items() if kind == look[0])
        return self.encoded.get(look) or next(same, None)

    def taken(self, page: str) -> float:
        """Return when its frame was taken, by the clock of a page; 0 if by another camera."""
        return self.page_time if page == self.page else 0.0


class PictureEncoder:
    """Encodes the newest pictures and hands them on; what comes too quickly is left out.

    Parameters
    ----------
    show
        Called with each encoded picture, on the encoder's thread.
    """

    def __init__(self, show: Callable[[PagePicture], object]) -> None:
        self._show = show
        self._changed = threading.Condition()
        self._newest: tuple[PagePicture, dict[str, Picture], Iterable[Look]] | None = None
        self._closing = False
        self._thread = threading.Thread(target=self._run, name="page pictures", daemon=True)
        self._thread.start()

    def encode(
        self, picture: PagePicture, pixels: dict[str, Picture], wanted: Iterable[Look]
    ) -> None:
        """Encode pixels of some kinds as they are wanted; nobody changes them any more."""
        with self._changed:
            self._newest = picture, pixels, wanted
            self._changed.notify()

    def close(self) -> None:
        """End the thread; a second call does nothing."""
        with self._changed:
            self._closing = True
            self._changed.notify()
        self._thread.join(2.0)

    def _run(self) -> None:
        while True:
            with self._changed:
                self._changed.wait_for(lambda: self._closing or self._newest is not None)
                if self._closing or self._newest is None:
                    return
                (picture, pixels, wanted), self._newest = self._newest, None
            for kind, level in wanted:
                picture.encoded[kind, level] = encoded(pixels[kind], FINENESSES[level])
            self._show(picture)


def encoded(image: Picture, fineness: Fineness = FINENESSES[0]) -> bytes:
    """Return a picture as JPEG, (H, W, 3) BGR, or as WebP, (H, W, 4) BGRA."""
    if fineness.scale != 1.0:
        size = [max(round(fineness.scale * side), 1) for side in image.shape[1::-1]]
        image = np.asarray(cv2.resize(image, size, interpolation=cv2.INTER_AREA), np.uint8)
    clear = image.shape[2] == 4
    setting = cv2.IMWRITE_WEBP_QUALITY if clear else cv2.IMWRITE_JPEG_QUALITY
    done, data = cv2.imencode(".webp" if clear else ".jpg", image, (setting, fineness.quality))
    assert done, "OpenCV encodes any picture of a camera's size"
    return data.tobytes()


CUT_OUT_STEP = 6
"""Change of a pixel from which on something was drawn there, of 255."""

GREY_SPREAD = 0.06
"""A pixel that is darker in all colours by nearly the same share lies in a shadow."""


def cut_out(picture: Picture, camera: Picture) -> Picture:
    """Return what was drawn over the camera's picture, (H, W, 4) BGRA: the rest is transparent.

    A shadow, which darkens the camera's picture, becomes black that lets as much through.
    """
    changed = cv2.absdiff(picture, camera).max(axis=2) > CUT_OUT_STEP
    result = cv2.cvtColor(picture, cv2.COLOR_BGR2BGRA)
    result[..., 3] = 255 * changed
    drawn, seen = picture[changed].astype(np.float32), camera[changed].astype(np.float32)
    shares = drawn / np.maximum(seen, 1.0)
    light = shares.mean(axis=1)
    shadow = (light < 1.0) & (np.ptp(shares, axis=1) < GREY_SPREAD)
    dark = np.zeros((int(shadow.sum()), 4), np.uint8)
    dark[:, 3] = np.round(255 * (1.0 - light[shadow]))
    of_changed = result[changed]
    of_changed[shadow] = dark
    result[changed] = of_changed
    return np.asarray(result, np.uint8)
