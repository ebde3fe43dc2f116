"""Play a whole afternoon with real key presses: `python -m tests.campaigns.afternoon`.

The program runs on a virtual desktop (Xvfb, xdotool), with a camera on the network that shows a
bundled recording. Screenshots of all that a person would see are kept for looking at. The exit code
is 1 if something did not happen.
"""

import argparse
import shutil
import sys
import time
from pathlib import Path
from tempfile import TemporaryDirectory

import cv2
import numpy as np
from numpy.typing import NDArray

from tests.campaigns.afternoon.desktop import AfternoonError, Desktop
from tests.campaigns.afternoon.scenes import SCENES, Afternoon
from tests.campaigns.phone import jpegs, phone


def main() -> None:
    """Play the scenes, and report each in a line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--scenes", nargs="+", choices=SCENES, default=list(SCENES))
    parser.add_argument("--screenshots", type=Path, help="folder for what the screen showed")
    options = parser.parse_args()
    for tool in ("Xvfb", "xdotool"):
        if shutil.which(tool) is None:
            sys.exit(f"{tool} is not installed")
    failed = 0
    with Desktop() as desktop, phone(jpegs()) as (camera, server):
        for name in options.scenes:
            start = time.monotonic()
            with TemporaryDirectory() as folder:
                look = _Camera(desktop, options.screenshots, name)
                problem = ""
                try:
                    SCENES[name](Afternoon(desktop, server, camera, Path(folder), look.take))
                except AfternoonError as error:
                    look.take("failed")
                    problem, failed = f": {error}", failed + 1
            verdict = "failed" if problem else "went well"
            print(f"{name} {verdict} after {time.monotonic() - start:.0f} s{problem}", flush=True)  # noqa: T201
    sys.exit(1 if failed else 0)


class _Camera:
    """Keeps screenshots of one scene in a folder, if there is one."""

    def __init__(self, desktop: Desktop, folder: Path | None, scene: str) -> None:
        self._desktop, self._folder, self._scene = desktop, folder, scene
        self._taken = 0

    def take(self, name: str) -> NDArray[np.uint8]:
        picture = self._desktop.screenshot()
        self._taken += 1
        if self._folder is not None:
            self._folder.mkdir(parents=True, exist_ok=True)
            title = f"{self._scene}-{self._taken}-{name}".replace(" ", "-")
            cv2.imwrite(str(self._folder / f"{title}.png"), picture)
        return picture


main()
