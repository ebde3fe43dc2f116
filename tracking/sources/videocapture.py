"""What is used of `cv2.VideoCapture`, and how it is opened here."""

import sys
from typing import Any, Protocol

import cv2

BACKENDS = {"linux": cv2.CAP_V4L2, "win32": cv2.CAP_DSHOW, "darwin": cv2.CAP_AVFOUNDATION}
"""One for each system: to try them all takes seconds and prints what each of them misses.

DirectShow, as Media Foundation needs up to half a minute to open some cameras.
"""


class VideoCapture(Protocol):
    """What is used of `cv2.VideoCapture`."""

    def isOpened(self) -> bool: ...  # noqa: D102, N802  # OpenCV's names
    def set(self, prop: int, value: float) -> bool: ...  # noqa: D102
    def get(self, prop: int) -> float: ...  # noqa: D102
    def read(self) -> tuple[bool, Any]: ...  # noqa: D102
    def release(self) -> None: ...  # noqa: D102


def open_capture(device: int | str) -> VideoCapture:
    """Open OpenCV's capture of this system, without its messages: errors are said in our words."""
    cv2.utils.logging.setLogLevel(cv2.utils.logging.LOG_LEVEL_SILENT)
    backend = BACKENDS.get(sys.platform, cv2.CAP_ANY)
    return cv2.VideoCapture(device, backend)
