"""Play before cameras with faults: `python -m tests.campaigns.camera_faults`.

Each of `FAULTS` begins after some seconds of play, lasts longer than a short stall, and ends. It is
played by the real program, without a window and with one (on Xvfb), before a phone on the loopback
network; and within this process, five times as fast, before a driver of a webcam. The exit code is
1 if a session ended before its time, does not go on after the fault, or ends in bad order.
"""

import argparse
import math
import os
import re
import shutil
import signal
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from contextlib import nullcontext
from dataclasses import dataclass, field
from pathlib import Path
from tempfile import TemporaryDirectory

from rich.console import Console
from rich.table import Table

from cubeling.app.errors import AppError
from cubeling.app.running.opening import open_session
from cubeling.app.running.runner import run
from cubeling.app.running.summary.gaps import gaps_line
from cubeling.app.session import SessionFile, SessionOptions
from cubeling.tracking import TrackingError
from cubeling.tracking.sources.live import LiveSource
from tests.campaigns.faulty_camera import (
    FAULTS,
    RATE,
    Fault,
    FaultyPhone,
    Sent,
    faulty_phone,
    pictures,
    usual,
)
from tests.virtual_screen import VirtualScreen

BEFORE_S, FAULT_S, AFTER_S = 2.0, 8.0, 5.0
"""Time before the fault, of the fault, and after it [s]: a session without a window used to end
after 3 s of a fault, and a lost stream is opened again within 3.5 s."""

DRIVER_SPEED = 5.0
"""How much faster than real time the driver's sessions run."""

WINDOWED = ["--mute", "--quality", "reduced", "--realism", "none"]
"""Options of sessions with a window, which draws without a graphics card."""

PATIENCE_S = 60.0
"""Longest time until the program shows a picture or ends, on a busy computer [s]."""

PICTURE_BYTES = 10_000
"""A recording that grows by more than this has another picture."""


@dataclass
class Played:
    """What came of one session."""

    fault: str
    """Name of the fault."""

    mode: str
    """ "no window", "window" or "driver"."""

    early: bool = False
    """Whether it ended before its time."""

    wrong: list[str] = field(default_factory=list)
    """What should not be so."""

    frames: int = 0
    """Frames of the session."""

    missing: str = ""
    """When the camera was lost, by the summary."""


def play_by_program(name: str, screen: VirtualScreen | None) -> Played:
    """Play before a phone with the real program, in a window on a screen or without one."""
    played = Played(name, "no window" if screen is None else "window")
    with TemporaryDirectory() as folder, faulty_phone() as server:
        path, printed = Path(folder) / "x.mcap", Path(folder) / "printed"
        command = [
            sys.executable, "-c", "from cubeling.app.entry import main; main()",
            "play", "companion", "--source", f"http://127.0.0.1:{server.server_port}/video",
            "--record", str(path), *(["--no-pictures"] if screen is None else WINDOWED),
        ]  # fmt: skip
        environment = None if screen is None else screen.environment
        with printed.open("wb") as output:
            process = subprocess.Popen(command, env=environment, stdout=output, stderr=output)
            try:
                fault_end = _apply(FAULTS[name], server, process, path)
                early = process.poll()
                if early is None:
                    process.send_signal(signal.SIGTERM)
                code = process.wait(PATIENCE_S)
            finally:
                process.kill()
        words = printed.read_text(errors="replace")
        lines = [" ".join(line.strip("│ ").split()) for line in words.splitlines()]
        row = re.compile(
            r"camera lost (\d.*)"
        )  # of the summary; other lines begin "camera lost after"
        played.missing = next((found[1] for line in lines if (found := row.match(line))), "")
        played.early = early is not None
        if played.early:
            played.wrong.append(f"it ended before its time with {early}: {words.strip()[-200:]}")
        elif code != 143:
            played.wrong.append(f"its exit code is {code}")
        if FAULTS[name].loses and "camera back" not in words:
            played.wrong.append("it does not say that the camera was lost and came back")
        _read(path, fault_end, played)
    return played


def _apply(
    fault: Fault, server: FaultyPhone, process: subprocess.Popen[bytes], path: Path
) -> float:
    """Let the fault begin and end, and the session go on; return when the fault ended [s]."""
    _wait_for_bytes(path, PICTURE_BYTES, process)
    time.sleep(BEFORE_S)
    server.fault = fault
    time.sleep(FAULT_S)
    server.fault = None
    fault_end = time.monotonic()
    time.sleep(AFTER_S)
    if path.exists():
        _wait_for_bytes(path, path.stat().st_size + PICTURE_BYTES, process)
    return fault_end


def _wait_for_bytes(path: Path, size: int, process: subprocess.Popen[bytes]) -> None:
    """Wait until a recording has a size, while the program runs: a busy computer draws slowly."""
    end = time.monotonic() + PATIENCE_S
    while process.poll() is None and time.monotonic() < end:
        if path.exists() and path.stat().st_size > size:
            return
        time.sleep(0.02)


def _read(path: Path, fault_end: float, played: Played) -> None:
    """Check that a recording is whole and goes on after the fault."""
    try:
        with SessionFile(path) as session:
            times = [time_s for _, time_s, _ in session.messages("/camera/image")]
            session.info  # noqa: B018  # refuses what was cut off
    except AppError as error:
        played.wrong.append(str(error))
        return
    played.frames = len(times)
    if not times or times[-1] < fault_end:
        played.wrong.append("it does not go on after the fault")


class Driver:
    """The driver of a webcam with a fault, on a clock that runs faster than real time."""

    rate = RATE
    settings = ()
    exposed: float | None = None

    def __init__(self, fault: Fault) -> None:
        pictures()  # a camera that makes them while it is read is late
        self._fault = fault
        self._number = self._since = 0
        self.begin = math.inf
        """When the session begins, from which on the fault is timed [s]."""
        self.source: LiveSource | None = None

    def clock(self) -> float:
        """Return the time [s]."""
        return time.monotonic() * DRIVER_SPEED

    @property
    def played(self) -> float:
        """Time since the beginning of the session [s]; negative before."""
        return self.clock() - self.begin

    @property
    def fault(self) -> Fault | None:
        """The present fault."""
        return self._fault if BEFORE_S <= self.played < BEFORE_S + FAULT_S else None

    def __call__(self) -> "Driver":
        """Open it."""
        fault = self.fault
        if fault is not None and not fault.connects:
            raise TrackingError("camera 0 does not exist")
        self._since = 0
        return self

    def read(self) -> Sent:
        """Wait for the next picture."""
        if self.played >= BEFORE_S + FAULT_S + AFTER_S and self.source is not None:
            self.source.close()
        fault = self.fault
        self._number += 1
        self._since = 0 if fault is None else self._since + 1
        time.sleep(1 / RATE / DRIVER_SPEED)
        if fault is None:
            return usual(self._number)
        if fault.breaks_after is not None and self._since > fault.breaks_after:
            raise TrackingError("camera 0 was pulled out")
        return fault.send(self._number)

    def interrupt(self) -> None:
        """Do nothing: it does not block for long."""

    def close(self) -> None:
        """Do nothing."""


def play_by_driver(name: str) -> Played:
    """Play before a driver, in this process."""
    played, driver = Played(name, "driver"), Driver(FAULTS[name])
    options = SessionOptions(scenario="companion", source="camera:0", robot="none", pictures=False)
    with LiveSource(driver, "camera 0", driver.clock) as source:
        driver.source = source
        with open_session(options, source=source) as session:
            driver.begin = driver.clock()
            summary = run(session)
            ended = driver.played
    fault_end = BEFORE_S + FAULT_S
    played.frames = summary.frames
    played.missing = gaps_line(summary.gaps) if summary.gaps else ""
    played.early = ended < fault_end + AFTER_S
    if played.early:
        played.wrong.append(f"it ended at {ended:.1f} s: {summary.lost}")
    if summary.last - driver.begin < fault_end + AFTER_S / 4:
        played.wrong.append("it does not go on after the fault")
    return played


def main() -> int:
    """Play with the faults, print a table, and return 1 if something was wrong."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    modes = ("no window", "window", "driver")
    parser.add_argument("--faults", nargs="+", choices=FAULTS, default=list(FAULTS))
    parser.add_argument("--modes", nargs="+", choices=modes, default=list(modes))
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1)
    wanted = parser.parse_args()
    start, console = time.perf_counter(), Console(width=130)
    has_screen = shutil.which("Xvfb") is not None
    if "window" in wanted.modes and not has_screen:
        console.print("Xvfb is not installed: no session has a window")
    with VirtualScreen() if has_screen else nullcontext() as screen:
        by_program = [
            (name, screen if mode == "window" else None)
            for mode in wanted.modes
            if mode == "no window" or (mode == "window" and has_screen)
            for name in wanted.faults
        ]
        with ThreadPoolExecutor(wanted.jobs) as pool:
            done = list(pool.map(lambda given: play_by_program(*given), by_program))
    if "driver" in wanted.modes:
        done += [play_by_driver(name) for name in wanted.faults]
    table = Table("fault", "session", "frames", "camera lost", "verdict")
    for each in done:
        verdict = "; ".join(each.wrong) or "went on"
        table.add_row(each.fault, each.mode, f"{each.frames}", each.missing, verdict)
    console.print(table)
    wrong = sum(bool(each.wrong) for each in done)
    early = sum(each.early for each in done)
    console.print(
        f"{time.perf_counter() - start:.0f} s: {early} of {len(done)} sessions ended before their "
        f"time, {wrong} with something wrong",
        style="red" if wrong else "green",
    )
    return int(wrong > 0)


if __name__ == "__main__":
    sys.exit(main())
