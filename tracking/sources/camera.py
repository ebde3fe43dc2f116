"""Frames from a webcam; its own JPEG bytes where the driver gives them."""

import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import TypeAlias

import cv2
import numpy as np
from numpy.typing import NDArray

from tracking.errors import TrackingError
from tracking.sources.camera_options import CameraOptions
from tracking.sources.device import Clock
from tracking.sources.devices import check_present, device_path, lasting_path
from tracking.sources.health import Setting
from tracking.sources.live import LiveSource
from tracking.sources.locking import EXPOSURE, FOCUS, MS, Lock
from tracking.sources.pictures import Picture
from tracking.sources.videocapture import VideoCapture, open_capture

MJPG = cv2.VideoWriter.fourcc(*"MJPG")
"""At 1280x720 most cameras reach 30 frames a second only in this format."""

OpenCapture: TypeAlias = Callable[[int | str], VideoCapture]


class CameraSource(LiveSource):
    """A webcam.

    Parameters
    ----------
    device
        Its number, or its path such as "/dev/video0". Unplugged and plugged in again, it is found
        by its own name, where Linux knows that, even if its number has moved.
    size
        Width and height to ask for [px]; the camera may answer with others.
    options
        What else to ask of it.
    clock
        Seconds; stamps the frames where the driver does not.
    capture
        Opens the device; another one serves tests.

    Raises
    ------
    TrackingError
        The camera is not there, or gave no picture for 2 s.
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
        opener = capture or _finder(device)
        asked = options or CameraOptions()
        super().__init__(lambda: CaptureDevice(opener(device), name, size, asked), name, clock)

    @classmethod
    def from_uri(cls, rest: str, size: tuple[int, int], clock: Clock) -> "CameraSource":
        """Open what stands behind "camera:"; nothing means the first camera.

        Raises
        ------
        TrackingError
            An option behind "?" is unknown or has no such value, or the camera does not open.
        """
        device, options = CameraOptions.parse(rest)
        number = int(device or 0) if (device or "0").isdecimal() else device
        return cls(number, size, options=options, clock=clock)


class CaptureDevice:
    """A camera behind OpenCV's `VideoCapture`."""

    def __init__(
        self, capture: VideoCapture, name: str, size: tuple[int, int], options: CameraOptions
    ) -> None:
        self._capture = capture
        if not capture.isOpened():
            capture.release()
            raise TrackingError(
                f"{name} does not open: another program may use it, or it is no camera; "
                "close the other program, or try the next number"
            )
        self.exposed: float | None = None
        # The format first: the sizes that a camera offers depend on it.
        capture.set(cv2.CAP_PROP_FOURCC, MJPG)
        capture.set(cv2.CAP_PROP_FRAME_WIDTH, size[0])
        capture.set(cv2.CAP_PROP_FRAME_HEIGHT, size[1])
        # Only V4L2 hands out the JPEG bytes; settings are read back, as drivers refuse silently.
        honoured = int(capture.get(cv2.CAP_PROP_FOURCC)) == MJPG
        if sys.platform == "linux" and honoured:
            capture.set(cv2.CAP_PROP_CONVERT_RGB, 0)
        rate = capture.get(cv2.CAP_PROP_FPS)
        self.rate = float(rate) if 1 <= rate <= 1000 else 30.0
        self._buffers = _ask_buffers(capture, options.buffers)
        self._locks = _locks(capture, options)

    @property
    def settings(self) -> tuple[Setting, ...]:
        """What the camera was asked for, and what became of it."""
        return self._buffers, *(lock.setting for lock in self._locks)

    def read(self) -> Picture | bytes | None:
        """Wait for the next picture."""
        good, given = self._capture.read()
        picture = _picture(given) if good and given is not None else None
        if picture is not None:
            # V4L2: the buffer's own time, milliseconds of CLOCK_MONOTONIC; elsewhere anything,
            # so `ExposureClock` holds it against the clock.
            self.exposed = self._capture.get(cv2.CAP_PROP_POS_MSEC) / 1000.0
            for lock in self._locks:
                lock.look(picture)
        return picture

    def interrupt(self) -> None:
        """Nothing can stop a driver that waits."""

    def close(self) -> None:
        """Release the camera, and leave its automatics on for whoever opens it next."""
        for lock in self._locks:
            lock.release()
        self._capture.release()


def _finder(device: int | str) -> OpenCapture:
    """Return what opens a camera, and opens the same one again wherever it was plugged in."""
    given = device_path(device)
    check_present(device, given)
    if sys.platform != "linux":
        return open_capture
    path = lasting_path(given)

    def find(_: int | str) -> VideoCapture:
        check_present(device, path)
        return open_capture(str(Path(path).resolve()))

    return find


def _ask_buffers(capture: VideoCapture, count: int) -> Setting:
    capture.set(cv2.CAP_PROP_BUFFERSIZE, count)
    given = int(capture.get(cv2.CAP_PROP_BUFFERSIZE))
    if given <= 0:
        return Setting("buffers", False, "the driver does not tell how many it has")
    return Setting("buffers", given == count, f"{given}, asked for {count}")


def _locks(capture: VideoCapture, options: CameraOptions) -> tuple[Lock, ...]:
    if sys.platform != "linux":  # the other systems' drivers take and tell other numbers
        return ()
    exposure = None if options.exposure is None else options.exposure * MS
    wanted = ((EXPOSURE, exposure), (FOCUS, options.focus))
    return tuple(
        Lock(capture, knob, value) for knob, value in wanted if options.lock or value is not None
    )


def _picture(given: NDArray[np.uint8]) -> Picture | bytes | None:
    """Tell a JPEG from pixels by the shape in which OpenCV gives it."""
    if 1 in given.shape[:2] or given.ndim == 1:
        return _trimmed(given.tobytes())
    if given.ndim == 2:
        return np.asarray(cv2.cvtColor(given, cv2.COLOR_GRAY2BGR), np.uint8)
    if given.shape[2] == 2:  # the camera does not do MJPG after all
        return np.asarray(cv2.cvtColor(given, cv2.COLOR_YUV2BGR_YUY2), np.uint8)
    return given


def _trimmed(data: bytes) -> bytes:
    """Drop what follows the picture: some drivers give their whole buffer, old frames and all.

    Behind the start of scan (FF DA), FF D9 can be nothing but the end of the picture.
    """
    end = data.find(b"\xff\xd9", max(data.find(b"\xff\xda"), 0))
    return data if end < 0 else data[: end + 2]
