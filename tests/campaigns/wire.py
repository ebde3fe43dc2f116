"""Test the guarantees of the protocol: `python -m tests.campaigns.wire --exchanges 1e6`.

Host and robot communicate in virtual time over a faulty channel, with one fault mix after the
other. An exchange is a command that the robot takes and acknowledges; heartbeats are counted
separately. A violation is printed with the command that repeats it, and the exit code is 1.

Checked at every event: no emotion is invented, lost, doubled or out of order; no command's number
takes effect twice; an action is played at most once; the failsafe acts within 500 ms; the last
request takes effect within a limit; nothing grows; and damaged frames pass no more often than
CRC-16 allows.
"""

import argparse
import math
import os
import sys
import time
from collections.abc import Iterable
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass

import numpy as np
from rich.console import Console
from rich.table import Table

from tests.campaigns.fault_mixes import FAULT_MIXES, FaultMix
from tests.campaigns.monitor import BIN_WIDTH_S
from tests.campaigns.world import CampaignWorld, Outcome

EXCHANGES_PER_RUN = 20_000
"""Exchanges in one run, before a new world starts."""

PROGRESS_EVERY_RUNS = 20
"""Runs between two progress lines."""

MAX_PASS_PROBABILITY = 2**-16
"""Largest probability that a damaged frame passes the check; see tests.campaigns.crc."""

MIN_P_VALUE = 1e-6
"""Probability of a false alarm of each statistical check."""

LATENCY_MIX, MAX_MEDIAN_S, MAX_P99_S = "drop", 0.050, 0.150
"""Latency of an emotion with 5 % of the frames lost: the limits of median and 99 % quantile [s]."""


@dataclass(frozen=True)
class Run:
    """A run in one world."""

    mix: FaultMix
    """Its faults."""

    seed: int
    """Seed of all random numbers."""

    exchanges: int
    """Number of exchanges."""


def runs_for(exchanges: int, seed: int, mixes: Iterable[FaultMix] = FAULT_MIXES) -> list[Run]:
    """Divide the exchanges among the mixes, and those into runs; the slow ones first."""
    mixes = tuple(mixes)
    total = sum(mix.share for mix in mixes)
    runs = []
    for mix in reversed(mixes):
        wanted = math.ceil(exchanges * mix.share / total)
        count = math.ceil(wanted / EXCHANGES_PER_RUN)
        for index in range(count):
            runs.append(Run(mix, seed * 100_000 + index, math.ceil(wanted / count)))
    return runs


def run_world(run: Run) -> Outcome:
    """Run one world."""
    return CampaignWorld(run.mix, run.seed).run(run.exchanges)


def add_up(outcomes: list[Outcome]) -> Outcome:
    """Add up the outcomes of one mix."""
    total = outcomes[0]
    for one in outcomes[1:]:
        total.seconds += one.seconds
        total.counts += one.counts
        total.recoveries += one.recoveries
        total.worst_recovery = max(total.worst_recovery, one.worst_recovery)
        total.worst_failsafe = max(total.worst_failsafe, one.worst_failsafe)
        total.latencies = [a + b for a, b in zip(total.latencies, one.latencies, strict=True)]
        names = total.largest.keys() | one.largest.keys()
        total.largest = {
            name: max(total.largest.get(name, 0), one.largest.get(name, 0)) for name in names
        }
    return total


def quantile(histogram: list[int], share: float) -> float:
    """Return a quantile of the latencies [s]."""
    cumulated = np.cumsum(histogram)
    return BIN_WIDTH_S * (int(np.searchsorted(cumulated, share * cumulated[-1])) + 1)


def failures(outcomes: list[Outcome], seen: list[Outcome]) -> list[str]:
    """Return the failures of single runs, then of the sums."""
    from scipy.stats import binom  # a second of each process that collects the tests

    wrong = [
        f"{one.mix!r}: {one.violation}\n  again: python -m tests.campaigns.wire "
        f"--only {one.mix!r} --run-seed {one.seed}"
        for one in outcomes
        if one.violation
    ]
    for mix in seen:
        stretches = mix.counts["detected"] + mix.counts["undetected"]
        passed = mix.counts["undetected"]
        if passed and binom.sf(passed - 1, stretches, MAX_PASS_PROBABILITY) < MIN_P_VALUE:
            wrong.append(f"{mix.mix!r}: {passed} of {stretches} damaged frames passed the check")
        if mix.mix == LATENCY_MIX and any(mix.latencies):
            median, p99 = quantile(mix.latencies, 0.5), quantile(mix.latencies, 0.99)
            if median > MAX_MEDIAN_S or p99 > MAX_P99_S:
                wrong.append(f"{mix.mix!r}: emotions take {median:.3f} s, {p99:.3f} s at p99")
    return wrong


_FAULTS = ("drop", "flip", "dup", "split", "babble", "lost", "stall", "unplug", "reboot", "restart")


def table_of(seen: list[Outcome]) -> Table:
    """Return the table of all mixes."""
    table = Table(title="The protocol in virtual time", caption=_CAPTION)
    table.add_column("mix")
    for head in (
        "exchanges", "beats", "virtual\nh", "faults", "found", "passed", "recov-\neries",
        "worst\ns", "fail-\nsafes", "worst\nms", "to body\nmedian ms", "p99\nms",
    ):  # fmt: skip
        table.add_column(head, justify="right")
    for one in seen:
        counts = one.counts
        some = any(one.latencies)
        table.add_row(
            one.mix, f"{counts['exchanges']:,}", f"{counts['heartbeats']:,}",
            f"{one.seconds / 3600:.2f}", f"{sum(counts[name] for name in _FAULTS):,}",
            f"{counts['detected']:,}", f"{counts['undetected']}", f"{one.recoveries:,}",
            f"{one.worst_recovery:.2f}", f"{counts['failsafe']:,}",
            f"{1000 * one.worst_failsafe:.0f}",
            f"{1000 * quantile(one.latencies, 0.5):.1f}" if some else "",
            f"{1000 * quantile(one.latencies, 0.99):.1f}" if some else "",
        )  # fmt: skip
    return table


_CAPTION = (
    "faults: frames lost, doubled, split, bytes flipped, bytes of noise, stalls …; found, passed: "
    "damaged frames that the check detected and missed; worst: longest time until the last "
    "request took effect; failsafe of a robot that did not hang, at most 500 ms"
)


def faults_line(seen: list[Outcome]) -> str:
    """Return the number of injected faults of each kind, over all mixes."""
    kinds = (f"{name} {sum(one.counts[name] for one in seen):,}" for name in _FAULTS)
    sizes = {name for one in seen for name in one.largest}
    largest = (f"{name} {max(one.largest.get(name, 0) for one in seen)}" for name in sorted(sizes))
    return f"faults: {', '.join(kinds)}\nlargest: {', '.join(largest)}"


def main() -> int:
    """Run the campaign; return 1 if a guarantee was violated."""
    parser = argparse.ArgumentParser(description="Test the guarantees of the protocol.")
    parser.add_argument("--exchanges", type=float, default=1e6, help="of all mixes, 1e6")
    parser.add_argument("--seed", type=int, default=1, help="of the campaign")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="processes")
    parser.add_argument("--only", choices=[mix.name for mix in FAULT_MIXES], help="one mix")
    parser.add_argument("--run-seed", type=int, help="one run of it, with this seed")
    wanted = parser.parse_args()
    mixes = [mix for mix in FAULT_MIXES if wanted.only in (None, mix.name)]
    runs = runs_for(int(wanted.exchanges), wanted.seed, mixes)
    if wanted.run_seed is not None:
        runs = [Run(mixes[0], wanted.run_seed, EXCHANGES_PER_RUN)]
    console, start = Console(width=130), time.perf_counter()
    with ProcessPoolExecutor(wanted.jobs) as pool:
        outcomes = []
        for outcome in pool.map(run_world, runs):
            outcomes.append(outcome)
            if len(outcomes) % PROGRESS_EVERY_RUNS == 0:
                done = sum(one.counts["exchanges"] for one in outcomes)
                broken = sum(one.violation is not None for one in outcomes)
                took = time.perf_counter() - start
                console.print(f"{done:,} exchanges, {broken} runs broken, {took:.0f} s")
    groups = {mix.name: [one for one in outcomes if one.mix == mix.name] for mix in mixes}
    violations = [one for one in outcomes if one.violation]
    seen = [add_up(group) for group in groups.values() if group]
    console.print(table_of(seen))
    console.print(faults_line(seen))
    exchanges = sum(one.counts["exchanges"] for one in seen)
    beats = sum(one.counts["heartbeats"] for one in seen)
    wrong = failures(violations, seen)
    if wanted.run_seed is None and exchanges < wanted.exchanges and not wrong:
        wrong.append(f"only {exchanges} exchanges were done")
    console.print(
        f"{exchanges:,} exchanges and {beats:,} heartbeats in {time.perf_counter() - start:.0f} s, "
        f"seed {wanted.seed}: " + ("; ".join(wrong) if wrong else "no violation"),
        style="red" if wrong else "green",
        soft_wrap=True,
    )
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
