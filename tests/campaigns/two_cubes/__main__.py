"""Track two cubes that cross, are covered by hands and are swapped: none is taken for the other.

`python -m tests.campaigns.two_cubes [--clips 1000] [--seed 1] [--processes 2]` draws as many clips,
each with two other cubes, and prints a table. The exit code is 1 if a tracker raises an error, if a
pose is that of the other cube, if one is trusted in the third frame after its cube was last in view
or later, if a trusted pose is wrong (most of all one that stays while the cube moves), or if the
cubes are found too seldom. `--clip N` tells of each frame of one clip.

Truth is the drawing: where each cube is, and which share of its outline nothing covers.
"""

import argparse
import sys
import time
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from multiprocessing import get_context

import cv2
import numpy as np
from rich.console import Console
from rich.table import Table

from tests.campaigns.two_cubes.watch import Count, show

MIN_FOUND_SHARE = 0.9
"""Least share of the frames with a cube in view, from the third in a row on, in which it is found.
"""


def run(clips: range, seed: int, processes: int = 1) -> Count:
    """Show clips, and count what the trackers say."""
    total = Count()
    if processes == 1:
        cv2.setNumThreads(1)
        for number in clips:
            total.add(show(seed, number))
        return total
    spawn = get_context("spawn")
    one_thread = partial(cv2.setNumThreads, 1)
    with ProcessPoolExecutor(processes, spawn, initializer=one_thread) as pool:
        for each in pool.map(show, [seed] * len(clips), clips, chunksize=4):
            total.add(each)
    return total


def main() -> int:
    """Run the campaign."""
    parser = argparse.ArgumentParser(description="Track two cubes that are hard to tell apart.")
    parser.add_argument("--clips", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument("--clip", type=int, help="tell of the frames of this one alone")
    wanted = parser.parse_args()
    if wanted.clip is not None:
        return 1 if show(wanted.seed, wanted.clip, print).wrong_clips else 0
    began = time.perf_counter()
    count = run(range(wanted.clips), wanted.seed, wanted.processes)
    events = count.events
    share = events["found"] / max(events["in view"], 1)
    table = Table("two cubes", "", title=f"{wanted.clips:,} crossings, coverings and swaps")
    for name in ("poses", "the other cube", "loss not said", "frozen", "wrong", "errors"):
        table.add_row(name, f"{events[name]:,}")
    table.add_row("found where in view", f"{share:.1%}")
    waits = np.array(count.waits or [0])
    late = f"{waits.mean():.1f} ({np.quantile(waits, 0.95):.0f})"
    table.add_row("frames until found, mean (95 %)", late)
    table.add_row("seconds", f"{time.perf_counter() - began:.0f}")
    console = Console()
    console.print(table)
    for number, text in list(count.wrong_clips.items())[:20]:
        console.print(f"--seed {wanted.seed} --clip {number}: {text}", markup=False)
    return 1 if count.wrong_clips or share < MIN_FOUND_SHARE else 0


if __name__ == "__main__":
    sys.exit(main())
