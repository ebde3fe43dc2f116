"""Many characters at once: `python -m tests.bench.crowd`.

Every character plays a mix of three clips of its own, at a time of its own; the work is sampling,
mixing, and the global matrices of all joints, in memory as the graphics card takes them.
"""

import time
from collections.abc import Callable

import numpy as np
from rich.console import Console
from rich.table import Table

from characters import Character
from characters.bank import Bank
from characters.blend import mix
from characters.crowd import globals_of_many

CROWD, VOICES, ROUNDS = 256, 3, 200


def milliseconds(work: Callable[[], object], rounds: int = ROUNDS) -> float:
    """Return the median time of one call [ms]."""
    work()
    times = []
    for _ in range(rounds):
        start = time.perf_counter()
        work()
        times.append(time.perf_counter() - start)
    return float(np.median(times)) * 1e3


def main() -> None:
    """Print the table."""
    table = Table(f"{CROWD} characters, {VOICES} clips each", "joints", "ms", "a ms", "one by one")
    for name in Character.bundled():
        character = Character.load(name)
        clips, skeleton = list(character.clips.values()), character.skeleton
        bank = Bank.of(skeleton, clips)
        rng = np.random.default_rng(1)
        numbers = rng.integers(0, len(clips), (CROWD, VOICES))
        times = rng.uniform(0.0, 5.0, (CROWD, VOICES))
        weights = rng.dirichlet(np.ones(VOICES), CROWD)

        def crowd() -> object:
            poses = bank.sample(numbers, times, weights)  # noqa: B023
            return np.ascontiguousarray(globals_of_many(poses, skeleton))  # noqa: B023

        def single() -> object:
            voices = zip(numbers[0], times[0], strict=True)  # noqa: B023
            poses = [clips[number].sample(float(at)) for number, at in voices]  # noqa: B023
            return mix(poses, weights[0]).globals(skeleton)  # noqa: B023

        together, alone = milliseconds(crowd), milliseconds(single)
        joints = str(len(skeleton))
        rate = f"{CROWD / together:.0f}"
        table.add_row(name, joints, f"{together:.2f}", rate, f"{1 / alone:.0f} a ms")
    Console().print(table)


if __name__ == "__main__":
    main()
