"""The tracker beside OpenCV on photographs that we did not make.

Run `python -m tests.bench.photographs [--variants NAME …] [--pictures N] [--json FILE]`.
"""

import argparse
import json
from dataclasses import asdict, dataclass
from pathlib import Path

import cv2
import numpy as np
from rich.console import Console

from tests.bench.photographs import dodecahedron, table, targets
from tests.bench.photographs.boards import BoardScore, boards, score_board
from tests.bench.photographs.body import BodyScore, score_body, score_followed
from tests.bench.photographs.empty import EmptyScore, score_empty
from tests.bench.photographs.pairs import PairScore, score_pairs
from tests.bench.photographs.variants import VARIANTS
from tests.bench.tracking.benchmark_run import BenchmarkRun


@dataclass(frozen=True)
class Scores:
    """Everything that was measured."""

    body: list[BodyScore]
    """The dodecahedron as one body, in each variant and followed."""

    pairs: list[PairScore]
    """Its markers as cubes with one face."""

    boards: list[BoardScore]
    """Markers on flat paper."""

    empty: list[EmptyScore]
    """Photographs without the cube."""


def main() -> None:
    """Measure, print, and check the targets."""
    options, console = _options(), Console(width=136)
    if not dodecahedron.paths():
        console.print(f"skipped: there are no photographs in {dodecahedron.FOLDER}", soft_wrap=True)
        return
    cv2.setNumThreads(1)
    run = BenchmarkRun.now("python -m tests.bench.photographs", 0, 0, 1)
    scores = measured(options.variants, options.pictures, Console(stderr=True))
    table.show_reference(console, dodecahedron.reference())
    table.show_body(console, scores.body)
    table.show_pairs(console, scores.pairs)
    table.show_boards(console, scores.boards)
    table.show_empty(console, scores.empty)
    load = f"load {run.load:.1f} before"
    console.print(f"{run.date}, {run.machine} ({load}), one thread, OpenCV {cv2.__version__}\n")
    console.print("Targets:")
    verdicts = targets.verdicts(scores.body, scores.pairs, scores.boards, scores.empty)
    for verdict in verdicts:
        console.print(f"  {verdict}", highlight=False, soft_wrap=True)
    if options.json:
        document = json.dumps(asdict(scores), indent=1, ensure_ascii=False)
        options.json.write_text(document.replace("NaN", "null") + "\n", encoding="utf-8")


def measured(variants: list[str], pictures: int, progress: Console) -> Scores:
    """Measure on so many of the photographs, evenly chosen."""
    known = list(dodecahedron.reference().camera_from_body)
    numbers = [known[place] for place in np.linspace(0, len(known) - 1, pictures).astype(int)]
    # The first call of a tracker fills caches.
    score_body("as it is", numbers[:1])
    body = []
    for variant in variants:
        progress.print(f"the body, {variant} …")
        body += score_body(variant, numbers)
    progress.print("followed, pairs, boards, nothing in view …")
    return Scores(
        [*body, score_followed(numbers)],
        score_pairs(numbers),
        [score for board in boards() for score in score_board(board)],
        score_empty(numbers),
    )


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m tests.bench.photographs", description=__doc__)
    parser.add_argument("--variants", nargs="+", choices=VARIANTS, default=list(VARIANTS),
                        metavar="NAME", help=", ".join(VARIANTS))  # fmt: skip
    parser.add_argument("--pictures", type=int, default=72, help="of the dodecahedron; default: 72")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write every figure, too")
    options = parser.parse_args()
    if options.pictures < 1:
        parser.error("--pictures must be at least 1")
    return options
