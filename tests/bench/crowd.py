"""Animation of many characters at once: `python -m tests.bench.crowd`.

Every character plays a mix of three clips of its own at its own times. Measured are sampling,
mixing, and the global matrices of all joints in the layout for the graphics card. Exits with 1 if
fewer characters than `MIN_CHARACTERS_PER_MS` are processed in a millisecond.
"""

import sys
import time
from collections.abc import Callable

import numpy as np
from rich.console import Console
from rich.table import Table

from cubeling.characters import Character
from cubeling.characters.motion.batch.bank import ClipBank
from cubeling.characters.motion.batch.crowd import crowd_globals
from cubeling.characters.motion.blend import mix

CHARACTERS, CLIPS_EACH, ROUNDS = 256, 3, 300

MIN_CHARACTERS_PER_MS = 200.0
"""Required characters a millisecond."""


def milliseconds(work: Callable[[], object], rounds: int = ROUNDS) -> tuple[float, float]:
    """Return the median and the minimum time of one call [ms]."""
    work()
    times = []
    for _ in range(rounds):
        start = time.perf_counter()
        work()
        times.append(time.perf_counter() - start)
    return float(np.median(times)) * 1e3, min(times) * 1e3


def main() -> int:
    """Print the table and return an exit code."""
    table = Table(
        f"{CHARACTERS} characters, {CLIPS_EACH} clips each", "joints", "ms", "a ms", "at best"
    )
    table.add_column("one by one")
    slowest = float("inf")
    for name in Character.bundled_names():
        character = Character.load(name)
        clips, skeleton = list(character.clips.values()), character.skeleton
        bank = ClipBank.of(skeleton, clips)
        rng = np.random.default_rng(1)
        numbers = rng.integers(0, len(clips), (CHARACTERS, CLIPS_EACH))
        times = rng.uniform(0.0, 5.0, (CHARACTERS, CLIPS_EACH))
        weights = rng.dirichlet(np.ones(CLIPS_EACH), CHARACTERS)

        def crowd() -> object:
            return crowd_globals(bank, numbers, times, weights)  # noqa: B023

        def single() -> object:
            contributions = zip(numbers[0], times[0], strict=True)  # noqa: B023
            poses = [clips[number].sample(float(at)) for number, at in contributions]  # noqa: B023
            return mix(poses, weights[0]).globals(skeleton)  # noqa: B023

        (together, best), (alone, _) = milliseconds(crowd), milliseconds(single)
        slowest = min(slowest, CHARACTERS / together)
        cells = (f"{together:.2f}", f"{CHARACTERS / together:.0f}", f"{CHARACTERS / best:.0f}")
        table.add_row(name, str(len(skeleton)), *cells, f"{1 / alone:.0f} a ms")
    Console().print(table)
    if slowest < MIN_CHARACTERS_PER_MS:
        Console().print(
            f"{slowest:.0f} characters a millisecond, fewer than {MIN_CHARACTERS_PER_MS:.0f}"
        )
    return int(slowest < MIN_CHARACTERS_PER_MS)


if __name__ == "__main__":
    sys.exit(main())
