"""Runs all trackers on the same frames, rendered once."""

import tempfile
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from cubeling.tracking import CubeModel
from tests.bench.tracking.rivals.environments import ENTRIES, UnavailableError
from tests.bench.tracking.rivals.worker import Worker
from tests.bench.tracking.scoring import Score, Truth, score
from tests.bench.tracking.sequences import Sequence

FRAMES_PER_TURN = 12
"""Frames that a tracker processes before the next tracker's turn, so that other load on the machine
affects all of them equally."""


@dataclass
class TrackerComparison:
    """The trackers, each with its process."""

    names: tuple[str, ...]
    """Of `ENTRIES`."""

    threads: int
    """Threads of each tracker's libraries; one tracker runs at a time."""

    say: Callable[[str], None]
    """Prints a line of progress."""

    left_out: dict[str, str] = field(default_factory=dict)
    """Why a tracker could not run or failed, by its title."""

    versions: dict[str, str] = field(default_factory=dict)
    """Versions of each tracker's libraries, by its title: "rapidtag 0.1.12, opencv 5.0.0"."""

    _workers: list[Worker] = field(default_factory=list)
    _stack: ExitStack = field(default_factory=ExitStack)

    def __enter__(self) -> "TrackerComparison":
        for name in self.names:
            entry = ENTRIES[name]
            try:
                worker = self._stack.enter_context(Worker(entry, self.threads))
            except UnavailableError as reason:
                self._leave_out(entry.title, str(reason))
                continue
            self._workers.append(worker)
            versions = worker.versions.items()
            self.versions[entry.title] = ", ".join(f"{name} {number}" for name, number in versions)
        return self

    def __exit__(self, *_: object) -> None:
        self._stack.close()

    def run(self, sequence: Sequence) -> Iterator[Score]:
        """Run all trackers on one sequence, and score them."""
        truth = truth_of(sequence)
        with tempfile.TemporaryDirectory(prefix="cubeling-", ignore_cleanup_errors=True) as folder:
            frames = Path(folder) / "frames.npy"
            self.say(f"{sequence.name}: drawing {sequence.count} frames")
            draw(sequence, frames)
            self.say(f"{sequence.name}: {len(self._workers)} trackers at work")
            answers = self._answers(sequence, frames)
        for title, given in answers.items():
            yield score(title, truth, given)

    def _answers(self, sequence: Sequence, frames: Path) -> dict[str, list[dict[str, Any]]]:
        job = job_of(sequence)
        answers: dict[str, list[dict[str, Any]]] = {}
        for worker in list(self._workers):
            self._ask(worker, answers, partial(worker.begin, frames, job))
        for start in range(0, sequence.count, FRAMES_PER_TURN):
            turn = range(start, min(start + FRAMES_PER_TURN, sequence.count))
            for worker in list(self._workers):
                self._ask(worker, answers, partial(worker.ask, turn))
        return answers

    def _ask(
        self,
        worker: Worker,
        answers: dict[str, list[dict[str, Any]]],
        question: Callable[[], list[dict[str, Any]] | None],
    ) -> None:
        """Collect a tracker's answers; drop it if its process has ended."""
        try:
            answers.setdefault(worker.entry.title, []).extend(question() or ())
        except UnavailableError as reason:
            self._workers.remove(worker)
            answers.pop(worker.entry.title, None)
            self._leave_out(worker.entry.title, str(reason))

    def _leave_out(self, title: str, reason: str) -> None:
        self.left_out[title] = reason
        self.say(f"{title} is left out: {reason}")


def draw(sequence: Sequence, path: Path) -> None:
    """Draw every frame into a `.npy` file, (N, height, width, 3) BGR."""
    width, height = sequence.size
    shape = (sequence.count, height, width, 3)
    frames = np.lib.format.open_memmap(path, mode="w+", dtype=np.uint8, shape=shape)
    for index in range(sequence.count):
        frames[index] = sequence.frame(index)


def job_of(sequence: Sequence) -> dict[str, Any]:
    """Describe a sequence to a worker: everything a tracker may know."""
    cube = CubeModel.load(sequence.cube)
    faces = [
        {"id": face.marker_id, "name": face.name, "corners": face.corners.tolist()}
        for face in cube.faces
    ]
    return {
        "timestamps": [sequence.timestamp(index) for index in range(sequence.count)],
        "independent": sequence.independent,
        "camera": {
            "matrix": sequence.told.matrix.tolist(),
            "distortion": sequence.told.distortion.tolist(),
            "size": list(sequence.size),
        },
        "cube": {
            "name": sequence.cube,
            "dictionary": cube.dictionary,
            "edge": cube.edge,
            "faces": faces,
        },
    }


def truth_of(sequence: Sequence) -> Truth:
    """Collect the ground truth of all frames."""
    indices = range(sequence.count)
    return Truth(
        name=sequence.name,
        rate=sequence.rate,
        independent=sequence.independent,
        poses=np.array([sequence.truth(index) for index in indices]),
        velocities=np.array([sequence.velocity(index) for index in indices]),
        in_view=np.array([sequence.in_view(index) for index in indices], bool),
    )
