"""The lenses that play has measured, kept from one session to the next, one file for each camera.

A file is a camera file as `cubeling calibrate` writes it, named after the camera and the size of
its pictures. A calibration that the user names wins.
"""

import re
from pathlib import Path

from cubeling.app.errors import AppError
from cubeling.app.preferences import PreferenceStore
from cubeling.tracking import Intrinsics, TrackingError

FOLDER = "lenses"
"""Name of the folder beside the file of preferences."""

MAX_KEPT_DEVIATION = 0.05
"""A focal length that is less sure than this, as a share, is not worth keeping: the next session
finds as much in a second."""

MAX_NAME_LENGTH = 80
"""Characters of a camera's name in that of its file."""

VIDEO_DEVICES = Path("/sys/class/video4linux")
"""Where Linux says what its cameras are called."""


class LensStore:
    """Where the lenses of live cameras are kept.

    Parameters
    ----------
    preferences
        The folder is beside their file; without a file nothing is kept.
    """

    def __init__(self, preferences: PreferenceStore) -> None:
        self.problem = ""
        """Why a kept lens is not used, or one is not kept; "" if nothing is wrong."""
        self._folder = None if preferences.folder is None else preferences.folder / FOLDER

    def load(self, uri: str, size: tuple[int, int]) -> Intrinsics | None:
        """Return the lens that is kept for a camera and a size; None if there is none."""
        path = self._path(uri, size)
        if path is None or not path.exists():
            return None
        try:
            found = Intrinsics.load(path)
            if found.size != size:
                raise TrackingError(f"the camera file '{path}' is of another size: remove it")
        except TrackingError as error:
            self.problem = f"the kept lens is ignored: {error}"
            return None
        return found

    def save(self, uri: str, intrinsics: Intrinsics) -> Path | None:
        """Keep a lens that play has measured; return its file, None where it is not kept."""
        path, deviation = self._path(uri, intrinsics.size), intrinsics.focal_deviation
        if path is None or deviation is None or deviation > MAX_KEPT_DEVIATION:
            return None
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            intrinsics.save(path, camera_name(uri))
        except (OSError, TrackingError) as error:
            self.problem = f"the lens is not kept: {error}"
            return None
        return path

    def _path(self, uri: str, size: tuple[int, int]) -> Path | None:
        if self._folder is None:
            return None
        width, height = size
        return self._folder / f"{camera_name(uri)}-{width}x{height}.yaml"


def camera_name(uri: str) -> str:
    """Return the name of a camera for a file: its address, and on Linux what it is called.

    >>> camera_name("http://phone:8080/video?fps=30")
    'http-phone-8080-video'
    """
    address, _, place = uri.partition("?")[0].partition(":")
    number = place.removeprefix("/dev/video")
    called = VIDEO_DEVICES / f"video{number}" / "name"
    words = uri.partition("?")[0]
    if address == "camera" and number.isdecimal() and called.is_file():
        # Another camera may be camera:0 tomorrow.
        words += f" {called.read_text(errors='replace')}"
    return re.sub(r"[^A-Za-z0-9]+", "-", words).strip("-")[:MAX_NAME_LENGTH]


def intrinsics_for(intrinsics: Intrinsics | None, size: tuple[int, int]) -> Intrinsics:
    """Return intrinsics for pictures of `size`; guess them where `intrinsics` is None.

    Raises AppError if the calibration was made at another aspect ratio.
    """
    if intrinsics is None:
        return Intrinsics.guess(size)
    if intrinsics.size == size:
        return intrinsics
    if abs(intrinsics.size[1] * size[0] / intrinsics.size[0] - size[1]) > 1.0:
        raise AppError(
            f"the calibration is for {intrinsics.size[0]}x{intrinsics.size[1]} pictures, "
            f"the camera gives {size[0]}x{size[1]}: calibrate it at this size"
        )
    return intrinsics.scale(size)
