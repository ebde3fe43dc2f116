"""The parts of an afternoon: what a family and a researcher do, with real key presses."""

import signal
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from tests.app import session_parts
from tests.campaigns.afternoon.desktop import AfternoonError, Desktop, Program, wait_for
from tests.campaigns.phone import PhoneServer

MIN_CHANGE = 0.5
"""Mean difference of grey values between two pictures of a screen on which something moves."""


@dataclass(frozen=True)
class Afternoon:
    """What every scene has at hand."""

    desktop: Desktop
    """Screen, keyboard and mouse."""

    phone: PhoneServer
    """A camera that sees the companion cube."""

    camera: str
    """Its address."""

    folder: Path
    """Where the programs run and keep their files."""

    look: Callable[[str], NDArray[np.uint8]]
    """Takes a screenshot and keeps it under a name."""

    def play(self, *arguments: object) -> Program:
        """Start a session with the phone's camera, and wait for its window."""
        program = self.desktop.start(
            "play", *arguments, "--source", self.camera, "--folder", self.folder, folder=self.folder
        )
        program.window()
        return program

    def moving(self) -> bool:
        """Whether the screen changes within half a second."""
        before = self.desktop.screenshot().astype(np.float32)
        time.sleep(0.5)
        return bool(np.abs(self.desktop.screenshot() - before).mean() > MIN_CHANGE)

    def files(self, suffix: str) -> list[Path]:
        """Return the files with a suffix, the oldest first."""
        return sorted(self.folder.glob(f"*{suffix}"), key=lambda path: path.stat().st_mtime)


def wrong_cube(afternoon: Afternoon) -> None:
    """A child holds the companion cube before `play follow`, and presses the key that is named."""
    with afternoon.play("follow") as program:
        time.sleep(4)
        afternoon.look("wrong cube")
        afternoon.desktop.press("3")
        wait_for("the character to play", afternoon.moving)
        time.sleep(3)
        afternoon.look("the right scenario")
        _quit(afternoon, program)
        _expect("companion" in program.printed, "the summary names the second scenario")


def every_key(afternoon: Afternoon) -> None:
    """A parent tries all keys."""
    desktop = afternoon.desktop
    with afternoon.play("companion") as program:
        wait_for("the character to move", afternoon.moving)
        desktop.press("question")
        time.sleep(1)
        afternoon.look("all keys")
        desktop.press("Escape", "space")
        time.sleep(1)
        _expect(not afternoon.moving(), "a paused picture stands still")
        afternoon.look("paused")
        desktop.press("space")
        wait_for("the picture to go on", afternoon.moving)
        desktop.press("s")
        wait_for("the snapshot", lambda: afternoon.files(".png"))
        desktop.press("m")
        time.sleep(1)
        afternoon.look("mirrored")
        desktop.press("m", "p")
        time.sleep(1)
        afternoon.look("panels")
        desktop.press("p", "Tab")
        time.sleep(2)
        afternoon.look("menu")
        desktop.press("Escape")
        before = desktop.geometry()
        desktop.press("f")
        time.sleep(1)
        afternoon.look("full screen")
        _expect(desktop.geometry() != before, "F fills the screen")
        desktop.press("f")
        time.sleep(1)
        _expect(desktop.geometry() == before, "F returns to where the window was")
        desktop.press("c")
        time.sleep(1)
        afternoon.look("started over")
        _quit(afternoon, program)


def record_and_replay(afternoon: Afternoon) -> None:
    """A researcher records a trial, checks that it replays exactly, and looks through it."""
    desktop = afternoon.desktop
    with afternoon.play("companion") as program:
        wait_for("the character to move", afternoon.moving)
        desktop.press("r")
        time.sleep(3)
        desktop.press("b")
        time.sleep(3)
        afternoon.look("recording")
        desktop.press("r")
        time.sleep(1)
        afternoon.look("recorded")
        _quit(afternoon, program)
    recording = afternoon.files(".mcap")[-1]
    _expect("mark 1" in [name for _, name in session_parts.events(recording)], "B marks a moment")
    with desktop.start("replay", recording, "--check", folder=afternoon.folder) as program:
        _expect(program.end() == 0, f"the recording replays exactly: {program.printed}")
    with desktop.start("replay", recording, folder=afternoon.folder) as program:
        program.window()
        wait_for("the recording to play", afternoon.moving)
        desktop.press("Right", "Left", "shift+Right", "space", "period", "comma")
        afternoon.look("replay")
        desktop.press("Home", "space", "End")
        time.sleep(2)
        afternoon.look("end of the replay")
        _quit(afternoon, program)


def unplugged_camera(afternoon: Afternoon) -> None:
    """Someone pulls the camera's plug, and puts it back."""
    with afternoon.play("companion") as program:
        wait_for("the character to move", afternoon.moving)
        afternoon.phone.plugged.clear()
        wait_for("the picture to stand still", lambda: not afternoon.moving())
        time.sleep(3)
        afternoon.look("camera lost")
        afternoon.phone.plugged.set()
        wait_for("the camera to come back", afternoon.moving)
        _quit(afternoon, program)
        _expect("camera" in program.printed, "the summary tells of the camera")


def demo_to_the_end(afternoon: Afternoon) -> None:
    """A visitor watches the demo, jumps to its end, and reads what to do next."""
    with afternoon.desktop.start("demo", "companion", folder=afternoon.folder) as program:
        program.window()
        wait_for("the demo to play", afternoon.moving)
        afternoon.desktop.press("End")
        # Return closes the card at the end, and does nothing before.
        wait_for("the end of the demo", lambda: _pressed(afternoon, "Return", program))
        _expect(program.end() == 0, f"the demo ends well: {program.printed}")


def interrupted_video(afternoon: Afternoon) -> None:
    """A researcher on a deadline stops a rendering with Ctrl-C, and keeps what there is."""
    arguments = ("demo", "companion", "--output", "short.mp4")
    with afternoon.desktop.start(*arguments, folder=afternoon.folder) as program:
        wait_for(
            "a sign of life", lambda: "%" in program.printed or program.printed.count("\n") > 2
        )
        program.signal(signal.SIGINT)
        _expect(program.end() == 130, f"Ctrl-C ends it: {program.printed}")
        _expect(afternoon.files(".mp4")[-1].stat().st_size > 0, "the video is kept")


SCENES: dict[str, Callable[[Afternoon], None]] = {
    "wrong cube": wrong_cube,
    "every key": every_key,
    "record and replay": record_and_replay,
    "unplugged camera": unplugged_camera,
    "demo to the end": demo_to_the_end,
    "interrupted video": interrupted_video,
}
"""Each scene by its name, in order."""


def _quit(afternoon: Afternoon, program: Program) -> None:
    afternoon.desktop.press("q")
    _expect(program.end() == 0, f"the session ends well: {program.printed}")


def _pressed(afternoon: Afternoon, key: str, program: Program) -> bool:
    """Press a key after another look; return whether it has ended the program."""
    afternoon.look("before the end")
    afternoon.desktop.press(key)
    time.sleep(1)
    return not program.running


def _expect(holds: bool, what: str) -> None:
    if not holds:
        raise AfternoonError(f"expected: {what}")
