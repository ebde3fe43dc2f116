"""A live device that delivers images, and the health of the source that reads it."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal, Protocol, TypeAlias

import cv2
import numpy as np

from cubeling.tracking.geometry.arrays import Image

Clock: TypeAlias = Callable[[], float]
"""Returns the time [s]."""

SourceState: TypeAlias = Literal["running", "lost", "frozen", "recovering", "closed"]
"""Running; disconnected or silent; repeating the same image; open again, but no image yet."""


@dataclass(frozen=True)
class DeviceSetting:
    """A setting that was requested from a device, and the result."""

    name: str
    """ "exposure", "focus", "buffers"."""

    applied: bool
    """Whether the device uses it, according to the value read back."""

    detail: str
    """The result as text: "locked at 15.6 ms", "the camera has no such setting"."""


@dataclass(frozen=True)
class Health:
    """The state of a live source at one moment."""

    name: str
    """Name of the source in messages: "camera 0"."""

    state: SourceState
    """Whether new images arrive, and if not, why."""

    since: float
    """On the source's clock [s]: since when it runs; while it does not, when the last new image
    arrived."""

    problem: str = ""
    """Why it does not run, one line; "" if it runs."""

    frames: int = 0
    """Number of frames returned."""

    dropped: int = 0
    """Number of images that were replaced by newer ones before they were requested."""

    gaps: int = 0
    """How often the source was lost or frozen."""

    rate: float = 0.0
    """Recent rate [images/s]; 0 if unknown."""

    latency: float = 0.0
    """Recent median time from an image's timestamp until it was returned [s]."""

    mean_queue: float = 0.0
    """Recent mean number of images waiting in the driver's queue."""

    max_queue: int = 0
    """Largest number of images ever waiting in the driver's queue."""

    stamped_by: Literal["driver", "arrival"] = "arrival"
    """Origin of the last timestamp: the driver, or the arrival, which is later by the delay of
    camera and cable."""

    settings: tuple[DeviceSetting, ...] = ()
    """What was requested from the device."""

    frozen: bool = False
    """Whether the current loss is, or before reopening was, a frozen image."""

    @property
    def running(self) -> bool:
        """Whether new images arrive."""
        return self.state == "running"


@dataclass(frozen=True)
class CapturedImage:
    """An image as delivered by a device."""

    data: Image | bytes
    """Pixels, or a JPEG."""

    taken: float
    """Best known time of exposure [s]."""


class Device(Protocol):
    """A device that delivers images. Used by the capture thread only, except for `interrupt`."""

    rate: float
    """Nominal rate [images/s]."""

    @property
    def settings(self) -> tuple[DeviceSetting, ...]:
        """What was requested from the device."""
        ...

    @property
    def exposed(self) -> float | None:
        """Exposure time of the last image according to the driver [s]; None if unknown."""
        ...

    def read(self) -> Image | bytes | None:
        """Wait for the next image: pixels or a JPEG; None if there was none.

        Raises
        ------
        TrackingError
            No more images will come.
        """
        ...

    def interrupt(self) -> None:
        """Make a blocked `read` return soon, if possible. Called from another thread."""
        ...

    def close(self) -> None:
        """Release the device; a second call does nothing."""
        ...


def decode_jpeg(data: bytes) -> Image | None:
    """Decode a JPEG to BGR; None if the data is not a complete JPEG.

    A truncated image is refused before libjpeg, which would fill it with grey and print a warning.
    """
    if not data.startswith(b"\xff\xd8") or b"\xff\xd9" not in data:
        return None
    image = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_COLOR)
    return None if image is None else np.asarray(image, np.uint8)
