"""Kill the program while it records, and measure what is lost: `python -m tests.campaigns.kills`.

Each run is a real `cubeling play --record` before a camera on the loopback network, of 5 to 60
pictures a second, that is ended by SIGKILL at a random time of its first four seconds. What is lost
is the time from the last picture that can be read to the last one that the program had processed.
The exit code is 1 if that is more than a second in any run, or if a file does not open.
"""

import argparse
import math
import mmap
import os
import struct
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from dataclasses import dataclass
from itertools import cycle, islice, product
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from rich.console import Console
from rich.table import Table

from cubeling.app.errors import AppError
from cubeling.app.session import session_info
from cubeling.tracking import TrackingError, open_source
from tests.campaigns.phone import jpegs, phone

RATES = 5.0, 8.0, 15.0, 30.0, 60.0
"""Pictures a second of the cameras."""

MAX_LOSS_S = 1.0
"""What may be lost [s]: what docs/sessions.md promises."""

LATEST_KILL_S = 4.0
"""The program is killed at latest so long after its file is there [s]."""

SIZE = 640, 360
"""Size of the pictures [px]: small, so that two cores hold 60 a second."""

PICTURES = 120
"""Pictures of the recording that a camera shows, again and again."""

START_S = 60.0
"""Longest time until a recording begins, on a busy computer [s]."""

FORMS = ("--codec", "auto"), ("--codec", "h264", "--robot", "none")
"""How the runs record, in turn: much, so that chunks end by their size, and little, so that they
end by their time."""

NOTED = struct.Struct("=dd")
"""What the program notes of the last picture that it gave to its recorder: when, and the picture's
timestamp, both by the monotonic clock [s]; zeros before the first one."""

PROGRAM = """
import mmap, struct, sys, time
from cubeling.app.session.recorder import Recorder
with open(sys.argv.pop(1), "r+b") as file:
    noted = mmap.mmap(file.fileno(), 0)
write = Recorder.write
def write_and_note(self, step, inputs=None):
    write(self, step, inputs)
    struct.pack_into("=dd", noted, 0, time.monotonic(), step.frame.timestamp)
Recorder.write = write_and_note
from cubeling.app.entry import main
main()
"""
"""The program, which notes each picture that it gave to its recorder where a kill leaves it."""


@dataclass(frozen=True)
class Kill:
    """What one run left."""

    rate: float
    """Pictures a second of its camera."""

    after: float
    """When it was killed, from the beginning of its file [s]."""

    frames: int
    """Pictures that can be read."""

    lost: float
    """From the last of them to the last one that was processed [s]; the time from the first to the
    last one that was processed if none can be read."""

    problem: str = ""
    """What is wrong with the file; "" if it opens."""


def kill_once(camera: str, rate: float, after: float, form: tuple[str, ...], folder: Path) -> Kill:
    """Start the program, kill it, and read what it left."""
    path, note = folder / "killed.mcap", folder / "noted"
    note.write_bytes(bytes(NOTED.size))
    command = [
        sys.executable, "-c", PROGRAM, str(note), "play", "companion", "--source", camera,
        "--no-pictures", "--record", str(path), *form,
    ]  # fmt: skip
    with (folder / "printed").open("wb") as printed:
        process = subprocess.Popen(command, stdout=printed, stderr=printed)
        try:
            end = time.monotonic() + START_S
            while not path.exists():
                if process.poll() is not None or time.monotonic() > end:
                    words = (folder / "printed").read_text(errors="replace").strip()
                    return Kill(rate, after, 0, math.inf, f"it recorded nothing: {words[-200:]}")
                time.sleep(0.005)
            time.sleep(after)
        finally:
            process.kill()
            process.wait()
    with note.open("rb") as file, mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as noted:
        _, processed = NOTED.unpack_from(noted)
    return _read(Kill(rate, after, 0, 0.0), path, processed)


def _read(kill: Kill, path: Path, processed: float) -> Kill:
    """Open what was left, decode every picture, and compare it with what was processed."""
    try:
        frames = session_info(path, salvage=True).frames
    except AppError as error:
        return Kill(kill.rate, kill.after, 0, math.inf, str(error))
    if not frames:  # nothing is lost where nothing was processed
        return Kill(kill.rate, kill.after, 0, math.inf if processed else 0.0)
    times = []
    try:
        with open_source(str(path)) as source:
            times.extend(frame.timestamp for frame in source)
    except TrackingError:
        pass  # it ends within a chunk, after all that can be read
    problem = "" if len(times) == frames else f"{len(times)} of {frames} pictures can be decoded"
    return Kill(
        kill.rate, kill.after, frames, processed - times[-1] if times else math.inf, problem
    )


def kills(count: int, seed: int, jobs: int) -> list[Kill]:
    """Kill so many runs."""
    random = np.random.default_rng(seed)
    plan = [
        (rate, float(random.uniform(0.0, LATEST_KILL_S)), form)
        for rate, form in islice(cycle(product(RATES, FORMS)), count)
    ]
    pictures = jpegs(PICTURES, SIZE)
    with ExitStack() as closing, TemporaryDirectory() as folder:
        cameras = {rate: closing.enter_context(phone(pictures, rate))[0] for rate in RATES}

        def kill(index: int) -> Kill:
            rate, after, form = plan[index]
            own = Path(folder) / str(index)
            own.mkdir()
            return kill_once(cameras[rate], rate, after, form, own)

        with ThreadPoolExecutor(jobs) as pool:
            return list(pool.map(kill, range(count)))


def main() -> int:
    """Kill, print a table, and return 1 if more was lost than is promised."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--kills", type=int, default=100)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1)
    wanted = parser.parse_args()
    start = time.perf_counter()
    done = kills(wanted.kills, wanted.seed, wanted.jobs)
    table = Table(title="Lost by a kill [s]")
    for head in ("pictures/s", "kills", "before the first", "median", "95 %", "worst"):
        table.add_column(head, justify="right")
    for rate in (*RATES, None):
        chosen = [each for each in done if rate in (None, each.rate)]
        if chosen:
            lost = np.array([each.lost for each in chosen])
            figures = (np.median(lost), np.quantile(lost, 0.95, method="higher"), lost.max())
            table.add_row(
                "all" if rate is None else f"{rate:g}",
                f"{len(chosen)}",
                f"{sum(each.frames == 0 for each in chosen)}",
                *(f"{figure:.2f}" for figure in figures),
            )
    console = Console(width=110)
    console.print(table)
    wrong = [
        f"{each.rate:g} pictures/s, killed after {each.after:.2f} s: "
        + (each.problem or f"{each.lost:.2f} s are lost")
        for each in done
        if each.problem or each.lost > MAX_LOSS_S
    ]
    for line in wrong:
        console.print(line, style="red", soft_wrap=True)
    console.print(
        f"{time.perf_counter() - start:.0f} s, seed {wanted.seed}: "
        f"{sum(bool(each.problem) for each in done)} files do not open, "
        f"{sum(each.lost > MAX_LOSS_S for each in done)} lost more than {MAX_LOSS_S:g} s",
        style="red" if wrong else "green",
    )
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
