"""Frames from a webcam, with the camera's own JPEG data if the driver provides it."""

import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar, TypeAlias

import cv2
import numpy as np

from cubeling.tracking.errors import TrackingError
from cubeling.tracking.geometry.arrays import Image
from cubeling.tracking.sources.device import Clock, DeviceSetting
from cubeling.tracking.sources.live import LiveSource
from cubeling.tracking.sources.webcam.camera_controls import EXPOSURE, FOCUS, ControlLock
from cubeling.tracking.sources.webcam.options import UriOptions
from cubeling.tracking.sources.webcam.video_device import (
    VideoCapture,
    check_present,
    open_capture,
    persistent_path,
)

MJPG = cv2.VideoWriter.fourcc(*"MJPG")
"""The only format in which most cameras reach 30 frames/s at 1280x720."""

DEFAULT_SIZE_PX = (1280, 720)
"""Size that is requested unless the caller says otherwise."""

OpenCapture: TypeAlias = Callable[[int | str], VideoCapture]


@dataclass(frozen=True)
class CameraOptions(UriOptions):
    """Settings of a camera.

    >>> CameraOptions.parse("camera:/dev/video2?exposure=8&lock=0")
    ('/dev/video2', CameraOptions(lock=False, exposure=8.0, focus=None, buffers=2))
    """

    LIMITS: ClassVar = {"exposure": (0.1, 1000.0), "focus": (0.0, 10000.0), "buffers": (1.0, 10.0)}

    lock: bool = True
    """Whether exposure and focus are locked once they have settled."""

    exposure: float | None = None
    """Exposure time [ms]: short against motion blur, long in the dark; None: as the automatic
    control has settled."""

    focus: float | None = None
    """In the driver's unit, often 0 (far) to 255 (near); None: as the automatic has settled."""

    buffers: int = 2
    """Number of images that the driver may queue: one is filled while the other is read. With a
    single buffer many drivers drop every other image (nokhwa#128, horus#60)."""


class CameraSource(LiveSource):
    """A webcam, opened by its number or by its path such as "/dev/video0".

    The camera may choose another size than the one requested [px]. On Linux, a camera that is
    plugged in again is found by its name even if its number has changed. `capture` opens the
    device; tests replace it.

    Raises
    ------
    TrackingError
        The camera does not exist, or delivered no image for 2 s.
    """

    def __init__(
        self,
        device: int | str,
        size: tuple[int, int],
        *,
        options: CameraOptions | None = None,
        clock: Clock = time.monotonic,
        capture: OpenCapture | None = None,
    ) -> None:
        name = f"camera {device}"
        opener = capture or _capture_opener(device)
        chosen = options or CameraOptions()
        super().__init__(lambda: CaptureDevice(opener(device), name, size, chosen), name, clock)


def open_uri(uri: str, size: tuple[int, int] | None, clock: Clock) -> CameraSource:
    """Open "camera:DEVICE?key=value"; without a device, the first camera."""
    text, options = CameraOptions.parse(uri)
    device = int(text or 0) if (text or "0").isdecimal() else text
    return CameraSource(device, size or DEFAULT_SIZE_PX, options=options, clock=clock)


class CaptureDevice:
    """A camera behind OpenCV's `VideoCapture`."""

    def __init__(
        self, capture: VideoCapture, name: str, size: tuple[int, int], options: CameraOptions
    ) -> None:
        self._capture = capture
        # OpenCV reports a device that does not open by a flag, never by an exception.
        if not capture.isOpened():
            capture.release()
            raise TrackingError(
                f"{name} does not open: another program may use it, or it is not a camera; "
                "close the other program, or try the next number"
            )
        self.exposed: float | None = None
        # The format first: the available sizes depend on it.
        capture.set(cv2.CAP_PROP_FOURCC, MJPG)
        capture.set(cv2.CAP_PROP_FRAME_WIDTH, size[0])
        capture.set(cv2.CAP_PROP_FRAME_HEIGHT, size[1])
        # Only V4L2 returns the JPEG data. Read the format back: drivers refuse silently.
        gives_jpeg = int(capture.get(cv2.CAP_PROP_FOURCC)) == MJPG
        if sys.platform == "linux" and gives_jpeg:
            capture.set(cv2.CAP_PROP_CONVERT_RGB, 0)
        rate = capture.get(cv2.CAP_PROP_FPS)
        # Drivers that do not know their rate report 0 or nonsense.
        self.rate = float(rate) if 1 <= rate <= 1000 else 30.0
        self._buffers = _request_buffers(capture, options.buffers)
        self._locks = _locks(capture, options)

    @property
    def settings(self) -> tuple[DeviceSetting, ...]:
        """What was requested from the camera, and the result."""
        return self._buffers, *(lock.setting for lock in self._locks)

    def read(self) -> Image | bytes | None:
        """Wait for the next image."""
        success, data = self._capture.read()
        image = _convert(data) if success and data is not None else None
        if image is not None:
            # V4L2 gives the buffer's time in milliseconds of CLOCK_MONOTONIC. Other systems give
            # arbitrary numbers, so `ExposureClock` compares them with the clock.
            self.exposed = self._capture.get(cv2.CAP_PROP_POS_MSEC) / 1000.0
            for lock in self._locks:
                lock.update(image)
        return image

    def interrupt(self) -> None:
        """Do nothing: a blocked driver cannot be interrupted."""

    def close(self) -> None:
        """Release the camera, with its automatic controls on for the next program."""
        for lock in self._locks:
            lock.release()
        self._capture.release()


def _capture_opener(device: int | str) -> OpenCapture:
    """Return a function that opens a camera, also after it was plugged in elsewhere."""
    path = Path(f"/dev/video{device}" if isinstance(device, int) else device)
    check_present(device, path)
    if sys.platform != "linux":
        return open_capture
    # /dev/videoN is numbered by order of plugging in; the name under /dev/v4l/by-id stays.
    path = persistent_path(path)

    def reopen(_: int | str) -> VideoCapture:
        check_present(device, path)
        return open_capture(str(path.resolve()))

    return reopen


def _request_buffers(capture: VideoCapture, count: int) -> DeviceSetting:
    capture.set(cv2.CAP_PROP_BUFFERSIZE, count)
    actual = int(capture.get(cv2.CAP_PROP_BUFFERSIZE))
    if actual <= 0:
        return DeviceSetting("buffers", False, "the driver does not report their number")
    return DeviceSetting("buffers", actual == count, f"{actual}, requested {count}")


def _locks(capture: VideoCapture, options: CameraOptions) -> tuple[ControlLock, ...]:
    if sys.platform != "linux":  # other systems' drivers use other units
        return ()
    exposure = None if options.exposure is None else options.exposure * EXPOSURE.units
    wanted = ((EXPOSURE, exposure), (FOCUS, options.focus))
    return tuple(
        ControlLock(capture, control, value)
        for control, value in wanted
        if options.lock or value is not None
    )


def _convert(data: Image) -> Image | bytes:
    """Tell JPEG data from pixels by its shape in OpenCV; convert pixels to BGR."""
    # With CONVERT_RGB off, OpenCV returns the JPEG's bytes as a single row or column.
    if 1 in data.shape[:2] or data.ndim == 1:
        return _trim(data.tobytes())
    if data.ndim == 2:
        return np.asarray(cv2.cvtColor(data, cv2.COLOR_GRAY2BGR), np.uint8)
    if data.shape[2] == 2:  # the camera does not use MJPG after all
        return np.asarray(cv2.cvtColor(data, cv2.COLOR_YUV2BGR_YUY2), np.uint8)
    return data


def _trim(data: bytes) -> bytes:
    """Cut the data off after the JPEG: some drivers return their whole buffer.

    After the start of scan (FF DA), FF D9 can only be the end of the image.
    """
    end = data.find(b"\xff\xd9", max(data.find(b"\xff\xda"), 0))
    return data if end < 0 else data[: end + 2]
