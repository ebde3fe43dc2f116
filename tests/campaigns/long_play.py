"""Play for hours with voice, robot and recording, and look for growth.

`python -m tests.campaigns.long_play --hours 10` plays in virtual time: the script of `companion`
again and again, with the true pose of the cube, a voice, a simulated robot and a recording.
`python -m tests.campaigns.long_play --minutes 30` plays in real time: the whole program before a
phone on the loopback network, with the same. The exit code is 1 if something grew beyond what a
recording must remember of its file, or if the session did not end well.
"""

import argparse
import gc
import shutil
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest
from mcap.records import ChunkIndex
from rich.console import Console
from rich.table import Table

from cubeling.app.pipeline.cubes.tracked_cube import TrackedCube
from cubeling.app.pipeline.step import Step
from cubeling.app.running.opening import open_session
from cubeling.app.running.runner import run
from cubeling.app.session import SessionOptions, session_info
from cubeling.app.speaking import speaker
from cubeling.tracking import CubeState, Frame
from cubeling.tracking.synthetic import open_synthetic
from tests.app.scripted import PICTURE_HEIGHT, PICTURE_WIDTH, VARIANCE, Blank
from tests.campaigns.phone import jpegs, phone
from tests.campaigns.soak import MEASUREMENT_COUNT, growth

INDEX_BYTES = 2_500
"""What the recorder remembers of a chunk until it writes the index at the end of the file [B]: one
place for each channel. Two chunks a second are 18 MB in an hour at most."""

RATE = 6.0
"""Pictures a second in virtual time: what the cube does lasts for longer than one."""

VOICE_WAIT_S = 600.0
"""How long a line may take in virtual time [s]: a voice that is slow on a busy computer is not said
to be too slow, after which nothing would be spoken any more."""

PHONE_RATE, PHONE_SIZE = 10.0, (320, 180)
"""Pictures a second and their size [px] in real time: what memory holds does not depend on them."""


@dataclass
class LongPlay:
    """What was measured."""

    hours: float
    """How long was played [h]."""

    frames: int = 0
    """Frames of the recording."""

    lines: int = 0
    """Lines that were said."""

    memory: list[int] = field(default_factory=list)
    """Resident memory of the program at even times [B]."""

    objects: list[int] = field(default_factory=list)
    """Objects known to the garbage collector at the same times, without what the recorder remembers
    of each chunk; empty for another process."""

    threads: list[int] = field(default_factory=list)
    """Threads of the program at the same times."""

    megabytes: float = 0.0
    """Size of the recording [MB]."""

    wrong: list[str] = field(default_factory=list)
    """The failures."""


class EndlessScript(Blank):
    """Black pictures at the times of a script that begins again and again."""

    def __init__(self, hours: float) -> None:
        self.script = open_synthetic(
            f"companion?rate={RATE:g}&size={PICTURE_WIDTH}x{PICTURE_HEIGHT}"
        )
        super().__init__(self.script)
        self.count, self.duration = int(3600 * hours * RATE), 3600 * hours

    def __iter__(self) -> Iterator[Frame]:
        black = np.zeros((PICTURE_HEIGHT, PICTURE_WIDTH, 3), np.uint8)
        for index in range(self.count):
            yield Frame(black, index / RATE, index)

    def track(self, frame: Frame) -> CubeState:
        """Return the true state of the cube."""
        pose = self.script.truth(frame.index % self.script.count)
        still = np.zeros(6)
        return CubeState(True, pose, still, VARIANCE, "markers", (), 0.1, frame.timestamp)


def resident(process: str = "self") -> int:
    """Return the resident memory of a process [B]."""
    return int(Path(f"/proc/{process}/statm").read_text().split()[1]) * 4096


def play_virtually(hours: float, folder: Path) -> LongPlay:
    """Play in virtual time, in this process."""
    played, source, path = LongPlay(hours), EndlessScript(hours), folder / "long.mcap"
    every = source.count // MEASUREMENT_COUNT

    def measure(step: Step) -> None:
        played.frames += 1
        played.lines += (
            step.line is not None
            and step.command.speech is not None
            and (step.command.speech.start == step.frame.timestamp)
        )
        if played.frames % every == 0:
            if session.recording is not None:
                session.recording.flush()  # what waits for a slow disk has not grown
            gc.collect()
            played.memory.append(resident())
            # Those from before the first frame are frozen, and not among them.
            found = gc.get_objects()
            played.objects.append(sum(not isinstance(each, ChunkIndex) for each in found))
            played.threads.append(threading.active_count())

    options = SessionOptions(
        scenario="companion", source="script", record=path, pictures=False, language="en"
    )
    with (
        pytest.MonkeyPatch.context() as patch,
        open_session(options, source=source) as session,
    ):
        patch.setattr(speaker, "ANSWER_S", VOICE_WAIT_S)
        patch.setattr(TrackedCube, "track", lambda _, frame, markers: source.track(frame))
        run(session, measure).check()
        if session.speaker.problem:
            played.wrong.append(session.speaker.problem)
    if session.recording_problem:
        played.wrong.append(session.recording_problem)
    _end(played, path)
    return played


def play_really(minutes: float, folder: Path) -> LongPlay:
    """Play in real time, with the program as it is started by a user."""
    played, path = LongPlay(minutes / 60), folder / "long.mcap"
    with (
        phone(jpegs(None, PHONE_SIZE), PHONE_RATE) as (camera, _),
        (folder / "printed").open("wb") as printed,
    ):
        command = [
            sys.executable, "-c", "from cubeling.app.entry import main; main()", "play",
            "companion", "--source", camera, "--no-pictures", "--language", "en",
            "--record", str(path),
        ]  # fmt: skip
        process = subprocess.Popen(command, stdout=printed, stderr=printed)
        try:
            start = time.monotonic()
            for count in range(1, MEASUREMENT_COUNT + 1):
                time.sleep(
                    max(0.0, start + 60 * minutes * count / MEASUREMENT_COUNT - time.monotonic())
                )
                if process.poll() is not None:
                    break
                played.memory.append(resident(str(process.pid)))
                tasks = Path(f"/proc/{process.pid}/task")
                played.threads.append(len(list(tasks.iterdir())))
            process.send_signal(signal.SIGTERM)
            code = process.wait(60)
        finally:
            process.kill()
    if code != 143:
        words = (folder / "printed").read_text(errors="replace").strip()
        played.wrong.append(f"it ended with {code}: {words[-300:]}")
    else:
        _end(played, path)
    return played


def _end(played: LongPlay, path: Path) -> None:
    """Read the recording, and look for growth."""
    info = session_info(path)
    played.frames, played.megabytes = info.frames, path.stat().st_size / 1e6
    played.wrong += growth("objects", played.objects) if played.objects else []
    index = INDEX_BYTES * 2 * 3600 * played.hours / MEASUREMENT_COUNT
    without_index = [
        round(held - index * number) for number, held in enumerate(played.memory, start=1)
    ]
    played.wrong += growth("bytes of memory", without_index)
    played.wrong += growth("threads", played.threads)


def main() -> int:
    """Play, print what was measured, and return 1 if something was wrong."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    how = parser.add_mutually_exclusive_group()
    how.add_argument("--hours", type=float, default=10.0, help="of virtual time")
    how.add_argument("--minutes", type=float, help="of real time instead")
    wanted = parser.parse_args()
    if shutil.which("espeak-ng") is None:
        sys.exit("espeak-ng is not installed, so nothing would be said")
    start = time.perf_counter()
    with TemporaryDirectory() as folder:
        if wanted.minutes is None:
            played = play_virtually(wanted.hours, Path(folder))
        else:
            played = play_really(wanted.minutes, Path(folder))
    table = Table("of the time", "memory MB", "objects", "threads")
    for number in range(3, len(played.memory), 4):
        objects = f"{played.objects[number]:,}" if played.objects else ""
        share = (number + 1) / MEASUREMENT_COUNT
        memory = f"{played.memory[number] / 1e6:.1f}"
        table.add_row(f"{share:.0%}", memory, objects, f"{played.threads[number]}")
    console = Console(width=110)
    console.print(table)
    lines = f", {played.lines} lines said" if played.lines else ""
    console.print(
        f"{time.perf_counter() - start:.0f} s for {played.hours:g} h: {played.frames} frames"
        f"{lines}, {played.megabytes:.0f} MB recorded: "
        + ("; ".join(played.wrong) or "nothing grew"),
        style="red" if played.wrong else "green",
        soft_wrap=True,
    )
    return 1 if played.wrong else 0


if __name__ == "__main__":
    sys.exit(main())
