"""Test whether the check of a frame misses errors only at the rates predicted for CRC-16.

`python -m tests.campaigns.crc` prints a table; the exit code is 1 if a rate is not as predicted.

**Within the guarantee** nothing may pass: one, two or three wrong bits anywhere between the edges,
and bursts of up to 16, as long as they make no edge; and any single wrong bit, edges included.

**Beyond it**, with a = 2^-16:

- *Noise in the form of a frame*: bytes without a zero, then three of the form 1110hhhh 10mmmmmm
  10llllll. Whatever the bytes are, exactly one of the 65536 checks fits: a.
- *Every bit wrong with probability e*: an error pattern passes if it does not change the 8 fixed
  bits of the check, and is a nonzero code word. By the identity of
  MacWilliams (1963) for a code of n bits whose dual has the words d,
  p = (1 - e)^8 (a sum over d of (1 - 2e)^weight(d) - (1 - e)^n), which is exact. Edges that such
  errors make, and the runs of COBS, are ignored: they only reject more.
- *A wrong bit that makes an edge*: what follows it still ends with the check of the whole frame. It
  fits if the register stood at its start value behind the new edge, which for an arbitrary head is
  one state of 65536: a. The bytes before it are much less likely to pass: their last bytes would
  also need the form of a check.

*Lost edges*: there are two between two frames. If one is lost, the next frame has one more byte; if
both are lost, two frames and two bytes become one. Neither ever passes if one bit of each edge is
wrong, as a test of all cases shows.

For a frame that passes, the header, the session, the length and the range of every field must
still be valid.
"""

import argparse
import sys
import time
from collections.abc import Callable, Iterator

import numpy as np
from rich.console import Console
from rich.table import Table

from cubeling.robot.protocol.wire import encode_frame
from tests.campaigns.detected_errors import (
    behind_garbage,
    bursts,
    damaged,
    pairs,
    single_bits,
    triples,
)
from tests.campaigns.error_rate import BODIES, ErrorRate
from tests.campaigns.undetected_errors import bits_wrong, edge_made, edges_lost, noise, same_check


def error_rates(random_count: int, trials: int, seed: int) -> Iterator[ErrorRate]:
    """Measure all rates."""
    random = np.random.default_rng(seed)
    frames = [encode_frame(body) for body in BODIES]
    yield single_bits(frames)
    yield damaged("2 wrong bits, every pair", frames, pairs(frames[:2]))
    yield damaged("3 wrong bits", frames, triples(frames, random, random_count // 2))
    yield damaged("bursts of up to 16 bits", frames, bursts(frames, random, random_count // 2))
    yield edges_lost()
    yield behind_garbage(random, random_count // 10)
    yield same_check(random, 2000)
    beyond: tuple[Callable[[], ErrorRate], ...] = (
        lambda: noise(random, trials),
        lambda: bits_wrong(random, trials, 8),
        lambda: bits_wrong(random, trials, 26),
        lambda: edge_made(random, trials),
    )
    for measure in beyond:
        yield measure()


def main() -> int:
    """Print the table; return 1 if a rate is not as predicted."""
    parser = argparse.ArgumentParser(description="Measure the errors that the check misses.")
    parser.add_argument("--random", type=float, default=1.2e6, help="errors within the guarantee")
    parser.add_argument("--trials", type=float, default=1e7, help="of each kind beyond it")
    parser.add_argument("--seed", type=int, default=1)
    wanted = parser.parse_args()
    start, good = time.perf_counter(), True
    table = Table(title="Errors that pass the check of a frame")
    for head in ("errors", "trials", "left out", "passed", "predicted", "p-value"):
        table.add_column(head, justify="left" if head == "errors" else "right")
    for one in error_rates(int(wanted.random), int(wanted.trials), wanted.seed):
        good &= one.as_predicted
        table.add_row(
            one.what, f"{one.trials:,}", f"{one.edges:,}", f"{one.passed:,}",
            f"{one.trials * one.chance:.1f}", "" if one.chance == 0 else f"{one.p_value:.3f}",
            style="" if one.as_predicted else "red",
        )  # fmt: skip
    console = Console(width=100)
    console.print(table)
    console.print(
        f"{time.perf_counter() - start:.0f} s, seed {wanted.seed}: "
        + ("all as predicted" if good else "not as predicted"),
        style="green" if good else "red",
    )
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
