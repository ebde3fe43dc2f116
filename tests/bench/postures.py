"""How well ten components tell which postures are alike: `python -m tests.bench.postures`.

Source: Egges 2006, section 3.3.1 (S5), and the distances that he compares with (S26). The frames
are recordings of `shared/data`, which are not ours, on the bundled human.

success
    For each frame of a set, its nearest other frame by some components is that by all of them.
    Egges found about 80 % with ten.
error
    Distance of all components between the frame that is found and the nearest one, with the same
    weights [rad]. He found less than 0.1 in the mean and 0.4 at most.
rank correlation
    Of the distance of ten components with other distances, for random pairs of frames; and how long
    one pair takes with each, in blocks.

Exits with 1 if fewer than 70 % succeed with ten components weighted by their variances, as his.
"""

import sys
import time
from collections.abc import Callable
from functools import partial

import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table

from cubeling.characters import Character
from cubeling.characters.control.controllers.recordings import read_motions
from cubeling.characters.synthesis.distances import DISTANCES
from cubeling.characters.synthesis.idle.posture_space import PostureSpace, PostureVectors, Weights
from cubeling.characters.synthesis.joint_weights import rank_correlation
from cubeling.characters.synthesis.library import MotionLibrary
from tests.bench.upper_body import DATA

Array = NDArray[np.float64]

SETS = (
    ("two who stand", ("idle/007_acted.bvh", "idle/011_acted.bvh")),
    ("two others", ("idle/003_acted.bvh", "idle/014_acted.bvh")),
    ("walking and running", ("cmu-mocap/02", "cmu-mocap/16/16_17.amc", "cmu-mocap/49")),
    ("gestures", ("bvh/wave_hello.bvh", "bvh/zombie.bvh", "bvh/131_03.bvh", "bvh/131_01.bvh")),
)
"""Four sets of recordings; `FRAMES` frames of each, evenly spread."""

FRAMES, COUNTS, PAIRS = 800, (1, 3, 5, 10, 20, 30), 3000
MODES: tuple[Weights, ...] = ("eigen", "eigen_norm", "one")


def nearest(distances: Array) -> NDArray[np.intp]:
    """Return the nearest other frame of each frame."""
    np.fill_diagonal(distances, np.inf)
    frames: NDArray[np.intp] = distances.argmin(1)
    return frames


def found(space: PostureSpace, at: Array, mode: Weights, count: int) -> tuple[float, Array]:
    """Return how often the nearest frame is found with some components, and the errors."""
    whole = space.distances(at, at, mode)
    apart = whole.copy()
    true = nearest(apart)
    taken = nearest(space.distances(at[:, :count], at[:, :count], mode))
    return float((taken == true).mean()), np.where(taken == true, 0.0, whole[taken, true])


def success(sets: dict[str, Array], space: PostureSpace, console: Console) -> bool:
    """Print the table of successes and errors, and return whether they are as good as his."""
    table = Table(title="nearest frame found by the first components, mean of the sets")
    for heading in ("weights", *map(str, COUNTS), "10 of each set", "error, mean", "largest"):
        table.add_column(heading, justify="left" if heading == "weights" else "right")
    good = True
    for mode in MODES:
        shares = [np.mean([found(space, at, mode, count)[0] for at in sets.values()])
                  for count in COUNTS]  # fmt: skip
        ten = [found(space, at, mode, 10) for at in sets.values()]
        errors = np.concatenate([error for _, error in ten])
        good &= mode == "one" or bool(shares[COUNTS.index(10)] >= 0.7)
        table.add_row(
            mode,
            *(f"{share:.0%}" for share in shares),
            " ".join(f"{100 * share:.0f}" for share, _ in ten),
            f"{errors.mean():.3f}",
            f"{errors.max():.2f}",
        )
    console.print(table)
    return good


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
    kind = PostureVectors.of(human.skeleton, human.anatomy)
    clips = {name: read_motions([str(DATA / each) for each in files], human)
             for name, files in SETS}  # fmt: skip
    sets = {}
    for name, own in clips.items():
        rows = np.concatenate([kind.vectors(clip.in_place) for clip in own])
        sets[name] = rows[np.linspace(0, len(rows) - 1, FRAMES).astype(int)]
    space = PostureSpace.of(np.concatenate([*sets.values()]))
    held = space.variances[:10].sum() / space.variances.sum()
    console.print(f"{4 * FRAMES} frames; ten of {kind.size} components hold {held:.1%} of them")
    good = success({name: space.project(rows) for name, rows in sets.items()}, space, console)
    moving = clips["walking and running"]
    library = MotionLibrary.of(moving, human.skeleton, human.anatomy, rate=15.0)
    compare(library, kind.vectors(library.poses), space, console)
    return int(not good)


if __name__ == "__main__":
    sys.exit(main())
