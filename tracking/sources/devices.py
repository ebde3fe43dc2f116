"""Which camera is meant: its number may move when it is plugged in again, its name does not."""

import os
import sys
from pathlib import Path

from tracking.errors import TrackingError

BY_ID = Path("/dev/v4l/by-id")
"""Where Linux keeps links from the names and serial numbers of cameras to their numbers."""


def device_path(device: int | str) -> Path:
    """Return the file of a camera, given its number or its path.

    >>> device_path(2).as_posix()
    '/dev/video2'
    """
    return Path(f"/dev/video{device}" if isinstance(device, int) else device)


def lasting_path(path: Path, links: Path = BY_ID) -> Path:
    """Return a path that leads to the same camera after it was unplugged and plugged in again.

    That is the link of the camera's own name, where there is one. If two like cameras without
    serial numbers share a name, Linux gives them one link; then it may lead to the other.
    """
    if links.is_dir():
        target = path.resolve()
        for link in sorted(links.iterdir()):
            if link.resolve() == target:
                return link
    return path


def check_present(device: int | str, path: Path) -> None:
    """Say what is missing before OpenCV says less.

    Raises
    ------
    TrackingError
        There is no such camera, or this user may not open it.
    """
    if sys.platform != "linux":
        return
    if not path.exists():
        others = sorted(str(other) for other in Path("/dev").glob("video*"))
        there = f"there are {', '.join(others)}" if others else "no camera is connected"
        raise TrackingError(f"camera {device} is not there ({path}): {there}")
    if not os.access(path, os.R_OK | os.W_OK):
        raise TrackingError(
            f"camera {device} may not be opened by you: run 'sudo usermod -aG video $USER', "
            "then log out and in again"
        )
