"""Searches many frames of many seeds for silently wrong poses of Cubeling.

Run `python -m tests.bench.tracking.campaign --frames 10000 --seed 7 [--processes 2]
[--log FILE]`. Every wrong frame is printed with the call that renders it again; the exit code is 1
if there is any. An interrupted run with `--log` continues where it stopped.
"""

import argparse
import json
import os
import sys
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from contextlib import ExitStack
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from cubeling.tracking import CubeModel, CubeState, CubeTracker, Frame
from tests.bench.tracking.ours import told_camera
from tests.bench.tracking.scoring import CHI2_95_PERCENT, MAX_RECALL_ERROR, MIN_WRONG_ERROR, errors
from tests.bench.tracking.sequences import NAMES, Sequence, sequence
from tests.bench.tracking.table import share
from tests.tracking.showing import show_until_decided

AT_REST = ("static", "static-one")
"""Sequences whose frames differ only by noise, which would dilute the count."""

Result = dict[str, Any]


def plan(names: tuple[str, ...], frames: int, length: int, seed: int) -> Iterator[tuple[str, int]]:
    """Name sequences and seeds until they hold `frames`: all of one seed, then of the next.

    >>> list(plan(("a", "b"), 250, 100, 7))
    [('a', 7), ('b', 7), ('a', 8)]
    """
    planned = 0
    while planned < frames:
        for name in names:
            if planned < frames:
                yield name, seed
                planned += length
        seed += 1


def track(drawn: Sequence) -> Iterator[tuple[int, CubeState]]:
    """Track one sequence; with a new tracker for each frame if the poses are independent."""
    camera = told_camera(drawn.told)
    cube = CubeModel.load(drawn.cube)
    tracker = CubeTracker(cube, camera)
    for index in range(drawn.count):
        if drawn.independent:
            tracker = CubeTracker(cube, camera)
        picture, now = drawn.frame(index), drawn.timestamp(index)
        if drawn.independent:
            yield index, show_until_decided(tracker, picture, now)[0]
        else:
            yield index, tracker.update(Frame(picture, now, index))


def evaluate(drawn: Sequence) -> Result:
    """Track one sequence and count the results."""
    result: Result = {"sequence": drawn.name, "seed": drawn.seed, "frames": drawn.count}
    result |= {"seen": 0, "given": 0, "right": 0, "inside": 0, "wrong": []}
    for index, state in track(drawn):
        seen = bool(drawn.in_view(index))
        result["seen"] += int(seen)
        if not state.visible or state.camera_from_cube is None:
            continue
        error = errors(state.camera_from_cube[None], drawn.truth(index)[None])[0]
        shift, turn = (float(np.linalg.norm(part)) for part in (error[:3], error[3:]))
        result["given"] += int(seen)
        result["right"] += int(
            seen and shift <= MAX_RECALL_ERROR[0] and turn <= MAX_RECALL_ERROR[1]
        )
        held = float(error @ np.linalg.solve(state.covariance, error))
        result["inside"] += int(seen and held <= CHI2_95_PERCENT)
        if shift > MIN_WRONG_ERROR[0] or turn > MIN_WRONG_ERROR[1]:
            result["wrong"].append(_wrong(index, state, shift, turn, held))
    return result


def _wrong(index: int, state: CubeState, shift: float, turn: float, held: float) -> Result:
    return {
        "index": index,
        "mm": 1000 * shift,
        "deg": float(np.rad2deg(turn)),
        "source": state.source,
        "verdict": state.refused or "trusted",
        "faces": list(state.faces),
        "stated_mm": 1000 * float(np.sqrt(np.trace(state.covariance[:3, :3]))),
        "chi2": held,
    }


def main() -> None:
    """Track, count, print."""
    options = _options()
    progress = Console(stderr=True, width=120)
    results: list[Result] = []
    for result in _evaluated(options):
        results.append(result)
        for wrong in result["wrong"]:
            progress.print(f"wrong: {_where(result, wrong)}: {_described(wrong)}")
        frames, found = (sum(each) for each in zip(*_counts(results), strict=True))
        name, seed = result["sequence"], result["seed"]
        progress.print(f"{frames} of {options.frames} frames, {found} wrong: {name} seed {seed}")
    _print(Console(width=120), results)
    sys.exit(any(result["wrong"] for result in results))


def _evaluated(options: argparse.Namespace) -> Iterator[Result]:
    """Evaluate all sequences of a campaign, in order; what the log holds is not done again."""
    names, length = tuple(options.sequences), options.length
    wanted = [(*each, length) for each in plan(names, options.frames, length, options.seed)]
    done = _read(options.log)
    missing = [job for job in wanted if job not in done]
    with ExitStack() as stack:
        fresh: Iterator[Result] = map(_evaluated_job, missing)
        if options.processes > 1:
            pool = ProcessPoolExecutor(
                options.processes,
                get_context("spawn"),  # OpenCV's threads do not survive a fork
                cv2.setNumThreads,
                (max((os.cpu_count() or 1) // options.processes, 1),),
            )
            stack.callback(pool.shutdown, cancel_futures=True)
            fresh = pool.map(_evaluated_job, missing)
        for job in wanted:
            result = done.get(job)
            if result is None:
                result = next(fresh)
                _append(options.log, result)
            yield result


def _evaluated_job(job: tuple[str, int, int]) -> Result:
    return evaluate(sequence(*job))


def _counts(results: list[Result]) -> Iterator[tuple[int, int]]:
    return ((result["frames"], len(result["wrong"])) for result in results)


def _where(result: Result, wrong: Result) -> str:
    """Return the call that renders the frame again: `sequence(name, seed, count).frame(index)`."""
    call = f"sequence({result['sequence']!r}, {result['seed']}, {result['frames']})"
    return f"{call}.frame({wrong['index']})"


def _described(wrong: Result) -> str:
    return (
        f"{wrong['mm']:.1f} mm {wrong['deg']:.1f}° off, from {wrong['source']} of "
        f"{'+'.join(wrong['faces']) or 'no face'}, {wrong['verdict']}, "
        f"stated ±{wrong['stated_mm']:.2f} mm, χ² {wrong['chi2']:.3g}"
    )


def _print(console: Console, results: list[Result]) -> None:
    table = Table(title="Cubeling alone, many seeds", box=SIMPLE_HEAD, title_justify="left")
    for column in ("sequence", "frames", "given %", "recall %", "inside %", "wrong"):
        table.add_column(column, justify="left" if column == "sequence" else "right")
    for name in (*dict.fromkeys(result["sequence"] for result in results), "all"):
        some = [result for result in results if name in (result["sequence"], "all")]
        seen, given, right, inside = (
            sum(result[key] for result in some) for key in ("seen", "given", "right", "inside")
        )
        frames, wrong = (sum(each) for each in zip(*_counts(some), strict=True))
        shares = (given / max(seen, 1), right / max(seen, 1), inside / max(given, 1))
        table.add_row(name, str(frames), *map(share, shares), str(wrong))
    console.print(table)
    for result in results:
        for wrong in result["wrong"]:
            console.print(f"wrong: {_where(result, wrong)}: {_described(wrong)}")


def _read(log: Path | None) -> dict[tuple[str, int, int], Result]:
    """Read the finished sequences of an earlier run; ignore a truncated last line."""
    done: dict[tuple[str, int, int], Result] = {}
    if log is None or not log.is_file():
        return done
    for line in log.read_text(encoding="utf-8").splitlines():
        try:
            result = json.loads(line)
        except json.JSONDecodeError:
            continue
        done[result["sequence"], result["seed"], result["frames"]] = result
    return done


def _append(log: Path | None, result: Result) -> None:
    if log is not None:
        with log.open("a", encoding="utf-8") as file:
            file.write("\n" + json.dumps(result))  # newline first: the last line may be truncated


def _options() -> argparse.Namespace:
    moving = [name for name in NAMES if name not in AT_REST]
    parser = argparse.ArgumentParser(prog="python -m tests.bench.tracking.campaign",
                                     description=__doc__)  # fmt: skip
    parser.add_argument("--frames", type=int, default=10_000, help="in all")
    parser.add_argument("--length", type=int, default=120, help="frames of each sequence")
    parser.add_argument("--seed", type=int, default=7, help="the first; each round takes the next")
    parser.add_argument("--sequences", nargs="+", choices=NAMES, default=moving, metavar="NAME",
                        help=", ".join(NAMES))  # fmt: skip
    parser.add_argument("--processes", type=int, default=1, help="sequences at the same time")
    parser.add_argument("--log", type=Path, metavar="FILE",
                        help="note what is finished there, and do not do it again")  # fmt: skip
    return parser.parse_args()


if __name__ == "__main__":
    main()
