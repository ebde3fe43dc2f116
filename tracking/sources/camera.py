"""Frames from a webcam; its own JPEG bytes where the driver gives them."""

import os
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, Protocol, TypeAlias

import cv2
import numpy as np
from numpy.typing import NDArray

from tracking.errors import TrackingError
from tracking.sources.live import Clock, LiveSource
from tracking.sources.pictures import Picture

BACKENDS = {"linux": cv2.CAP_V4L2, "win32": cv2.CAP_DSHOW, "darwin": cv2.CAP_AVFOUNDATION}
"""One for each system: to try them all takes seconds and prints what each of them misses.

DirectShow, as Media Foundation needs up to half a minute to open some cameras.
"""

MJPG = cv2.VideoWriter.fourcc(*"MJPG")
"""At 1280x720 most cameras reach 30 frames a second only in this format."""


class VideoCapture(Protocol):
    """What is used of `cv2.VideoCapture`."""

    def isOpened(self) -> bool: ...  # noqa: D102, N802  # OpenCV's names
    def set(self, prop: int, value: float) -> bool: ...  # noqa: D102
    def get(self, prop: int) -> float: ...  # noqa: D102
    def read(self) -> tuple[bool, Any]: ...  # noqa: D102
    def release(self) -> None: ...  # noqa: D102


OpenCapture: TypeAlias = Callable[[int | str], VideoCapture]


class CameraSource(LiveSource):
    """A webcam.

    Parameters
    ----------
    device
        Its number, or its path such as "/dev/video0".
    size
        Width and height to ask for [px]; the camera may answer with others.
    clock
        Seconds; stamps the frames.
    capture
        Opens the device; another one serves tests.

    Raises
    ------
    TrackingError
        The camera is not there, or gave no new picture for 2 s.
    """

    def __init__(
        self,
        device: int | str,
        size: tuple[int, int],
        *,
        clock: Clock = time.monotonic,
        capture: OpenCapture | None = None,
    ) -> None:
        if capture is None:
            _check_present(device)
        opener = capture or open_capture
        name = f"camera {device}"
        super().__init__(lambda: CaptureDevice(opener(device), name, size), name, clock)

    @classmethod
    def from_uri(cls, rest: str, size: tuple[int, int], clock: Clock) -> "CameraSource":
        """Open what stands behind "camera:"; nothing means the first camera."""
        return cls(int(rest or 0) if (rest or "0").isdecimal() else rest, size, clock=clock)


class CaptureDevice:
    """A camera behind OpenCV's `VideoCapture`."""

    def __init__(self, capture: VideoCapture, name: str, size: tuple[int, int]) -> None:
        self._capture = capture
        if not capture.isOpened():
            capture.release()
            raise TrackingError(
                f"{name} does not open: another program may use it, or it is no camera; "
                "close the other program, or try the next number"
            )
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

    def read(self) -> Picture | bytes | None:
        """Wait for the next picture."""
        good, picture = self._capture.read()
        return _picture(picture) if good and picture is not None else None

    def interrupt(self) -> None:
        """Nothing can stop a driver that waits."""

    def close(self) -> None:
        """Release the camera."""
        self._capture.release()


def open_capture(device: int | str) -> VideoCapture:
    """Open OpenCV's capture of this system, without its messages: errors are said in our words."""
    cv2.utils.logging.setLogLevel(cv2.utils.logging.LOG_LEVEL_SILENT)
    backend = BACKENDS.get(sys.platform, cv2.CAP_ANY)
    return cv2.VideoCapture(device, backend)


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


def _check_present(device: int | str) -> None:
    """Say what is missing before OpenCV says less."""
    if sys.platform != "linux":
        return
    path = Path(f"/dev/video{device}" if isinstance(device, int) else device)
    if not path.exists():
        others = sorted(str(other) for other in Path("/dev").glob("video*"))
        there = f"there are {', '.join(others)}" if others else "no camera is connected"
        raise TrackingError(f"camera {device} is not there ({path}): {there}")
    if not os.access(path, os.R_OK | os.W_OK):
        raise TrackingError(
            f"camera {device} may not be opened by you: run 'sudo usermod -aG video $USER', "
            "then log out and in again"
        )
