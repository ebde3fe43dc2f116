"""A virtual desktop with a keyboard and a mouse, and the programs that run on it."""

import signal
import subprocess
import sys
import time
from collections.abc import Callable
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from tests.virtual_screen import VirtualScreen

PATIENCE_S = 60.0
"""Longest wait for anything to happen on a busy computer with two cores."""

POLL_S = 0.1
"""Time between two looks at what is waited for."""


class AfternoonError(Exception):
    """Something did not happen as it should."""


def wait_for(what: str, happens: Callable[[], Any]) -> Any:
    """Return the first true result of `happens`; raise AfternoonError when patience ends."""
    end = time.monotonic() + PATIENCE_S
    while time.monotonic() < end:
        if result := happens():
            return result
        time.sleep(POLL_S)
    raise AfternoonError(f"waited {PATIENCE_S:.0f} s for {what}")


class Desktop(VirtualScreen):
    """A virtual screen with a keyboard and a mouse, by xdotool."""

    def screenshot(self) -> NDArray[np.uint8]:
        """Return what the screen shows now, (height, width, 3) BGR."""
        return self.pixels()[..., :3].copy()

    def press(self, *keys: str) -> None:
        """Press keys one after the other, by their names in X (`space`, `Left`, `question`)."""
        for key in keys:
            self._xdotool("key", "--delay", "60", key)
            time.sleep(0.25)  # as a person would, so that each press is seen in a frame of its own

    def click(self, x: float, y: float) -> None:
        """Click with the left button at a pixel of the screen."""
        self._xdotool("mousemove", str(round(x)), str(round(y)), "click", "1")

    def start(self, *arguments: object, folder: Path) -> "Program":
        """Start `cubeling` with arguments, in a folder."""
        return Program(self, [str(each) for each in arguments], folder)

    def find_window(self, process: int) -> str:
        """Return the identifier of a process' window, "" while it has none."""
        found = self._xdotool("search", "--onlyvisible", "--pid", str(process), fails=True)
        return found.split()[-1] if found.split() else ""

    def focus(self, window: str) -> None:
        """Give a window the keyboard."""
        self._xdotool("windowfocus", "--sync", window)

    def geometry(self) -> str:
        """Return place and size of the window that has the keyboard."""
        return self._xdotool("getwindowfocus", "getwindowgeometry")

    def _xdotool(self, *arguments: str, fails: bool = False) -> str:
        done = subprocess.run(
            ["xdotool", *arguments],
            env=self.environment,
            capture_output=True,
            text=True,
            timeout=PATIENCE_S,
        )
        if done.returncode and not fails:
            raise AfternoonError(f"xdotool {' '.join(arguments)}: {done.stderr.strip()}")
        return done.stdout


class Program:
    """A run of `cubeling` on a desktop; what it prints is kept."""

    def __init__(self, desktop: Desktop, arguments: list[str], folder: Path) -> None:
        self._desktop = desktop
        self._words = folder / "printed.txt"
        self._output = self._words.open("w")
        self._process = subprocess.Popen(
            [sys.executable, "-c", "from cubeling.app.entry import main; main()", *arguments],
            env=desktop.environment,
            cwd=folder,
            stdin=subprocess.DEVNULL,
            stdout=self._output,
            stderr=subprocess.STDOUT,
            # As in a terminal: what a shell starts in the background begins with Ctrl-C ignored.
            preexec_fn=partial(signal.signal, signal.SIGINT, signal.SIG_DFL),
        )

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        if self.running:
            self._process.kill()
        with suppress(subprocess.TimeoutExpired):
            self._process.wait(timeout=10)
        self._output.close()

    @property
    def running(self) -> bool:
        """Whether it has not ended."""
        return self._process.poll() is None

    @property
    def printed(self) -> str:
        """All that it has printed."""
        return self._words.read_text(errors="replace")

    def window(self) -> None:
        """Wait until the window is there, and give it the keyboard."""

        def found() -> str:
            if not self.running:
                raise AfternoonError(f"no window: {self.printed.strip()[-500:]}")
            return self._desktop.find_window(self._process.pid)

        self._desktop.focus(wait_for("the window", found))

    def signal(self, number: int) -> None:
        """Send it a signal."""
        self._process.send_signal(number)

    def end(self) -> int:
        """Wait for the end, and return the exit code."""
        wait_for("the end of the program", lambda: not self.running)
        return self._process.returncode
