"""Kill studies, and count the answers that are lost: `python -m tests.campaigns.study_kills`.

One participant of each bundled protocol answers at the terminal of a real `cubeling study run`,
which is ended by SIGKILL ten times, each after a random number of answers and a random time, in the
middle of tasks too, and begun again. Lost are those that were given before the kill and are not in
the log. The exit code is 1 if a kill loses more than one answer, or if the study is not finished.
"""

import argparse
import subprocess
import sys
import time
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from rich.console import Console
from rich.table import Table

from cubeling.app.session.bundled import bundled_session
from cubeling.app.workshop.study.participants.study_log import LOG_NAME, read_log
from cubeling.app.workshop.study.protocols.plan import plan_of
from cubeling.app.workshop.study.protocols.protocol_file import bundled_protocols, load_protocol

KILLS = 10
"""Kills of each protocol."""

LATEST_KILL_S = 2.0
"""The program is killed at latest so long after an answer [s]: a task is played then, or more is
asked."""

MAX_LOST = 1
"""Answers that a kill may lose: what docs/studies.md promises."""

PROMPTS = (b"Enter goes on ", b"> ")

ANSWER = b"1\n"
"""What every question of the bundled protocols takes."""


class Terminal:
    """A study that runs, and whoever answers it."""

    def __init__(self, name: str, folder: Path, recording: Path) -> None:
        command = [
            sys.executable, "-c", "from cubeling.app.entry import main; main()", "study", "run",
            name, "-o", str(folder), "--participant", "P01", "--no-pictures",
            "--source", str(recording),
        ]  # fmt: skip
        self.answered = 0
        self._process = subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, bufsize=0
        )

    def answer(self) -> bool:
        """Answer what is asked next; return False if the study is over."""
        assert self._process.stdout is not None
        assert self._process.stdin is not None
        said = b""
        while not said.endswith(PROMPTS):
            byte = self._process.stdout.read(1)
            if not byte:
                return False
            said += byte
        self._process.stdin.write(ANSWER)
        self.answered += 1
        return True

    def kill(self) -> None:
        """Kill it, if it still runs."""
        self._process.kill()
        self._process.communicate()


def lost_answers(name: str, kills: int, rng: np.random.Generator, folder: Path) -> list[int]:
    """Let one participant finish a protocol in spite of kills; return what each kill lost."""
    recording = bundled_session("companion")
    steps = len(plan_of(load_protocol(name)[0], 0))
    lost = []
    kept = 0
    for left in range(kills, 0, -1):
        study = Terminal(name, folder, recording)
        most = max(2 * (steps - kept) // (left + 1), 1)
        for _ in range(int(rng.integers(1, most + 1))):
            study.answer()
        time.sleep(rng.uniform(0.0, LATEST_KILL_S) * rng.integers(2))  # half of them at once
        study.kill()
        before, kept = kept, _kept(folder)
        lost.append(study.answered - (kept - before))
    study = Terminal(name, folder, recording)
    while study.answer():
        pass
    study.kill()
    if _kept(folder) != steps:
        raise AssertionError(f"{name}: {_kept(folder)} of {steps} steps are kept at the end")
    return lost


def _kept(folder: Path) -> int:
    """Return how many steps are in the log."""
    entries, _ = read_log(folder / "P01" / LOG_NAME)
    return len({each["key"] for each in entries if "key" in each})


def main() -> int:
    """Kill, print a table, and return 1 if more was lost than is promised."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--kills", type=int, default=KILLS)
    parser.add_argument("--seed", type=int, default=1)
    wanted = parser.parse_args()
    rng, start = np.random.default_rng(wanted.seed), time.perf_counter()
    table = Table("protocol", "kills", "lost nothing", "lost one answer", "lost more")
    worst = 0
    with TemporaryDirectory() as folder:
        for name in bundled_protocols():
            lost = np.array(lost_answers(name, wanted.kills, rng, Path(folder) / name))
            worst = max(worst, int(lost.max()))
            counts = ((lost <= 0).sum(), (lost == 1).sum(), (lost > MAX_LOST).sum())
            table.add_row(name, f"{len(lost)}", *(f"{each}" for each in counts))
    console = Console(width=110)
    console.print(table)
    console.print(f"{time.perf_counter() - start:.0f} s, seed {wanted.seed}: all were finished")
    return 1 if worst > MAX_LOST else 0


if __name__ == "__main__":
    sys.exit(main())
