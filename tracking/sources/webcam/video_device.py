"""Finding a camera's device and opening it with OpenCV."""

import os
import sys
from pathlib import Path
from typing import Any, Protocol

import cv2

from cubeling.tracking.errors import NoCameraError

BACKENDS = {"linux": cv2.CAP_V4L2, "win32": cv2.CAP_DSHOW, "darwin": cv2.CAP_AVFOUNDATION}
"""OpenCV's backend on each system: trying all of them takes seconds and prints warnings, and Media
Foundation takes up to half a minute to open some cameras."""

LINKS_BY_ID = Path("/dev/v4l/by-id")
"""Where Linux keeps links from cameras' names and serial numbers to their device files."""


class VideoCapture(Protocol):
    """The part of `cv2.VideoCapture` that is used here."""

    def isOpened(self) -> bool: ...  # noqa: D102, N802  # OpenCV's names
    def set(self, prop: int, value: float) -> bool: ...  # noqa: D102
    def get(self, prop: int) -> float: ...  # noqa: D102
    def read(self) -> tuple[bool, Any]: ...  # noqa: D102
    def release(self) -> None: ...  # noqa: D102


def open_capture(device: int | str) -> VideoCapture:
    """Open a camera with this system's backend, without OpenCV's own messages."""
    cv2.utils.logging.setLogLevel(cv2.utils.logging.LOG_LEVEL_SILENT)
    return cv2.VideoCapture(device, BACKENDS.get(sys.platform, cv2.CAP_ANY))


def persistent_path(path: Path, links: Path = LINKS_BY_ID) -> Path:
    """Return a path that leads to the same camera after it was plugged in again.

    That is the link with the camera's name, if there is one. Two cameras of one model without
    serial numbers share a link, which may then lead to the other camera.
    """
    if links.is_dir():
        target = path.resolve()
        for link in sorted(links.iterdir()):
            if link.resolve() == target:
                return link
    return path


def check_present(device: int | str, path: Path) -> None:
    """Check that a camera exists and may be opened, as OpenCV does not say why it fails.

    Raises
    ------
    NoCameraError
        There is no such camera, or this user may not open it.
    """
    if sys.platform != "linux":
        return
    if not path.exists():
        others = sorted(str(other) for other in Path("/dev").glob("video*"))
        there = (
            f"there are {', '.join(others)}"
            if others
            else "no camera is connected; --source FILE takes a video or a recording"
        )
        raise NoCameraError(f"camera {device} does not exist ({path}): {there}")
    if not os.access(path, os.R_OK | os.W_OK):
        raise NoCameraError(
            f"no permission to open camera {device}: run 'sudo usermod -aG video $USER', "
            "then log out and in again"
        )
