"""A run of the benchmark: circumstances and scores."""

import datetime
import os
import platform
from dataclasses import dataclass, field
from pathlib import Path
from typing import Self

from tests.bench.tracking.scoring import Score


@dataclass(frozen=True)
class BenchmarkRun:
    """One run of the benchmark."""

    command: str
    """The command line."""

    frames: int
    """Frames of each sequence."""

    seed: int
    """Seed of all sequences."""

    threads: int
    """Threads of each tracker."""

    date: str
    """ISO date."""

    machine: str
    """Processor and number of its cores."""

    load: float
    """Load average at the start: from 0.5 on, times are noisy."""

    scores: tuple[Score, ...] = ()
    """Scores of every tracker on every sequence."""

    versions: dict[str, str] = field(default_factory=dict)
    """Versions of each tracker's libraries."""

    left_out: dict[str, str] = field(default_factory=dict)
    """Why a tracker did not run."""

    @classmethod
    def now(cls, command: str, frames: int, seed: int, threads: int) -> Self:
        """Record the circumstances."""
        day = datetime.date.today().isoformat()
        machine = f"{_processor()}, {os.cpu_count()} cores"
        load = os.getloadavg()[0] if hasattr(os, "getloadavg") else 0.0  # not on Windows
        return cls(command, frames, seed, threads, day, machine, load)

    @property
    def circumstances(self) -> str:
        """Return the circumstances in one line."""
        return (
            f"{self.date}, {self.machine} (load {self.load:.1f} before), one tracker at a time, "
            f"{self.threads} threads; {self.frames} frames a sequence, seed {self.seed}"
        )


def _processor() -> str:
    """Return the processor's name."""
    try:
        for line in Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines():
            if line.startswith("model name"):
                return line.partition(":")[2].strip()
    except OSError:
        pass  # not Linux
    return platform.processor() or platform.machine()
