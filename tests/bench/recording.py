"""Whether syncing a recording to the disk delays the pictures: `python -m tests.bench.recording`.

A session of 60 pictures a second is recorded twice in turn, with `fsync` and without it. What is
compared is the time that a picture takes, from the source to the recorder's queue, on the thread of
the pictures. The exit code is 1 if syncing makes the 95th percentile clearly longer.
"""

import os
import sys
import time
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory
from unittest import mock

import numpy as np
from rich.console import Console
from rich.table import Table

from cubeling.app.pipeline.playground import Playground
from cubeling.app.pipeline.step import ReplayInputs
from cubeling.app.session import Recorder
from cubeling.tracking import CubeState, Frame, Intrinsics
from cubeling.tracking.sources.device import decode_jpeg
from tests.campaigns.phone import jpegs

RATE = 60.0
"""Pictures a second."""

SIZE = 640, 360
"""Size of the pictures [px]."""

SECONDS = 4.0
"""Length of one recording [s]."""

ROUNDS = 3
"""Number of times that both are measured, in turn."""

MAX_RATIO = 1.25
"""Most that the 95th percentile may grow: two runs of the same differ by as much."""


def picture_times(pictures: list[bytes], path: Path, sync: Callable[[int], None]) -> list[float]:
    """Record at the camera's pace, and return how long each picture took [s].

    The cube is not looked for: that takes long, and not always the same time.
    """
    playground = Playground("companion", Intrinsics.guess(SIZE))
    taken = []
    with mock.patch.object(os, "fsync", sync), Recorder(path, {"scenario": "companion"}) as file:
        start = time.perf_counter()
        for index in range(int(RATE * SECONDS)):
            time.sleep(max(0.0, start + index / RATE - time.perf_counter()))
            began, data = time.perf_counter(), pictures[index % len(pictures)]
            image = decode_jpeg(data)
            assert image is not None
            frame = Frame(image, index / RATE, index, data, "jpeg")
            file.write(playground.step(frame, replay=ReplayInputs(unseen(frame.timestamp))))
            taken.append(time.perf_counter() - began)
    assert file.problem is None
    return taken


def unseen(time_s: float) -> CubeState:
    """Return the state of a cube that is not in the picture."""
    nowhere = np.full(6, np.nan)
    return CubeState(False, None, nowhere, np.eye(6), "predicted", (), np.nan, time_s)


def main() -> int:
    """Measure, and print a table."""
    pictures = jpegs(60, SIZE)
    real, syncs = os.fsync, list[float]()

    def sync(file: int) -> None:
        began = time.perf_counter()
        real(file)
        syncs.append(time.perf_counter() - began)

    found: dict[str, list[float]] = {"without": [], "with": []}
    with TemporaryDirectory(dir=Path.cwd()) as folder:
        for _ in range(ROUNDS):
            for name, call in (("without", lambda file: None), ("with", sync)):
                found[name] += picture_times(pictures, Path(folder) / "session.mcap", call)
    table = Table("fsync", "pictures", "median ms", "95 % ms", "worst ms")
    for name, taken in found.items():
        figures = 1000 * np.quantile(taken, (0.5, 0.95, 1.0))
        table.add_row(name, f"{len(taken)}", *(f"{figure:.1f}" for figure in figures))
    console = Console()
    console.print(table)
    ratio = float(np.quantile(found["with"], 0.95) / np.quantile(found["without"], 0.95))
    console.print(
        f"{len(syncs)} syncs of {1000 * float(np.median(syncs)):.1f} ms (worst "
        f"{1000 * max(syncs):.1f} ms); the 95th percentile of a picture × {ratio:.2f}"
    )
    return int(ratio > MAX_RATIO)


if __name__ == "__main__":
    sys.exit(main())
