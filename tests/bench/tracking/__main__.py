"""Cubeling and other trackers on the same frames: `make bench-tracking`.

Run `python -m tests.bench.tracking [--quick] [--sequences NAME …] [--trackers NAME …]`.
"""

import argparse
import json
import math
import os
import sys
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

from rich.console import Console

from tests.bench.tracking import readme, table, targets
from tests.bench.tracking.benchmark_run import BenchmarkRun
from tests.bench.tracking.comparison import TrackerComparison
from tests.bench.tracking.rivals.environments import ENTRIES
from tests.bench.tracking.sequences import NAMES, sequence

PROGRAM = "tests.bench.tracking"


def main() -> None:
    """Render, track, print."""
    options = _options()
    console, progress = Console(width=120), Console(stderr=True)
    asked = ["make bench-tracking"] if options.readme else ["python -m", PROGRAM, *sys.argv[1:]]
    run = BenchmarkRun.now(" ".join(asked), options.frames, options.seed, options.threads)
    names = ("ours",) if options.ours_only else tuple(options.trackers)
    with TrackerComparison(names, options.threads, progress.print) as contest:
        for name in options.sequences:
            drawn = sequence(name, options.seed, options.frames)
            run = replace(run, scores=(*run.scores, *contest.run(drawn)))
            progress.print(f"{name}: {table.one_line(run.scores, name)}", highlight=False)
        run = replace(run, versions=contest.versions, left_out=contest.left_out)
    _print(console, run)
    if options.json:
        document = json.dumps(_plain(asdict(run)), indent=1, ensure_ascii=False, allow_nan=False)
        options.json.write_text(document + "\n", encoding="utf-8")
    if options.readme:
        readme.write(options.readme, run)


def _print(console: Console, run: BenchmarkRun) -> None:
    table.show(console, run.scores)
    console.print(f"\n{run.circumstances}")
    for title, versions in run.versions.items():
        console.print(f"  {title}: {versions}")
    for title, reason in run.left_out.items():
        console.print(f"  {title} was left out: {reason}")
    console.print("\nTargets:")
    for verdict in targets.verdicts(run.scores):
        console.print(f"  {verdict}", highlight=False, soft_wrap=True)


def _plain(value: Any) -> Any:
    """Replace NaN by null, as JSON has no NaN."""
    if isinstance(value, dict):
        return {key: _plain(each) for key, each in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(each) for each in value]
    return None if isinstance(value, float) and math.isnan(value) else value


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog=f"python -m {PROGRAM}", description=__doc__)
    parser.add_argument("--sequences", nargs="+", choices=NAMES, default=NAMES, metavar="NAME",
                        help=", ".join(NAMES))  # fmt: skip
    parser.add_argument("--trackers", nargs="+", choices=ENTRIES, default=list(ENTRIES),
                        metavar="NAME", help=", ".join(ENTRIES))  # fmt: skip
    parser.add_argument("--ours-only", action="store_true", help="no rival")
    parser.add_argument("--frames", type=int, default=100, help="of each sequence")
    parser.add_argument("--quick", action="store_true", help="24 frames of each sequence")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--threads", type=int, default=os.cpu_count() or 1,
                        help="of each tracker; default: all cores")  # fmt: skip
    parser.add_argument("--json", type=Path, metavar="FILE", help="write every figure, too")
    parser.add_argument("--readme", type=Path, metavar="FILE", help="rewrite its section, too")
    options = parser.parse_args()
    if options.quick:
        options.frames = 24
    return options


if __name__ == "__main__":
    main()
