"""A live device that delivers images, and the health of the source that reads it."""

import struct
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal, Protocol, TypeAlias

import cv2
import numpy as np

from cubeling.tracking.geometry.arrays import Image

Clock: TypeAlias = Callable[[], float]
"""Returns the time [s]."""

MAX_IMAGE_PX = 2**26
"""Most pixels of an image that is decoded: twice those of an 8K camera."""

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

    unusable: int = 0
    """Number of images that were left out: broken, or of another size than the first one."""

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

    images_unusable: bool = False
    """Whether the current loss is of images that arrive and cannot be used."""

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


def jpeg_size(data: bytes) -> tuple[int, int] | None:
    """Return the width and height in a JPEG's header [px]; None if the data has no such header.

    They are in the segment that starts a frame (ITU-T T.81, section B.2.2). EXIF data before it may
    hold a small JPEG of its own, which is skipped with them.
    """
    position = 2
    while data[position : position + 1] == b"\xff" and position + 9 <= len(data):
        marker = data[position + 1]
        if marker == 0xFF:  # any number of them may precede a marker
            position += 1
        elif 0xC0 <= marker <= 0xCF and marker not in (0xC4, 0xC8, 0xCC):
            height, width = struct.unpack_from(">HH", data, position + 5)
            return width, height
        else:
            position += 2 + int.from_bytes(data[position + 2 : position + 4])
    return None


def is_decodable(data: bytes) -> bool:
    """Return whether data is a complete JPEG of at most `MAX_IMAGE_PX`, by its header and end.

    A truncated image is refused before libjpeg, which would fill it with grey and print a warning;
    and one whose header claims too much before OpenCV, which would raise or fill the memory.
    """
    size = jpeg_size(data) if data.startswith(b"\xff\xd8") and b"\xff\xd9" in data else None
    return size is not None and 0 < size[0] * size[1] <= MAX_IMAGE_PX


def decode_jpeg(data: bytes) -> Image | None:
    """Decode a JPEG to BGR; None if it cannot be decoded, see `is_decodable`."""
    if not is_decodable(data):
        return None
    image = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_COLOR)
    return None if image is None else np.asarray(image, np.uint8)


UNDECODED_BGR = 128
"""Grey value of the blocks of a JPEG for which there are no data, in all colours."""

FILLER = b"\x55" * 64
"""Bytes that libjpeg reads as further blocks where those of an image are missing."""


def is_cut_short(data: bytes, image: Image) -> bool:
    """Return whether data of a JPEG are missing before its end, by what was decoded from it.

    libjpeg fills the rest with grey. Most images show by a corner that they are whole; one that is
    grey there is decoded again with more data, which a whole image ignores.
    """
    corners = image[[0, 0, -1, -1], [0, -1, 0, -1]]
    if not (corners == UNDECODED_BGR).all(axis=1).any():
        return False
    end = data.rfind(b"\xff\xd9")
    longer = decode_jpeg(data[:end] + FILLER + data[end:])
    return not np.array_equal(image, longer) if longer is not None else True
