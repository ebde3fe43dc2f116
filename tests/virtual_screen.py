"""A screen without a monitor (Xvfb), what it shows, and where programs on it keep their files."""

import os
import shutil
import subprocess
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Self

import numpy as np
from numpy.typing import NDArray

HEADER_FIELDS = 25
"""32-bit numbers in the header of an X window dump, as far as they are needed."""


class VirtualScreen:
    """An X server of its own, whose screen is a file: nothing has to be installed to see it.

    Parameters
    ----------
    size
        Width and height [px].
    """

    def __init__(self, size: tuple[int, int] = (1600, 900)) -> None:
        self._folder = TemporaryDirectory()
        folder = self._folder.name
        screen = f"{size[0]}x{size[1]}x24"
        self._server = subprocess.Popen(
            [
                "Xvfb",
                "-displayfd",
                "1",
                "-screen",
                "0",
                screen,
                "-fbdir",
                folder,
                "-nolisten",
                "tcp",
            ],
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
        )
        assert self._server.stdout is not None
        self.display = f":{int(self._server.stdout.readline())}"
        """Its name for `DISPLAY`."""
        # Where the systems keep preferences: programs do not meet those of the user.
        own = dict.fromkeys(("HOME", "XDG_CONFIG_HOME", "APPDATA"), folder)
        self.environment = {**os.environ, **own, "DISPLAY": self.display, "COLUMNS": "120"}
        """For programs that run on it."""
        self.file = Path(folder) / "Xvfb_screen0"
        """What it shows, for `screen_pixels`."""

    @staticmethod
    def installed() -> bool:
        """Return whether this computer has Xvfb."""
        return shutil.which("Xvfb") is not None

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._server.terminate()
        self._server.wait(timeout=10)
        assert self._server.stdout is not None
        self._server.stdout.close()
        self._folder.cleanup()

    def pixels(self) -> NDArray[np.uint8]:
        """Return what it shows, (height, width, 4) BGRX, always as it is now."""
        return screen_pixels(self.file)


def screen_pixels(path: Path) -> NDArray[np.uint8]:
    """Return what a virtual screen shows by its file, (height, width, 4) BGRX, always as it is now.

    The file is an X window dump: a header of big-endian numbers, a colour map, and the pixels.
    """
    header = np.fromfile(path, ">u4", HEADER_FIELDS)
    start, width, height, colors = (int(header[index]) for index in (0, 4, 5, 19))
    return np.memmap(path, np.uint8, "r", start + 12 * colors, (height, width, 4))
