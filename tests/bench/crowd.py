"""Many characters at once: `python -m tests.bench.crowd`.

Every character plays a mix of three clips of its own, at a time of its own; the work is sampling,
mixing, and the global matrices of all joints, in memory as the graphics card takes them. Ends with
1 where fewer than the limit are done in a millisecond.
"""

import sys
import time
from collections.abc import Callable

import numpy as np
from rich.console import Console
from rich.table import Table

from characters import Character
from characters.motion.batch.bank import Bank
from characters.motion.batch.crowd import crowd_globals
from characters.motion.blend import mix

CROWD, VOICES, ROUNDS = 256, 3, 300

LIMIT = 200.0
"""How many characters a millisecond must be done."""


def milliseconds(work: Callable[[], object], rounds: int = ROUNDS) -> tuple[float, float]:
    """Return the median and the least time of one call [ms]."""
    work()
    times = []
    for _ in range(rounds):
        start = time.perf_counter()
        work()
        times.append(time.perf_counter() - start)
    return float(np.median(times)) * 1e3, min(times) * 1e3


def main() -> int:
    """Print the table and return an exit code."""
    table = Table(f"{CROWD} characters, {VOICES} clips each", "joints", "ms", "a ms", "at best")
    table.add_column("one by one")
    slowest = float("inf")
    for name in Character.bundled():
        character = Character.load(name)
        clips, skeleton = list(character.clips.values()), character.skeleton
        bank = Bank.of(skeleton, clips)
        rng = np.random.default_rng(1)
        numbers = rng.integers(0, len(clips), (CROWD, VOICES))
        times = rng.uniform(0.0, 5.0, (CROWD, VOICES))
        weights = rng.dirichlet(np.ones(VOICES), CROWD)

        def crowd() -> object:
            return crowd_globals(bank, numbers, times, weights)  # noqa: B023

        def single() -> object:
            voices = zip(numbers[0], times[0], strict=True)  # noqa: B023
            poses = [clips[number].sample(float(at)) for number, at in voices]  # noqa: B023
            return mix(poses, weights[0]).globals(skeleton)  # noqa: B023

        (together, best), (alone, _) = milliseconds(crowd), milliseconds(single)
        slowest = min(slowest, CROWD / together)
        cells = (f"{together:.2f}", f"{CROWD / together:.0f}", f"{CROWD / best:.0f}")
        table.add_row(name, str(len(skeleton)), *cells, f"{1 / alone:.0f} a ms")
    Console().print(table)
    if slowest < LIMIT:
        Console().print(f"{slowest:.0f} characters a millisecond, fewer than {LIMIT:.0f}")
    return int(slowest < LIMIT)


if __name__ == "__main__":
    sys.exit(main())
