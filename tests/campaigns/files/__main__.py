"""Damaged files for every reader: `python -m tests.campaigns.files --files 100000`.

Every reader is one of `cubeling.files.KINDS`, so that of a new format is tried without a line here.
Good files (`examples`) are damaged by a seed and read. A reader may read what it can or refuse the
file by the error of its room, in one line; it takes at most 2 s of CPU for each MB that is begun,
and 500 MB of memory. Prints a table and exits with 1 if any does not hold; `--keep` keeps the
files that fail.
"""

import argparse
import contextlib
import gc
import multiprocessing
import os
import pkgutil
import resource
import shutil
import signal
import sys
import tempfile
import time
import traceback
import warnings
from collections import defaultdict
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from functools import partial
from importlib import import_module
from itertools import islice
from operator import attrgetter
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.table import Table

from cubeling.app.errors import AppError
from cubeling.app.session import SessionFile
from cubeling.app.session.options import START_STAGES
from cubeling.bad_input import BadInputError
from cubeling.files import KINDS, FileKind
from cubeling.tracking import FrameSource
from tests.campaigns.files.examples import examples_of, make_examples
from tests.campaigns.files.mutations import mutant

MOST_CPU_S_PER_MB, MOST_BYTES = 2.0, 500_000_000
"""What reading a file may take, for each MB that is begun, and more memory than before."""

COLLECTED_FILES = 20
"""After so many files it is looked for garbage in circles: few large arrays do not call for it."""

FRAMES = 20
"""Frames that are read of a video or session."""

ROOMS = ("affect", "tracking", "characters", "robot", "app")


class TooLongError(Exception):
    """A reader took longer than it may."""


@dataclass(frozen=True)
class Trial:
    """What a reader made of one file."""

    failure: str
    """What does not hold, or ""."""

    refused: bool
    """Whether the file was refused."""

    cpu_s: float
    """CPU time [s]."""


def readers() -> dict[str, FileKind]:
    """Return every kind of file by the name of its reader; loads all modules of the rooms."""
    for room in ROOMS:
        path = import_module(f"cubeling.{room}").__path__
        for module in pkgutil.walk_packages(path, f"cubeling.{room}."):
            # The board's files run on a board, and a `__main__` when it is loaded.
            if ".firmware" not in module.name and not module.name.endswith("__main__"):
                with contextlib.suppress(ImportError):  # of an extra that is not installed
                    import_module(module.name)
    return {kind.reader: kind for kind in KINDS if kind.reader.startswith("cubeling.")}


def reader_of(name: str) -> Callable[[Path], object]:
    """Return the function that `FileKind.reader` names."""
    module, _, function = name.partition(":")
    found: Callable[[Path], object] = attrgetter(function)(import_module(module))
    return found


def read_all(read: Callable[[Path], object], path: Path) -> object:
    """Read a file, and what is read only when it is asked for: frames, messages of a session."""
    found = read(path)
    if isinstance(found, SessionFile):
        with found:
            _read_session(found)
    elif isinstance(found, FrameSource):
        with found:
            list(islice(found, FRAMES))
    return found


def _read_session(session: SessionFile) -> None:
    for name in ("info", "has_channels", "events", "inputs", "lines"):
        getattr(session, name)
    for stage in START_STAGES:
        with contextlib.suppress(AppError):  # a session without this channel
            list(islice(session.replay_inputs(stage), FRAMES))


def attempt(read: Callable[[Path], object], path: Path) -> Trial:
    """Return what a reader makes of a file."""
    most_s = MOST_CPU_S_PER_MB * -(-max(path.stat().st_size, 1) // 1_000_000)
    failure, refused = "", False
    begun = time.process_time()
    signal.setitimer(signal.ITIMER_PROF, 5.0 * most_s)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            read_all(read, path)
    except BadInputError as error:
        refused = True
        if not str(error).isprintable():
            failure = f"a message that cannot be printed: {str(error)!r:.80}"
    except (Exception, MemoryError) as error:  # which no reader may let through
        place = traceback.extract_tb(error.__traceback__)[-1]
        failure = (
            f"{type(error).__name__}: {error!s:.60} ({Path(place.filename).name}:{place.lineno})"
        )
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
    cpu_s = time.process_time() - begun
    if not failure and cpu_s > most_s:
        failure = f"{cpu_s:.1f} s"
    return Trial(failure, refused, cpu_s)


def _too_long(*_: object) -> None:
    raise TooLongError("it does not end")


def _begin() -> None:
    """Set the limits of a process that reads."""
    signal.signal(signal.SIGPROF, _too_long)
    with open(os.devnull, "w") as nowhere:  # the libraries that decode pictures write to it
        os.dup2(nowhere.fileno(), 2)
    used = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (used + MOST_BYTES, -1))


def batch(
    reader: str, examples: list[Path], seeds: range, folder: Path, keep: Path | None
) -> tuple[str, list[Trial]]:
    """Read damaged copies of the examples of a kind, one for each seed."""
    read = reader_of(reader)
    gc.collect()  # what others have left here, in circles, is not this reader's
    for example in examples:  # what is loaded once counts for none of them
        with contextlib.suppress(BadInputError):
            read_all(read, example)
    _begin()
    trials = []
    place = folder / f"{reader.replace(':', '.')}-{seeds.start}"
    place.mkdir()
    for skeleton in {each for example in examples for each in example.parent.glob("*.asf")}:
        shutil.copy(skeleton, place)  # of an .amc
    for number, seed in enumerate(seeds):
        if number % COLLECTED_FILES == 0:
            gc.collect()
        example = examples[seed % len(examples)]
        path = place / example.name
        random = np.random.default_rng([1, seed])
        path.write_bytes(mutant(example.read_bytes(), example.suffix, random))
        trial = attempt(read, path)
        if trial.failure and keep is not None:
            keep.mkdir(exist_ok=True, parents=True)
            shutil.copy(path, keep / f"{reader.replace(':', '.')}-{seed}{path.suffix}")
        path.unlink()
        trials.append(trial)
    shutil.rmtree(place)
    return reader, trials


def main() -> int:
    """Run the campaign; return 1 if a reader does what it may not."""
    parser = argparse.ArgumentParser(description="Damage files of every kind and read them.")
    parser.add_argument("--files", type=lambda text: int(float(text)), default=100_000)
    parser.add_argument("--only", default="", help="readers whose name contains this")
    parser.add_argument("--keep", type=Path, help="folder for files that fail")
    parser.add_argument("--processes", type=int, default=multiprocessing.cpu_count())
    wanted = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch:
        trials, problems = campaign(
            wanted.files, wanted.only, Path(scratch), wanted.keep, wanted.processes
        )
    return report(trials, problems)


def campaign(
    count: int, only: str, folder: Path, keep: Path | None, processes: int
) -> tuple[dict[str, list[Trial]], list[str]]:
    """Return the trials of each reader, and what kept any from being tried."""
    kinds = {name: kind for name, kind in readers().items() if only in name}
    made = folder / "made"
    made.mkdir()
    make_examples(made)
    examples = {}
    for name, kind in kinds.items():
        read = reader_of(name)
        examples[name] = examples_of(kind, made, partial(read_all, read))
    problems = [f"{name}: no example in the tree" for name, found in examples.items() if not found]
    tried = [name for name, found in examples.items() if found]
    each = -(-count // max(len(tried), 1))
    trials: dict[str, list[Trial]] = defaultdict(list)
    with ProcessPoolExecutor(processes, multiprocessing.get_context("fork")) as pool:
        pending = {
            pool.submit(batch, name, examples[name], seeds, folder, keep): (name, seeds)
            for seeds in _parts(each)
            for name in tried
        }
        for done in as_completed(pending):
            try:
                name, found = done.result()
                trials[name] += found
            except BrokenProcessPool:
                problems.append(f"{pending[done][0]}: the process died, in {pending[done][1]}")
    return trials, problems


def _parts(count: int, size: int = 200) -> Iterator[range]:
    return (range(start, min(start + size, count)) for start in range(0, count, size))


def report(trials: dict[str, list[Trial]], problems: list[str]) -> int:
    """Print what was found; return 1 if anything failed."""
    table = Table("reader", "files", "refused", "fail", "CPU ms: median", "95 %", "worst")
    console = Console(width=140, highlight=False)
    for name, found in trials.items():
        times = 1000.0 * np.array([trial.cpu_s for trial in found])
        figures = (np.median(times), np.quantile(times, 0.95), times.max())
        failed = sum(bool(trial.failure) for trial in found)
        refused = f"{sum(trial.refused for trial in found) / len(found):.0%}"
        table.add_row(
            name.removeprefix("cubeling."), str(len(found)), refused, str(failed),
            *(f"{figure:.1f}" for figure in figures),
        )  # fmt: skip
        kinds: dict[str, int] = defaultdict(int)
        for trial in found:
            if trial.failure:
                kinds[trial.failure] += 1
        problems += [f"{name}: {failure} ({times} ×)" for failure, times in kinds.items()]
    console.print(table)
    for problem in problems:
        console.print(problem, markup=False)
    total = sum(map(len, trials.values()))
    console.print(f"{total} files, {len(trials)} readers: {'FAILED' if problems else 'all hold'}")
    return int(bool(problems))


if __name__ == "__main__":
    sys.exit(main())
