"""What a run of the benchmark was: its circumstances and its figures."""

import datetime
import os
import platform
from dataclasses import dataclass, field
from pathlib import Path
from typing import Self

from tests.bench.tracking.scoring import Score


@dataclass(frozen=True)
class Run:
    """One run of the benchmark."""

    command: str
    """That was given."""

    frames: int
    """Of each sequence."""

    seed: int
    """Of all sequences."""

    threads: int
    """That each tracker might use."""

    date: str
    """ISO, of the day."""

    machine: str
    """Processor and number of its cores."""

    load: float
    """Processes that others had running when it began: from 0.5 on, times are noisy."""

    scores: tuple[Score, ...] = ()
    """Of every tracker on every sequence."""

    versions: dict[str, str] = field(default_factory=dict)
    """For each tracker what it rests on."""

    left_out: dict[str, str] = field(default_factory=dict)
    """For each tracker that did not take part: why."""

    @classmethod
    def now(cls, command: str, frames: int, seed: int, threads: int) -> Self:
        """Note the circumstances."""
        day = datetime.date.today().isoformat()
        machine = f"{_processor()}, {os.cpu_count()} cores"
        load = os.getloadavg()[0] if hasattr(os, "getloadavg") else 0.0  # not on Windows
        return cls(command, frames, seed, threads, day, machine, load)

    @property
    def circumstances(self) -> str:
        """In one line."""
        return (
            f"{self.date}, {self.machine} (load {self.load:.1f} before), one tracker at a time, "
            f"{self.threads} threads; {self.frames} frames of 1280×720 a sequence, seed {self.seed}"
        )


def _processor() -> str:
    """Name the processor, where the system tells."""
    try:
        for line in Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines():
            if line.startswith("model name"):
                return line.partition(":")[2].strip()
    except OSError:
        pass  # not Linux
    return platform.processor() or platform.machine()
