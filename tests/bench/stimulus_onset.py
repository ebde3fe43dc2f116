"""When a stimulus is on the screen, beside what the log of the study says.

    python -m tests.bench.stimulus_onset [COUNT]

A study shows pictures in its window on a virtual screen (Xvfb), with the square for a light sensor;
a scripted participant answers. Another process watches that square in the screen's memory, as a
sensor would, and its clock is compared with `onset_at` of the log. The bar of issue 60 is an SD of
2 ms.
"""

import subprocess
import sys
import time
from datetime import datetime
from pathlib import Path
from tempfile import TemporaryDirectory

import cv2
import numpy as np
from numpy.typing import NDArray
from rich.console import Console

from cubeling.app.workshop.study.participants.live_task import TaskSetup
from cubeling.app.workshop.study.participants.running import run_participant
from cubeling.app.workshop.study.participants.study_log import StudyFolder, read_participant
from cubeling.app.workshop.study.protocols.protocol_file import read_protocol
from cubeling.app.workshop.study.window.window_desk import QuestionWindow, WindowDesk, at_first_turn
from tests.virtual_screen import VirtualScreen

MAX_DEVIATION_S = 2e-3
"""Standard deviation of the difference that the log may have [s]."""

LOOK_S = 0.0002
"""How often the screen is looked at [s]."""

WHITE = 128
"""Least value of a pixel of the square that is lit."""

PROTOCOL = """
title = "Onsets"
light_patch = true
[[phase]]
name = "p"
parts = ["pictures"]
[[stimuli]]
name = "pictures"
ask = "rating"
file = "{{picture}}.png"
[[stimuli.cross]]
picture = {names}
[[questionnaire]]
name = "rating"
[[questionnaire.item]]
name = "liked"
text = "How much do you like it?"
"""


def show_study(folder: Path, count: int) -> None:
    """Lead a scripted participant through a study of so many pictures, in a window."""
    rng = np.random.default_rng(1)

    class Scripted(QuestionWindow):
        """A window in front of which somebody presses keys after a while."""

        def __init__(self) -> None:
            self._seen: object = None
            self._answer_at = 0.0
            super().__init__(fills_screen=True)

        def poll(self) -> None:
            """Process events, and answer if it is time."""
            super().poll()
            if self.sheet is not self._seen:
                self._seen = self.sheet
                self._answer_at = time.monotonic() + rng.uniform(0.08, 0.2)
            if self.sheet is not None and time.monotonic() > self._answer_at:
                self.handle_key("3")
                self.handle_key("Enter")

    for number in range(count):
        picture = rng.integers(0, 255, (450, 600, 3)).astype(np.uint8)
        cv2.imwrite(str(folder / f"{number}.png"), picture)
    path = folder / "onsets.toml"
    path.write_text(PROTOCOL.format(names=[f"{number}" for number in range(count)]))
    protocol = read_protocol(path)
    study = StudyFolder(folder / "s", protocol, path, "study")
    with WindowDesk(protocol, TaskSetup(), folder, Scripted) as desk:
        run_participant(protocol, study.begin("P01", datetime.now()), desk)


def watched_onsets(screen: VirtualScreen, program: "subprocess.Popen[bytes]") -> list[float]:
    """Return when the square in the corner became white, until a program ends [s]."""
    pixel = screen.pixels()[-20, -20]
    found, lit = list[float](), True
    with at_first_turn():  # a sensor waits for nobody
        while program.poll() is None:
            before, now = lit, time.time()
            lit = int(pixel[1]) >= WHITE
            if lit and not before:
                found.append(now)
            time.sleep(LOOK_S)
    return found


def measure(count: int) -> NDArray[np.float64]:
    """Return by how much the log is later than the screen, for each stimulus [s]."""
    with TemporaryDirectory() as name, VirtualScreen() as screen:
        program = subprocess.Popen(
            [sys.executable, "-m", "tests.bench.stimulus_onset", "--show", name, str(count)],
            env=screen.environment,
        )
        seen = watched_onsets(screen, program)
        entries = read_participant(Path(name) / "s" / "P01").entries
    logged = [datetime.fromisoformat(each["onset_at"]).timestamp() for each in entries]
    if len(seen) != len(logged):
        raise SystemExit(f"{len(logged)} stimuli are in the log, and {len(seen)} were seen")
    return np.asarray(np.array(logged) - np.array(seen))


def main() -> None:
    """Print how well the log knows when a stimulus was on the screen."""
    if "--show" in sys.argv:
        show_study(Path(sys.argv[-2]), int(sys.argv[-1]))
        return
    difference = 1e3 * measure(int(sys.argv[1]) if len(sys.argv) > 1 else 60)
    deviation = float(difference.std(ddof=1))
    console = Console(highlight=False, soft_wrap=True)
    console.print(
        f"{len(difference)} stimuli: the log is {difference.mean():.2f} ms later than the screen, "
        f"SD {deviation:.2f} ms, from {difference.min():.2f} to {difference.max():.2f} ms"
    )
    holds = deviation <= 1e3 * MAX_DEVIATION_S
    console.print(
        f"SD at most {1e3 * MAX_DEVIATION_S:g} ms: {'holds' if holds else 'does not hold'}"
    )
    raise SystemExit(not holds)


if __name__ == "__main__":
    main()
