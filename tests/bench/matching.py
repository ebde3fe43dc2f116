"""Time of a search of motion matching over 50,000 frames: `python -m tests.bench.matching`.

The frames are those of CMU recordings (`shared/data/cmu-mocap`), or of the human's own takes where
these are absent, repeated with noise. A query has the pose of one frame and the path of another, at
random: harder than in play, where the frame that plays bounds the search. Each is timed three
times, and the shortest counts, as other programs disturb it. Every answer is compared with that of
all rows. Exits with 1 if one is wrong or the median exceeds `LIMIT_MS`.
"""

import sys
import time

import numpy as np
from rich.console import Console
from rich.table import Table

from cubeling.characters import Character
from cubeling.characters.control.controllers.matching import prepare_database
from cubeling.characters.synthesis.matching.nearest import NearestRow
from tests.bench.controllers import CMU

ROWS, QUERIES, NOISE = 50_000, 300, 0.1
LIMIT_MS = 0.15
"""Limit of the median of a search [ms]."""


def main() -> int:
    """Print the table and return an exit code."""
    rng = np.random.default_rng(1)
    motions = (str(CMU),) if CMU.is_dir() else ()
    space = prepare_database(Character.load("human"), motions).legs
    copies = -(-ROWS // len(space.values))
    rows = np.concatenate([space.values] * copies)[:ROWS]
    rows = rows + NOISE * rng.standard_normal(rows.shape)
    start = time.perf_counter()
    nearest = NearestRow(rows)
    indexed = time.perf_counter() - start
    pose, path = rng.integers(ROWS, size=(2, QUERIES))
    queries = rows[pose].copy()
    ahead = slice(space.columns["path"].start, None)
    queries[:, ahead] = rows[path, ahead]
    times, wrong = [], 0
    for query in queries:
        shortest = np.inf
        for _ in range(3):
            start = time.perf_counter()
            found = nearest.find(query)
            shortest = min(shortest, time.perf_counter() - start)
        times.append(1e3 * shortest)
        apart = np.square(rows - query).sum(1)
        wrong += found is None or apart[found[0]] > apart.min() * (1 + 1e-4) + 1e-6
    table = Table("rows", "from", "index", "median", "95th percentile", "wrong", title="A search")
    median, slow = np.median(times), np.percentile(times, 95)
    origin = "CMU" if motions else "own takes"
    cells = (f"{len(rows)}", origin, f"{indexed:.2f} s", f"{median:.3f} ms", f"{slow:.3f} ms")
    table.add_row(*cells, f"{wrong} of {QUERIES}")
    Console(width=100).print(table)
    return int(wrong > 0 or median > LIMIT_MS)


if __name__ == "__main__":
    sys.exit(main())
