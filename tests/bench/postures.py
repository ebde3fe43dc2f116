"""How well ten components tell which postures are alike: `python -m tests.bench.postures`.

Source: Egges 2006, section 3.3.1, and the distances that he compares with (S26). The frames are
recordings of `shared/data`, which are not ours, on the bundled human. How many components find the
nearest posture (S5) is `cubeling reproduce posture-distance`.

rank correlation
    Of the distance of ten components with other distances, for random pairs of frames; and how long
    one pair takes with each, in blocks.

Exits with 1 if ten components weighted by their variances, as his, find fewer than 70 %.
"""

import sys
import time
from collections.abc import Callable
from functools import partial

import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table

from cubeling.app.workshop.reproduction.result import ReproductionRequest
from cubeling.app.workshop.reproduction.standing.posture_distance import (
    neighbour_curves,
    posture_sets,
    postures_of,
)
from cubeling.characters import Character
from cubeling.characters.synthesis.distances import DISTANCES
from cubeling.characters.synthesis.idle.posture_space import PostureSpace
from cubeling.characters.synthesis.joint_weights import rank_correlation
from cubeling.characters.synthesis.library import MotionLibrary
from tests.bench.upper_body import DATA

Array = NDArray[np.float64]

PAIRS, MIN_SUCCESS = 3000, 0.7


def compare(library: MotionLibrary, vectors: Array, space: PostureSpace, console: Console) -> None:
    """Print how the distance of ten components agrees with others, and how long they take."""
    table = Table(title="ten components and other distances")
    for heading in ("distance", "rank correlation", "a pair", "÷ ten components"):
        table.add_column(heading, justify="left" if heading == "distance" else "right")
    rng = np.random.default_rng(5)
    one, other = rng.integers(len(library), size=(2, PAIRS))
    at = space.project(vectors)
    every = np.arange(len(library))
    ours = np.linalg.norm(at[one, :10] - at[other, :10], axis=1)

    def timed(name: str, values: Array, seconds: float, unit: float) -> None:
        agreement = f"{rank_correlation(ours, values + 1e-12 * rng.normal(size=PAIRS)):.2f}"
        each = f"{1e9 * seconds / len(every) ** 2:.1f} ns"
        table.add_row(name, agreement, each, f"{seconds / unit:.1f}")

    some, whole = at[:, :10], np.linalg.norm(at[one] - at[other], axis=1)
    unit = _seconds(partial(space.distances, some, some))
    timed("10 components", ours, unit, unit)
    timed(f"{at.shape[1]} components", whole, _seconds(partial(space.distances, at, at)), unit)
    for name in ("ahn-wohn", "lee", "points"):
        distance = DISTANCES[name](library)
        spent = _seconds(partial(distance.block, every, every))
        timed(name, distance.pairs(one, other), spent, unit)
    console.print(table)


def _seconds(work: Callable[[], object]) -> float:
    """Return the shortest of three times that some work takes."""
    spent = []
    for _ in range(3):
        start = time.perf_counter()
        work()
        spent.append(time.perf_counter() - start)
    return min(spent)


def main() -> int:
    """Print the tables and return an exit code."""
    console = Console(width=120)
    if not DATA.is_dir():
        console.print(f"no recordings at {DATA}: nothing to measure")
        return 0
    human = Character.load("human")
    kind, clips = posture_sets(ReproductionRequest(DATA))
    rows = [postures_of(kind, own) for own in clips.values()]
    space = PostureSpace.of(np.concatenate(rows))
    held = space.variances[:10].sum() / space.variances.sum()
    console.print(f"ten of {kind.size} components hold {held:.1%} of the postures")
    roots = np.sqrt(space.weights("eigen"))
    share = neighbour_curves([space.project(each) * roots for each in rows]).success[9]
    console.print(f"they find {share:.0%} of the nearest ones, weighted by their variances")
    moving = clips["walking and running"]
    library = MotionLibrary.of(moving, human.skeleton, human.anatomy, rate=15.0)
    compare(library, kind.vectors(library.poses), space, console)
    return int(share < MIN_SUCCESS)


if __name__ == "__main__":
    sys.exit(main())
